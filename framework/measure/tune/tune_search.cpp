#include "measure/tune/tune_search.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace kestrel {
namespace {

// Positions along an axis: those of a logarithmic one are logarithms.
double positionOf(const TuneAxis& axis, double value) { return axis.logarithmic ? std::log(value) : value; }
double valueAt(const TuneAxis& axis, double position) {
    return axis.logarithmic ? std::exp(position) : position;
}

// To the next multiple of a power of ten that is at most `fine`; within the axis.
double roundedTo(const TuneAxis& axis, double value, double fine) {
    if (axis.whole) return std::clamp(std::round(value), std::ceil(axis.low), std::floor(axis.high));
    const int digits = static_cast<int>(-std::floor(std::log10(fine)));
    // By a division where the unit is below 1: 3 / 10.0 is the number that "0.3" reads as, 3 * 0.1 is not.
    const double unit = std::pow(10.0, std::abs(digits));
    const double rounded = digits >= 0 ? std::round(value * unit) / unit : std::round(value / unit) * unit;
    return std::clamp(rounded, axis.low, axis.high);
}

// The fraction of u + i phi_k, where phi is that of Roberts' R sequence: evenly spread in every dimension.
double spread(int axis, int count, int index, std::uint32_t seed) {
    double phi = 2; // the positive root of x^(count + 1) = x + 1
    for (int i = 0; i < 30; ++i) phi = std::pow(1 + phi, 1.0 / (count + 1));
    std::uint32_t mixed = seed * 0x9e3779b9U + 0x85ebca6bU * static_cast<std::uint32_t>(axis + 1);
    mixed = (mixed ^ (mixed >> 16)) * 0x7feb352dU;
    mixed = (mixed ^ (mixed >> 15)) * 0x846ca68bU;
    mixed ^= mixed >> 16;
    const double at = mixed / 4294967296.0 + (index + 1) * std::pow(1 / phi, axis + 1);
    return at - std::floor(at);
}

class TuneSearch {
public:
    TuneSearch(const std::vector<TuneAxis>& axes, const TuneSetting& start, const TuneEffort& effort,
               const TuneQuestions& questions)
        : axes_(axes)
        , effort_(effort)
        , questions_(questions) {
        for (const TuneAxis& axis : axes_) windows_.push_back({axis.low, axis.high});
        found_.setting = start;
    }

    TuneFound run() {
        found_.asked = 1;
        known_.insert(found_.setting);
        found_.error = found_.startError =
            questions_.error(found_.setting, std::numeric_limits<double>::infinity())
                .value_or(std::numeric_limits<double>::infinity());
        if (!std::isfinite(found_.error)) return std::move(found_); // nothing is better than no error
        tryAll(probes(), 0, -1);
        for (int round = 1; round <= effort_.rounds; ++round) {
            for (size_t axis = 0; axis < axes_.size(); ++axis) tryAll(along(axis), round, int(axis));
            for (size_t axis = 0; axis < axes_.size(); ++axis) narrow(axis);
        }
        return std::move(found_);
    }

private:
    struct Window {
        double low, high;
    };

    [[nodiscard]] std::vector<TuneSetting> probes() const {
        std::vector<TuneSetting> settings;
        const int count = static_cast<int>(axes_.size());
        for (int i = 0; i < effort_.probes && count > 0; ++i) {
            TuneSetting setting;
            for (int k = 0; k < count; ++k) {
                const TuneAxis& axis = axes_[static_cast<size_t>(k)];
                const double u = spread(k, count, i, effort_.seed);
                if (axis.choices > 0) {
                    setting.push_back(std::floor(u * axis.choices));
                    continue;
                }
                const double low = positionOf(axis, axis.low), high = positionOf(axis, axis.high);
                const double value = valueAt(axis, low + u * (high - low));
                setting.push_back(roundedTo(axis, value, stepAt(axis, value, axis.low, axis.high) / 20));
            }
            settings.push_back(std::move(setting));
        }
        return settings;
    }

    [[nodiscard]] double stepAt(const TuneAxis& axis, double value, double low, double high) const {
        const double step = (positionOf(axis, high) - positionOf(axis, low)) / (effort_.steps - 1);
        return axis.logarithmic ? value * std::expm1(step) : step;
    }

    // The best setting with other values of one axis.
    [[nodiscard]] std::vector<TuneSetting> along(size_t index) const {
        const TuneAxis& axis = axes_[index];
        std::vector<double> values(static_cast<size_t>(axis.choices));
        if (axis.choices > 0)
            std::iota(values.begin(), values.end(), 0.0);
        else
            values = tuneValues(axis, windows_[index].low, windows_[index].high, effort_.steps);
        std::vector<TuneSetting> settings;
        for (const double value : values) {
            settings.push_back(found_.setting);
            settings.back()[index] = value;
        }
        return settings;
    }

    void tryAll(const std::vector<TuneSetting>& settings, int round, int axis) {
        std::vector<std::pair<double, const TuneSetting*>> better;
        for (const TuneSetting& setting : settings) {
            if (!known_.insert(setting).second) continue; // it was not taken before, when less was known
            ++found_.asked;
            const double bound = found_.error * (1 - effort_.gain);
            const auto error = questions_.error(setting, bound);
            if (error && *error < bound) better.emplace_back(*error, &setting);
        }
        std::ranges::stable_sort(better, {}, &std::pair<double, const TuneSetting*>::first);
        for (const auto& [error, setting] : better) {
            if (!questions_.affordable(*setting)) {
                ++found_.tooSlow;
                continue;
            }
            found_.setting = *setting;
            found_.error = error;
            found_.path.push_back({round, axis, *setting, error});
            return;
        }
    }

    void narrow(size_t index) {
        const TuneAxis& axis = axes_[index];
        if (axis.choices > 0) return;
        Window& window = windows_[index];
        const double low = positionOf(axis, window.low), high = positionOf(axis, window.high);
        // The start may lie outside.
        const double best = positionOf(axis, std::clamp(found_.setting[index], axis.low, axis.high));
        double half = (high - low) / (effort_.steps - 1);
        if (best - low < half / 2 || high - best < half / 2) {
            const double value = found_.setting[index];
            if (value > axis.low && value < axis.high) half = (high - low) / 2;
        }
        if (axis.whole) half = std::max(half, 1.0);
        window.low = std::max(axis.low, valueAt(axis, best - half));
        window.high = std::min(axis.high, valueAt(axis, best + half));
    }

    const std::vector<TuneAxis>& axes_;
    const TuneEffort& effort_;
    const TuneQuestions& questions_;
    std::vector<Window> windows_;
    std::set<TuneSetting> known_;
    TuneFound found_;
};

} // namespace

std::vector<double> tuneValues(const TuneAxis& axis, double low, double high, int count) {
    const double first = positionOf(axis, low), last = positionOf(axis, high);
    std::vector<double> values;
    for (int i = 0; i < count; ++i) {
        const double step = (last - first) / (count - 1);
        const double value = i + 1 == count ? high : valueAt(axis, first + i * step);
        const double fine = (axis.logarithmic ? value * std::expm1(step) : step) / 20;
        values.push_back(fine > 0 ? roundedTo(axis, value, fine) : value);
    }
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

TuneFound searchTuning(const std::vector<TuneAxis>& axes, const TuneSetting& start, const TuneEffort& effort,
                       const TuneQuestions& questions) {
    return TuneSearch(axes, start, effort, questions).run();
}

} // namespace kestrel
