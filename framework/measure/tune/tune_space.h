// What is free of a sweep's point, as the search sees it: axes of numbers; and back, as settings of a graph.
#pragma once
#include "measure/sweep_file.h"
#include "measure/tune/tune_search.h"

namespace kestrel {

struct TuneSpace {
    std::vector<TuneAxis> axes;
    TuneSetting start; // as the graph with the point's settings has it
    std::vector<std::string> names;
    std::vector<std::vector<std::string>> choices; // of each axis; none of a range

    // "pass.property=value", one an axis.
    [[nodiscard]] std::vector<std::string> settings(const TuneSetting& setting) const;
};

// Of a point whose properties are free as it says. A choice that is the start's joins those of the file: the
// start always takes part. Throws InputError with everything that is wrong with what is free (unknown passes
// and properties with near names, values that the property does not take, ranges of what is no number), at
// the places of the sweep file.
TuneSpace tuneSpace(const Sweep& sweep, const SweepPoint& point, const Registry& registry);

// The same of all points, each mistake told once; and that there is something to tune at all.
void checkTuning(const Sweep& sweep, const std::vector<SweepPoint>& points, const Registry& registry);

// A point with more settings, after its own.
SweepPoint withSettings(SweepPoint point, const std::vector<std::string>& settings);

} // namespace kestrel
