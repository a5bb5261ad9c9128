// One ray a texel of a stochastic depth map, whichever pass traces it. Needs no GL.
#pragma once
#include "graph/pass.h"

namespace kestrel {

// Which hits stay: a random sample (Brüll, Kern, Grosch 2024, Listing 1); per slot the nearest of a random
// subset; the nearest.
enum class RayCollection { Reservoir, CoverageMask, KBuffer };

struct TexelTracing {
    int layers = 4; // slots a texel
    RayCollection collection = RayCollection::Reservoir;
    int maxCount = 8; // hits from which on each shortens the ray to itself; 0: none does
    // A reservoir's hit replaces farther ones only (Listing 1). Where hits come front to back, as from a
    // hierarchy walked in order, that keeps the first ones: a k-buffer by another name.
    bool zCull = false;
    bool jitter = true;
    int intervalTexels = 1; // texels per axis that share one of "ray_min" and "ray_max"; 0: no intervals
    bool wholeMap = false;  // every texel, without a list
};

// The step "trace" over ports of these names of its pass: "view_depth", "hits", "depths", where they are
// asked for "texels" (a work list), "ray_min" and "ray_max". `run` is what runs it.
Step traceStep(const World& world, const TexelTracing& tracing, const Desc& depths, StepRun run);

// Room for a list of that many texels.
Desc texelListDesc(std::uint64_t texels);

} // namespace kestrel
