// The report of a run, as `render --stats` writes it: scripts rely on its keys; keys are only ever added.
#pragma once
#include "core/spin.h"
#include "measure/profile.h"
#include <string>
#include <utility>
#include <vector>

namespace kestrel {

struct RunStats {
    std::string graph, scene, camera;
    std::string graphPath, scenePath; // where they lie; set by the caller, who knows
    Extent size;
    int frames = 0;
    std::uint32_t seed = 0;
    std::string renderer, driver, clock;
    SpinTest spin;
    std::vector<Profile::PassTime> passes;
    std::map<std::string, Spread> groups;
    Spread frameMs;
    std::vector<LeftOut> leftOut;
    MemoryReport memory;
    // What each port of a pass takes by itself, in bytes, in the order of the plan: parts of MemoryReport's
    // `unshared` and `persistent`, where a history counts twice.
    std::vector<std::pair<std::string, std::uint64_t>> resources;
    // What previews cost besides: they are in none of the figures above, but that steps which they alter take
    // longer.
    Spread previewsMs;
    PreviewCost previews;
    std::map<std::string, std::map<std::string, double>> values; // what passes reported in the last frame
};

// `driver` is the context's. The spin test is run here (a fraction of a second).
RunStats gatherStats(Renderer& renderer, const Profile& profile, const std::string& driver);

// The JSON text, indented, with a line break at the end.
std::string statsJson(const RunStats& stats);

} // namespace kestrel
