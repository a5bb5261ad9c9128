// The steps of an effect that traces rays from every pixel. Needs no GL.
#pragma once
#include "graph/pass.h"
#include "scene/facts.h"
#include <vector>

namespace kestrel {

// Rays a pixel that one step traces at most: their loops must stay together below the iterations after which
// llvmpipe silently cuts an invocation's loops short (65,535).
inline constexpr int maxRaysPerStep = 16;

// The same for rays of this tracer: those through the pixels of an A-buffer take many more iterations each.
[[nodiscard]] int raysPerStep(const Desc& tracer);

// `step` as often as `rays` rays a pixel of this tracer need, named "trace0", "trace1"…, in the group
// "tracing". Each gets the defines RAYS and FIRST_RAY (its own), TOTAL_RAYS, CONTINUES (all but the first:
// images hold sums of the steps before), ENDS (the last: makes means of them), and those of the materials
// that hits may lie on.
std::vector<Step> raySteps(Step step, int rays, const Desc& tracer, const SceneFacts& facts);

} // namespace kestrel
