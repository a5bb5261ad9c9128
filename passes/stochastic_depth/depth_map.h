// What the stochastic depth maps share, however they are made. Needs no GL.
#pragma once
#include "graph/pass.h"

namespace kestrel {

// The image array that holds `layers` depths a texel: up to four channels an image.
Desc depthMapDesc(int layers, const Extent& extent, const View& view);

// The module `layers` at that port over the internal image array "depths". `jitter`: a texel's samples are
// taken where sobolJitter() of shared/stochastic_depth.h says, else at its centre.
Module depthMapModule(const Desc& depths, int layers, bool jitter);

// Which texels a map has, and which of them are asked for.
struct MapShape {
    Extent extent;
    View view;
    const char* mask = ""; // the input that asks: `ray_max` with the interval, else `sd_mask`
    bool whole = false;    // no mask is connected: every texel is asked for
    bool empty = false;    // none is
};

// As the mask has it; without one of the frame's resolution per axis divided by `divisor`, with `guard`
// pixels of the frame around it, rounded up to texels, or as many as the depth has. `problems` hears what
// does not fit.
MapShape mapShape(const World& world, const Inputs& inputs, bool interval, int divisor, int guard,
                  std::vector<DeclarationProblem>& problems);

} // namespace kestrel
