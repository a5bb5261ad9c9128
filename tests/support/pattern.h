// A picture with values all over the range.
#pragma once
#include "image/image.h"
#include <cstdint>

namespace kestrel::test {

// Values from 0 to below 1, the same on every machine.
inline Image pattern(int width, int height, int channels, std::uint32_t seed = 1) {
    Image image(width, height, channels);
    for (float& value : image.values) {
        seed = seed * 1664525U + 1013904223U;
        value = static_cast<float>(seed >> 8) / static_cast<float>(1U << 24);
    }
    return image;
}

} // namespace kestrel::test
