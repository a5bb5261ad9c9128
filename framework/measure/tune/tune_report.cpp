#include "measure/tune/tune_report.h"
#include "measure/tune/tune_folder.h"
#include <algorithm>
#include <map>

namespace kestrel {
namespace {

bool isAmong(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

// Errors of a point on one plot of a scene.
struct JudgedErrors {
    std::string name;
    double byDefault = 0, tuned = 0;
};

std::vector<std::string> ranked(std::vector<JudgedErrors> all, double JudgedErrors::*by) {
    std::ranges::stable_sort(all, {}, by);
    std::vector<std::string> names;
    for (const JudgedErrors& errors : all) names.push_back(errors.name);
    return names;
}

// The mean over scenes; nothing if one is not there.
std::optional<double> meanOver(const std::vector<std::string>& scenes,
                               const std::map<std::string, double>& errors) {
    double sum = 0;
    for (const std::string& scene : scenes) {
        const auto found = errors.find(scene);
        if (found == errors.end()) return std::nullopt;
        sum += found->second;
    }
    return scenes.empty() ? std::nullopt : std::optional(sum / static_cast<double>(scenes.size()));
}

} // namespace

size_t TuneReport::within(double share) const {
    return static_cast<size_t>(std::ranges::count_if(points, [&](const Point& point) {
        return point.outcome.startError <= (1 + share) * point.outcome.error;
    }));
}

size_t TuneReport::heldOut() const {
    return static_cast<size_t>(std::ranges::count(ranks, true, &Ranks::heldOut));
}

size_t TuneReport::heldOutChanged() const {
    return static_cast<size_t>(
        std::ranges::count_if(ranks, [](const Ranks& plot) { return plot.heldOut && plot.changed(); }));
}

TuneReport tuneReport(const Sweep& sweep, const std::vector<SweepPoint>& points, const SweepFolder& folder,
                      const std::vector<SweepRow>& rows) {
    TuneReport report;
    if (!sweep.tuning) return report;
    std::vector<std::pair<std::pair<std::string, std::string>, std::vector<JudgedErrors>>> plots;
    std::map<std::string, std::map<std::string, double>> byDefault, byTuned; // point -> scene -> error
    for (const SweepRow& row : rows) {
        const auto error = errorOf(row, sweep.plotError);
        if (!row.picture.failed.empty() || !error) continue;
        const std::pair key{row.scene, row.plot};
        auto plot = std::ranges::find(plots, key, [](const auto& item) { return item.first; });
        if (plot == plots.end()) plot = plots.insert(plot, {key, {}});
        if (row.tunedOf.empty()) {
            plot->second.push_back({row.point, *error, *error});
            byDefault[row.point][row.scene] = byTuned[row.point][row.scene] = *error;
        } else {
            // The tuned row of a point comes after its default.
            const auto of = std::ranges::find(plot->second, row.tunedOf, &JudgedErrors::name);
            if (of != plot->second.end()) of->tuned = *error;
            byTuned[row.tunedOf][row.scene] = *error;
        }
    }
    for (const auto& [key, errors] : plots)
        report.ranks.push_back({key.first, key.second, isAmong(sweep.tuning->train, key.first),
                                isAmong(sweep.tuning->holdOut, key.first),
                                ranked(errors, &JudgedErrors::byDefault),
                                ranked(errors, &JudgedErrors::tuned)});
    for (const SweepPoint& point : points)
        if (!point.free.empty())
            if (auto outcome = TuneFolder(folder, point).outcome())
                report.points.push_back({point.name, std::move(*outcome),
                                         meanOver(sweep.tuning->holdOut, byDefault[point.name]),
                                         meanOver(sweep.tuning->holdOut, byTuned[point.name])});
    return report;
}

} // namespace kestrel
