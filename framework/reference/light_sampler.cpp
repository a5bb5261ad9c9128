#include "reference/light_sampler.h"
#include "shared/ggx.h"
#include "shared/ray.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kestrel {
namespace {

// Shadow rays end this share of their length before the light, or they would meet the mesh that shows it.
constexpr float shortOfTheLight = 1 - 0x1p-10f;

// From the origin to a point, t from 0 to 1.
TraceRay rayTo(const glm::vec3& origin, const glm::vec3& target) {
    return {origin, target - origin, 0, shortOfTheLight};
}

// KHR_lights_punctual, range property: 1 near the light, 0 from its range on.
float rangeWindow(float distance, float range) {
    if (!(range > 0)) return 1;
    const float q = distance / range, q2 = q * q;
    return std::clamp(1 - q2 * q2, 0.0f, 1.0f);
}

// KHR_lights_punctual, inner and outer cone angles.
float spotWindow(const LightState& light, const glm::vec3& toLight) {
    const float outer = std::cos(light.outerCone);
    const float scale = 1 / std::max(0.001f, std::cos(light.innerCone) - outer);
    const float share = std::clamp((-glm::dot(light.direction, toLight) - outer) * scale, 0.0f, 1.0f);
    return share * share;
}

} // namespace

glm::vec3 ShadowRays::trace(const ReferenceTracer& tracer, glm::vec3* unshadowed) {
    blocked_.assign(rays.size(), 0);
    tracer.anyHits(rays, blocked_);
    glm::vec3 arrives(0), all = below;
    for (size_t i = 0; i < rays.size(); ++i) {
        all += light[i];
        if (blocked_[i] == 0) arrives += light[i];
    }
    if (unshadowed != nullptr) *unshadowed = all;
    return arrives;
}

LightSampler::LightSampler(std::span<const LightState> lights, const Geometry& geometry, const Scene& scene,
                           bool emissiveMeshes)
    : emitters_(areaEmitters(lights, geometry, scene, emissiveMeshes)) {
    for (const LightState& light : lights)
        if (light.kind != LightKind::Rectangle && light.kind != LightKind::Sphere) punctual_.push_back(light);
}

template<class Visit>
void LightSampler::forEachPunctual(const LitPoint& point, const Visit& visit) const {
    for (const LightState& light : punctual_) {
        if (light.kind == LightKind::Directional) {
            if (shared::leavesFace(-light.direction, point.faceNormal))
                visit(-light.direction, light.intensity,
                      TraceRay{point.origin, -light.direction, 0, std::numeric_limits<float>::infinity()});
            continue;
        }
        const glm::vec3 way = light.position - point.position;
        const float distance = glm::length(way);
        if (!(distance > 0)) continue;
        const glm::vec3 direction = way / distance;
        float share = rangeWindow(distance, light.range);
        if (light.kind == LightKind::Spot) share *= spotWindow(light, direction);
        if (share > 0 && shared::leavesFace(direction, point.faceNormal))
            visit(direction, light.intensity * share / distance / distance,
                  rayTo(point.origin, light.position));
    }
}

void LightSampler::addPunctual(ShadowRays& to, const LitPoint& point, const glm::vec3& scale) const {
    constexpr float inversePi = 1 / std::numbers::pi_v<float>;
    forEachPunctual(point, [&](const glm::vec3& direction, const glm::vec3& light, const TraceRay& ray) {
        const float cosine = glm::dot(point.normal, direction);
        if (cosine > 0) to.add(ray, scale * light * (cosine * inversePi));
    });
}

void LightSampler::addHighlights(ShadowRays& to, const LitPoint& point, const glm::vec3& toEye,
                                 const glm::vec3& f0, float alpha, const glm::vec3& scale) const {
    forEachPunctual(point, [&](const glm::vec3& direction, const glm::vec3& light, const TraceRay& ray) {
        const glm::vec3 lobe = shared::specularLobe(point.normal, toEye, direction, f0, alpha);
        if (lobe != glm::vec3(0)) to.add(ray, scale * light * lobe);
    });
}

void LightSampler::addArea(ShadowRays& to, const LitPoint& point, const glm::vec3& scale,
                           const glm::vec2& u) const {
    const EmitterSample sample = sampleEmitters(emitters_, point.position, point.normal, u);
    if (!(luminance(sample.light) > 0)) return;
    if (shared::leavesFace(sample.direction, point.faceNormal))
        to.add(rayTo(point.origin, point.position + sample.distance * sample.direction),
               scale * sample.light);
    else
        to.below += scale * sample.light;
}

} // namespace kestrel
