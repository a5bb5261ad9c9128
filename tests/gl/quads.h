// Scenes of quads that face the eye, for tests of what is drawn and looked up.
#pragma once
#include "scene/geometry.h"
#include "scene/scene.h"
#include <algorithm>
#include <vector>

namespace kestrel::test {

// A quad in the plane z, from lower left to upper right, facing +z unless `away`. Texture coordinates as glTF
// has them: (0, 0) at the upper left.
struct Quad {
    glm::vec2 from, to;
    float z = 0;
    std::uint32_t material = 0;
    TriangleClass kind = TriangleClass::Opaque;
    bool away = false;
};

inline Geometry geometryOf(std::vector<Quad> quads) {
    std::stable_sort(quads.begin(), quads.end(),
                     [](const Quad& a, const Quad& b) { return a.kind < b.kind; });
    Geometry geometry;
    for (const Quad& quad : quads) {
        const auto base = static_cast<std::uint32_t>(geometry.positions.size());
        for (const glm::vec2 corner : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
            geometry.positions.emplace_back(glm::mix(quad.from, quad.to, corner), quad.z);
            VertexAttributes attributes;
            attributes.texCoord = {corner.x, 1 - corner.y};
            attributes.texCoord1 = corner;
            attributes.tangent = {1, 0, 0, 1};
            attributes.colour = {corner.x, corner.y, 1, 1};
            geometry.attributes.push_back(attributes);
            geometry.bounds.add(geometry.positions.back());
        }
        std::vector<std::uint32_t> order = {0, 1, 2, 0, 2, 3};
        if (quad.away) order = {0, 2, 1, 0, 3, 2};
        for (const std::uint32_t corner : order) geometry.indices.push_back(base + corner);
        Geometry::Range& range = geometry.ranges[static_cast<size_t>(quad.kind)];
        if (range.count == 0) range.first = static_cast<std::uint32_t>(geometry.materials.size());
        range.count += 2;
        geometry.materials.insert(geometry.materials.end(), 2, quad.material);
    }
    geometry.moving = {{0, static_cast<std::uint32_t>(geometry.positions.size())}}; // all of it may
    return geometry;
}

inline Material coloured(const glm::vec4& colour) {
    Material material;
    material.baseColour = colour;
    return material;
}

inline const glm::vec4 red(1, 0, 0, 1), green(0, 1, 0, 1), blue(0, 0, 1, 1);

} // namespace kestrel::test
