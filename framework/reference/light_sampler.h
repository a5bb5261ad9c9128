// Light that comes straight from the scene's lights, with shadow rays through the reference tracer.
#pragma once
#include "reference/area_emitters.h"
#include "reference/tracer.h"
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace kestrel {

// Where light falls on. Normals are unit; `origin` is `position` moved off the face.
struct LitPoint {
    glm::vec3 position, origin, normal, faceNormal;
};

// Shadow rays with what each brings if nothing blocks it, traced together.
struct ShadowRays {
    std::vector<TraceRay> rays;
    std::vector<glm::vec3> light;
    glm::vec3 below{0}; // what comes from below the face: blocked by the surface itself, not traced
    void clear() {
        rays.clear();
        light.clear();
        below = glm::vec3(0);
    }
    void add(const TraceRay& ray, const glm::vec3& brings) {
        rays.push_back(ray);
        light.push_back(brings);
    }
    // The sum of what arrives; `unshadowed` is set to the sum of all.
    glm::vec3 trace(const ReferenceTracer& tracer, glm::vec3* unshadowed = nullptr);

private:
    std::vector<std::uint8_t> blocked_;
};

class LightSampler {
public:
    // The emitters are the area lights, with `emissiveMeshes` the emissive triangles too (areaEmitters()).
    LightSampler(std::span<const LightState> lights, const Geometry& geometry, const Scene& scene,
                 bool emissiveMeshes);

    // Point, spot and directional lights as KHR_lights_punctual has them: inverse square, cone, range window.
    // A ray each that brings its irradiance over pi, times `scale`.
    void addPunctual(ShadowRays& to, const LitPoint& point, const glm::vec3& scale) const;
    // What the same lights reflect at `point` by the specular lobe (specularLobe() of shared/ggx.h) towards
    // unit `toEye`: a ray each that brings that radiance, times `scale`.
    void addHighlights(ShadowRays& to, const LitPoint& point, const glm::vec3& toEye, const glm::vec3& f0,
                       float alpha, const glm::vec3& scale) const;
    // One point of the area emitters, by `u` uniform in [0, 1)^2.
    void addArea(ShadowRays& to, const LitPoint& point, const glm::vec3& scale, const glm::vec2& u) const;
    [[nodiscard]] const std::vector<AreaEmitter>& emitters() const { return emitters_; }

private:
    // Calls visit(unit direction to the light, irradiance of what faces it, ray to it) for each punctual
    // light that the face does not hide.
    template<class Visit>
    void forEachPunctual(const LitPoint& point, const Visit& visit) const;

    std::vector<LightState> punctual_;
    std::vector<AreaEmitter> emitters_;
};

} // namespace kestrel
