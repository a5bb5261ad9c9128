// A small surface as a glTF file, plain: what compressed files of the same are held against.
#pragma once
#include "support/gltf_builder.h"
#include <cmath>

namespace kestrel::test {

// A wavy square of `side` by `side` quads with normals, texture coordinates and 16-bit indices.
struct Grid {
    std::vector<float> positions, normals, texCoords;
    std::vector<std::uint16_t> indices;
    explicit Grid(int side) {
        const auto width = static_cast<std::uint16_t>(side + 1);
        for (int y = 0; y <= side; ++y)
            for (int x = 0; x <= side; ++x) {
                const float u = static_cast<float>(x) / static_cast<float>(side),
                            v = static_cast<float>(y) / static_cast<float>(side);
                positions.insert(positions.end(), {u, v, 0.1f * std::sin(6 * u) * std::cos(5 * v)});
                const float slope = -0.6f * std::cos(6 * u) * std::cos(5 * v),
                            other = 0.5f * std::sin(6 * u) * std::sin(5 * v);
                const float length = std::sqrt(slope * slope + other * other + 1);
                normals.insert(normals.end(), {slope / length, other / length, 1 / length});
                texCoords.insert(texCoords.end(), {u, 1 - v});
            }
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const auto a = static_cast<std::uint16_t>(y * width + x),
                           b = static_cast<std::uint16_t>(a + 1);
                const auto c = static_cast<std::uint16_t>(a + width), d = static_cast<std::uint16_t>(c + 1);
                indices.insert(indices.end(), {a, b, d, a, d, c});
            }
    }
    [[nodiscard]] size_t vertices() const { return positions.size() / 3; }
    [[nodiscard]] GltfBuilder file() const {
        GltfBuilder builder;
        const size_t p = builder.floats(positions, 3), n = builder.floats(normals, 3),
                     t = builder.floats(texCoords, 2);
        const size_t i = builder.accessor(indices, 1, UnsignedShort);
        builder.addMeshNode(
            {{"attributes", {{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", t}}}, {"indices", i}});
        return builder;
    }
};

} // namespace kestrel::test
