// Materials at points of the scene's triangles, on the CPU.
#pragma once
#include "scene/geometry.h"
#include "scene/trace.h"
#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace kestrel {

// What a ray meets. Normals are unit and on the side that the ray came from.
struct SurfaceSample {
    glm::vec3 position{0}, faceNormal{0}, normal{0}; // the last interpolated, bent by the normal map
    glm::vec3 albedo{1};                             // linear base colour: factor, texture, vertex colour
    float alpha = 1;                                 // of the same
    glm::vec3 emission{0};                           // linear radiance: factor, texture
    float metallic = 0, roughness = 1;               // factors times texture
    float transmission = 0, eta = 1.5f;              // eta: relativeIndex() of shared/bsdf.h, from that side
    bool unlit = false;
    float reach = 0; // faceReach() of shared/ray.h
};

// What shaders/lib/material.glsl tells of a hit. Textures are read at their finest level, with the filter of
// their sampler; colours are decoded before.
class SurfaceSampler {
public:
    // Both must outlive it and stay as they are.
    SurfaceSampler(const Geometry& geometry, const Scene& scene);

    // A point of a triangle by barycentric weights u, v of its second and third corner, for a ray of that
    // direction.
    [[nodiscard]] SurfaceSample at(const TraceHit& hit, const glm::vec3& direction) const;
    // Emission alone, from either side.
    [[nodiscard]] glm::vec3 emission(std::uint32_t triangle, float u, float v) const;

private:
    // Unit: `normal` (unit) and `tangent` (interpolated, any length), bent by the normal map if there is one.
    [[nodiscard]] glm::vec3 bent(const Material& material, const TraceHit& hit, const glm::vec3& normal,
                                 const glm::vec4& tangent) const;
    [[nodiscard]] glm::vec4 texture(const TextureRef& ref, std::uint32_t triangle, float u, float v,
                                    bool colour) const;
    const Geometry& geometry_;
    const Scene& scene_;
    std::vector<Material> materials_;
    std::array<float, 256> linear_; // of an sRGB code
};

} // namespace kestrel
