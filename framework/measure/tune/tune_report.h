// What `kestrel tune` found, as it stands in results.json and on the page.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

struct Sweep;
struct SweepPoint;
struct SweepRow;
class SweepFolder;

using TuneSettings = std::vector<std::string>; // "pass.property=value", one for each free property

// What was found for a point.
struct TuneOutcome {
    struct Step {
        int round = 0;     // 0: a probe
        std::string along; // the property; empty: a probe
        TuneSettings set;
        double error = 0;
    };
    TuneSettings start, set;          // the same where nothing better was found
    double startError = 0, error = 0; // means over the training scenes
    double timeRatio = 1;             // over the default's
    int asked = 0, tooSlow = 0;       // settings
    std::vector<Step> path;           // those that were taken
};

struct TuneReport {
    struct Point {
        std::string name;
        TuneOutcome outcome;
        // Means over the scenes that were held out; none if there is one that is not measured.
        std::optional<double> heldOutDefault, heldOutTuned;
    };
    // The variants of one plot of a scene by rising error, each at its default or tuned.
    struct Ranks {
        std::string scene, plot;
        bool trained = false, heldOut = false;
        std::vector<std::string> byDefault, byTuned;
        [[nodiscard]] bool changed() const { return byDefault != byTuned; }
    };
    std::vector<Point> points;
    std::vector<Ranks> ranks;

    // Points whose default's error over the training scenes is at most `share` above that of what was found.
    [[nodiscard]] size_t within(double share) const;
    // Plots of scenes that were held out, and those of them whose ranks tuning changed.
    [[nodiscard]] size_t heldOut() const;
    [[nodiscard]] size_t heldOutChanged() const;
};

// Of a sweep's points (not the judged ones) and the rows of those that were judged.
TuneReport tuneReport(const Sweep& sweep, const std::vector<SweepPoint>& points, const SweepFolder& folder,
                      const std::vector<SweepRow>& rows);

} // namespace kestrel
