// Colour maps for one-channel images.
#pragma once
#include "image/image.h"
#include <array>

namespace kestrel {

// The perceptually uniform maps by Smith and van der Walt (2015): magma is the map of the
// published FLIP images.
enum class ColorMap { Magma, Viridis };

// The colour of `value` in [0, 1] as sRGB code values in [0, 1], the nearest of 256; values outside count as
// the nearer end, NaN as the greatest.
std::array<float, 3> colorOf(ColorMap map, float value);

// A one-channel image of errors in [0, 1] as sRGB code values: write it with Encoding::Linear.
Image heatMap(const Image& error, ColorMap map = ColorMap::Magma);

} // namespace kestrel
