// Resizing images to the side of their texture array. Needs no GL.
#pragma once
#include "scene/material.h"
#include <cstdint>
#include <vector>

namespace kestrel {

enum class ResampleFilter : std::uint8_t {
    Smooth, // triangle filter as wide as the larger of the two texel sizes
    Nearest // for textures that are read without a filter: keeps hard texel borders
};

// side x side texels, 4 bytes each, rows top to bottom. Filters in linear light if `srgb` (alpha as it is);
// borders repeat the outermost texel. An image of that size comes back as it is, an empty one as white.
std::vector<std::uint8_t> resampleToSquare(const TextureImage& image, std::uint32_t side, bool srgb,
                                           ResampleFilter filter);

} // namespace kestrel
