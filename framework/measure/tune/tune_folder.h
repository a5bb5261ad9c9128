// What `kestrel tune` keeps beside a sweep's parts, one file a measurement: errors and times of settings, and
// what was found. A run that is stopped asks the folder first, and so goes the same way again without
// measuring.
#pragma once
#include "measure/sweep_results.h"
#include "measure/tune/tune_report.h"

namespace kestrel {

// The error of a setting on one training scene.
struct TuneErrorRecord {
    TuneSettings set;
    std::string machine;
    std::string failed;          // why there is none
    std::optional<double> error; // none where no pixel counts, or it failed
};

// The time of a setting and of the default, measured in turn: sums over the training scenes of the medians of
// the time that the plot shows, milliseconds.
struct TuneTimeRecord {
    TuneSettings set;
    std::string machine;
    double defaultMs = 0, ms = 0;
};

class TuneFolder {
public:
    TuneFolder(const SweepFolder& folder, const SweepPoint& point);

    [[nodiscard]] std::optional<TuneErrorRecord> error(const SweepScene& scene,
                                                       const TuneSettings& set) const;
    [[nodiscard]] std::optional<TuneTimeRecord> time(const TuneSettings& set) const;
    [[nodiscard]] std::optional<TuneOutcome> outcome() const;
    void write(const SweepScene& scene, const TuneErrorRecord& record) const;
    void write(const TuneTimeRecord& record) const;
    void write(const TuneOutcome& outcome) const;

private:
    [[nodiscard]] std::filesystem::path fileOf(const TuneSettings& set, const std::string& what) const;
    std::filesystem::path folder_;
};

// The points of a sweep and, after each, what was found for it where that is not the default: "NAME, tuned".
// Both have the axis "setting" then ("default", "tuned"), which joins them in plots.
std::vector<SweepPoint> judgedPoints(const std::vector<SweepPoint>& points, const SweepFolder& folder);

} // namespace kestrel
