// What the stochastic depth maps share, however they are made. Needs no GL.
#pragma once
#include "graph/pass.h"

namespace kestrel {

// The image array that holds `layers` depths a texel: up to four channels an image.
Desc depthMapDesc(int layers, const Extent& extent, const View& view);

// The module `layers` at that port over the internal image array "depths". `jitter`: a texel's samples are
// taken where sobolJitter() of shared/stochastic_depth.h says, else at its centre.
Module depthMapModule(const Desc& depths, int layers, bool jitter);

} // namespace kestrel
