// The fragments of an A-buffer by pixel: the module `layers` of ABuffer.
#pragma once
#include "graph/pass.h"

namespace kestrel {

// Fragments of a pixel that can be asked for by number; whoever walks through them meets all.
inline constexpr int fragmentLayers = 64;

// Declares the output `layers` where it is read, over the inputs `pixels`, `nodes` and `data`. They are empty
// where the frame's view is not among those of the A-buffer.
void declareFragmentLayers(const World& world, const Inputs& inputs, const Demand& demand,
                           Declaration& declaration);

} // namespace kestrel
