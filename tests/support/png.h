// PNG files made in tests.
#pragma once
#include <cstdint>
#include <stb_image_write.h>
#include <vector>

namespace kestrel::test {

// Four bytes a pixel, rows top to bottom.
inline std::vector<std::uint8_t> pngOf(const std::vector<std::uint8_t>& rgba, int width, int height) {
    std::vector<std::uint8_t> bytes;
    const auto append = [](void* context, void* data, int size) {
        const auto* first = static_cast<const std::uint8_t*>(data);
        auto& target = *static_cast<std::vector<std::uint8_t>*>(context);
        target.insert(target.end(), first, first + size);
    };
    stbi_write_png_to_func(append, &bytes, width, height, 4, rgba.data(), 4 * width);
    return bytes;
}

} // namespace kestrel::test
