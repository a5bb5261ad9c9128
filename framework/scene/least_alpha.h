// From which alpha on a masked surface is there.
#pragma once
#include "scene/material.h"

namespace kestrel {

// The cutoff less a rounding: factor, texture and vertex colour are multiplied and interpolated, in one order
// in a rasterizer and in another at a ray's hit, and an alpha that equals the cutoff must pass in all of
// them. Far less than one step of 8 bits.
[[nodiscard]] inline float leastAlpha(const Material& material) { return (1 - 1e-5f) * material.alphaCutoff; }

} // namespace kestrel
