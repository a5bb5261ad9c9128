// Worlds of a few triangles and lights by hand, for the tests of the references.
#pragma once
#include "core/version.h"
#include "reference/gather.h"
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <numbers>

namespace kestrel {

inline constexpr float pi = std::numbers::pi_v<float>;

#define GATHER_NEEDS_EMBREE()                                                                                \
    if (parts().find("embree") == std::string::npos) GTEST_SKIP() << "built without Embree"

inline void addFace(Geometry& g, const std::array<glm::vec3, 3>& corners,
                    const std::array<glm::vec3, 3>& normals, std::uint32_t material) {
    for (size_t k = 0; k < 3; ++k) {
        g.indices.push_back(static_cast<std::uint32_t>(g.positions.size()));
        g.positions.push_back(corners[k]);
        g.attributes.emplace_back();
        g.attributes.back().normal = normals[k];
        g.bounds.add(corners[k]);
    }
    g.materials.push_back(material);
    g.ranges[0].count = g.triangleCount();
}

// Its front is the side of cross(u, v).
inline void addSquare(Geometry& g, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
                      std::uint32_t material = 0) {
    const glm::vec3 n = glm::normalize(glm::cross(u, v));
    addFace(g, {corner, corner + u, corner + u + v}, {n, n, n}, material);
    addFace(g, {corner, corner + u + v, corner + v}, {n, n, n}, material);
}

// Seen from inside: normals to the centre.
inline void addRoundRoom(Geometry& g, float radius, int n) {
    const auto at = [&](int i, int j) {
        const float a = pi * static_cast<float>(i) / static_cast<float>(n),
                    b = pi * static_cast<float>(j) / static_cast<float>(n);
        return glm::vec3(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            const glm::vec3 a = at(i, j), b = at(i, j + 1), c = at(i + 1, j + 1), d = at(i + 1, j);
            if (i > 0) addFace(g, {radius * a, radius * c, radius * b}, {-a, -c, -b}, 0);
            if (i + 1 < n) addFace(g, {radius * a, radius * d, radius * c}, {-a, -d, -c}, 0);
        }
}

inline Scene materialsScene(const std::vector<Material>& materials) {
    Scene scene;
    scene.materials = materials;
    return scene;
}

inline Material matteOf(const glm::vec3& colour, const glm::vec3& emission = glm::vec3(0)) {
    Material material;
    material.baseColour = glm::vec4(colour, 1);
    material.metallic = 0;
    material.emission = emission;
    return material;
}

inline LightState lightOf(LightKind kind, const glm::vec3& position, float intensity) {
    LightState light;
    light.kind = kind;
    light.position = position;
    light.direction = {0, -1, 0};
    light.tangent = {1, 0, 0};
    light.bitangent = {0, 0, -1};
    light.intensity = glm::vec3(intensity);
    return light;
}

inline Image row(const std::vector<glm::vec3>& values) {
    Image image(static_cast<int>(values.size()), 1, 3);
    for (int i = 0; i < image.width; ++i)
        for (int k = 0; k < 3; ++k) image.at(i, 0, k) = values[static_cast<size_t>(i)][k];
    return image;
}

inline GatherInputs pointsFacing(const std::vector<glm::vec3>& positions, const glm::vec3& normal) {
    const std::vector<glm::vec3> normals(positions.size(), normal);
    return {row(positions), row(normals), {}, {}, {}};
}

struct LitWorld {
    Geometry geometry;
    Scene scene;
    std::vector<LightState> lights;
    GatherResult gather(const std::function<GatherResult(const GatherScene&)>& how) const {
        const ReferenceTracer tracer(geometry, scene);
        return how({tracer, geometry, scene, lights});
    }
    GatherResult bounce(const GatherInputs& inputs, const GatherSettings& settings) const {
        return gather([&](const GatherScene& s) { return gatherIndirectDiffuse(s, inputs, settings); });
    }
    GatherResult shadow(const GatherInputs& inputs, const GatherSettings& settings) const {
        return gather([&](const GatherScene& s) { return gatherSoftShadow(s, inputs, settings); });
    }
};

} // namespace kestrel
