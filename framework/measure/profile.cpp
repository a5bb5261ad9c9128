#include "measure/profile.h"
#include <algorithm>

namespace kestrel {

Spread spreadOf(std::vector<double> series) {
    if (series.empty()) return {};
    std::ranges::sort(series);
    const size_t middle = series.size() / 2;
    const double median =
        series.size() % 2 == 1 ? series[middle] : 0.5 * (series[middle - 1] + series[middle]);
    return {median, series.front(), series.back()};
}

void Profile::add(const FrameRecord& frame) {
    std::map<std::string, double> ofPass;
    double previews = 0;
    for (const StepSample& sample : frame.samples) {
        if (sample.preview) {
            previews += sample.ms;
            continue;
        }
        ofPass[sample.pass] += sample.ms;
        groups_[sample.group][frames_.size()] += sample.ms;
        const bool known = std::ranges::any_of(
            passes_, [&](const PassSeries& series) { return series.name == sample.pass; });
        if (!known) passes_.push_back({sample.pass, sample.type, {}});
    }
    for (PassSeries& series : passes_)
        if (const auto found = ofPass.find(series.name); found != ofPass.end())
            series.ms.push_back(found->second);
    frames_.push_back(frame.ms - previews);
    previews_.push_back(previews);
}

std::vector<Profile::PassTime> Profile::passes() const {
    std::vector<PassTime> result;
    for (const PassSeries& series : passes_)
        result.push_back({series.name, series.type, static_cast<int>(series.ms.size()), spreadOf(series.ms)});
    return result;
}

std::map<std::string, Spread> Profile::groups() const {
    std::map<std::string, Spread> result;
    for (const auto& [group, byFrame] : groups_) {
        std::vector<double> series(frames_.size(), 0.0);
        for (const auto& [frame, ms] : byFrame) series.at(frame) = ms;
        result[group] = spreadOf(std::move(series));
    }
    return result;
}

} // namespace kestrel
