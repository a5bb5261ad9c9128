#include "reference/area_emitters.h"
#include "reference/sampling.h"
#include "reference/surface_sample.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kestrel {
namespace {

constexpr float emitterPi = std::numbers::pi_v<float>;

AreaEmitter emitterOf(const LightState& light) {
    AreaEmitter emitter;
    emitter.radiance = light.intensity;
    if (light.kind == LightKind::Sphere) {
        emitter.kind = AreaEmitter::Kind::Sphere;
        emitter.corner = light.position;
        emitter.u.x = light.halfSize.x;
        return emitter;
    }
    const glm::vec3 x = light.halfSize.x * light.tangent, y = light.halfSize.y * light.bitangent;
    emitter.corner = light.position - x - y;
    emitter.u = 2.0f * x;
    emitter.v = 2.0f * y;
    if (glm::dot(glm::cross(light.tangent, light.bitangent), light.direction) < 0)
        std::swap(emitter.u, emitter.v);
    return emitter;
}

double areaOf(const AreaEmitter& emitter) {
    const double pi = std::numbers::pi, radius = double{emitter.u.x};
    if (emitter.kind == AreaEmitter::Kind::Sphere) return 4 * pi * radius * radius;
    const double parallelogram = glm::length(glm::cross(glm::dvec3(emitter.u), glm::dvec3(emitter.v)));
    return (emitter.kind == AreaEmitter::Kind::Triangle ? 0.5 : 1.0) * parallelogram *
           (emitter.bothSides ? 2 : 1);
}

// A thousandth of a light's size: above the rounding of a mesh that was placed where the light is.
constexpr float samePlace = 1e-3f;

bool liesOn(const LightState& light, const glm::vec3& point) {
    const glm::vec3 r = point - light.position;
    if (light.kind == LightKind::Sphere)
        return std::abs(glm::length(r) - light.halfSize.x) <= samePlace * light.halfSize.x;
    const float tolerance = samePlace * std::max(light.halfSize.x, light.halfSize.y);
    return std::abs(glm::dot(r, light.direction)) <= tolerance &&
           std::abs(glm::dot(r, light.tangent)) <= light.halfSize.x + tolerance &&
           std::abs(glm::dot(r, light.bitangent)) <= light.halfSize.y + tolerance;
}

bool isPanelOf(const LightState& light, const glm::vec3 (&corners)[3], const glm::vec3& radiance) {
    const glm::vec3 apart = glm::abs(radiance - light.intensity);
    const bool alike = luminance(apart) <= 0.01f * luminance(light.intensity);
    return alike && liesOn(light, corners[0]) && liesOn(light, corners[1]) && liesOn(light, corners[2]);
}

// The mean over a triangle: at the middles of 16 triangles of equal size.
glm::vec3 meanEmission(const SurfaceSampler& surfaces, std::uint32_t triangle) {
    glm::vec3 sum(0);
    int count = 0;
    constexpr int n = 4;
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
            const auto at = [&](float third) {
                sum += surfaces.emission(triangle, (static_cast<float>(i) + third) / n,
                                         (static_cast<float>(j) + third) / n);
                ++count;
            };
            at(1.0f / 3);
            if (i + j + 1 < n) at(2.0f / 3);
        }
    return sum / static_cast<float>(count);
}

std::vector<LightState> areaLightsOf(std::span<const LightState> lights) {
    std::vector<LightState> area;
    for (const LightState& light : lights)
        if (light.kind == LightKind::Rectangle || light.kind == LightKind::Sphere) area.push_back(light);
    return area;
}

// Hands each triangle of an emissive material to `use` as an emitter, and whether it is an area light's
// panel.
template<class Use>
void forEachEmissiveTriangle(std::span<const LightState> areaLights, const Geometry& geometry,
                             const Scene& scene, const Use& use) {
    const std::vector<Material> materials = flattenedMaterials(scene);
    const SurfaceSampler surfaces(geometry, scene);
    for (std::uint32_t triangle = 0; triangle < geometry.triangleCount(); ++triangle) {
        const Material& material = materials[geometry.materials[triangle]];
        if (material.emission == glm::vec3(0)) continue;
        glm::vec3 corners[3];
        for (size_t k = 0; k < 3; ++k) corners[k] = geometry.positions[geometry.indices[3 * triangle + k]];
        AreaEmitter emitter;
        emitter.kind = AreaEmitter::Kind::Triangle;
        emitter.bothSides = material.doubleSided;
        emitter.corner = corners[0];
        emitter.u = corners[1] - corners[0];
        emitter.v = corners[2] - corners[0];
        emitter.radiance =
            material.emissionTexture.present() ? meanEmission(surfaces, triangle) : material.emission;
        const bool panel = std::any_of(areaLights.begin(), areaLights.end(), [&](const LightState& light) {
            return isPanelOf(light, corners, emitter.radiance);
        });
        use(triangle, emitter, panel);
    }
}

EmitterSample sampleSphere(const AreaEmitter& sphere, const glm::vec3& position, const glm::vec3& normal,
                           const glm::vec2& u) {
    EmitterSample sample;
    const glm::vec3 toCentre = sphere.corner - position;
    const float distance = glm::length(toCentre), sine = sphere.u.x / distance;
    if (!(sine < 1)) return sample; // inside of it nothing arrives
    // 1 - cos without cancellation for small spheres.
    const float high = sine * sine / (1 + std::sqrt(1 - sine * sine));
    const float down = u.x * high, radial = std::sqrt(std::max(0.0f, down * (2 - down)));
    const float phi = 2 * emitterPi * u.y;
    sample.direction = glm::normalize(basisAround(toCentre / distance) *
                                      glm::vec3(radial * std::cos(phi), radial * std::sin(phi), 1 - down));
    const float along = glm::dot(toCentre, sample.direction);
    const float beside2 = std::max(0.0f, distance * distance - along * along);
    sample.distance = along - std::sqrt(std::max(0.0f, sphere.u.x * sphere.u.x - beside2));
    // Solid angle 2 pi (1 - cos), irradiance over pi.
    sample.light = sphere.radiance * (2 * high * std::max(0.0f, glm::dot(normal, sample.direction)));
    return sample;
}

EmitterSample sampleFlat(const AreaEmitter& flat, const glm::vec3& position, const glm::vec3& normal,
                         glm::vec2 u) {
    const bool triangle = flat.kind == AreaEmitter::Kind::Triangle;
    if (triangle) {
        const float s = std::sqrt(u.x);
        u = {s * (1 - u.y), s * u.y};
    }
    EmitterSample sample;
    const glm::vec3 way = flat.corner + u.x * flat.u + u.y * flat.v - position;
    sample.distance = glm::length(way);
    if (!(sample.distance > 0)) return sample;
    sample.direction = way / sample.distance;
    // The area times the cosine at the emitter, over the squared distance: the lengths are divided out first.
    const glm::vec3 u1 = flat.u / sample.distance, v1 = flat.v / sample.distance;
    const float facing = -glm::dot(glm::cross(u1, v1), sample.direction);
    const float seen =
        (flat.bothSides ? std::abs(facing) : std::max(0.0f, facing)) * (triangle ? 0.5f : 1.0f);
    sample.light = flat.radiance * (seen * std::max(0.0f, glm::dot(normal, sample.direction)) / emitterPi);
    return sample;
}

} // namespace

std::vector<AreaEmitter> areaEmitters(std::span<const LightState> lights, const Geometry& geometry,
                                      const Scene& scene, bool emissiveMeshes) {
    const std::vector<LightState> areaLights = areaLightsOf(lights);
    std::vector<AreaEmitter> emitters;
    for (const LightState& light : areaLights) emitters.push_back(emitterOf(light));
    if (emissiveMeshes)
        forEachEmissiveTriangle(areaLights, geometry, scene,
                                [&](std::uint32_t, const AreaEmitter& emitter, bool panel) {
                                    if (!panel) emitters.push_back(emitter);
                                });

    std::vector<double> weights;
    double total = 0;
    for (const AreaEmitter& emitter : emitters) {
        weights.push_back(areaOf(emitter) * double{luminance(emitter.radiance)});
        total += weights.back();
    }
    std::vector<AreaEmitter> chosen;
    double sum = 0;
    float before = 0;
    for (size_t i = 0; i < emitters.size(); ++i) {
        sum += weights[i];
        AreaEmitter& emitter = emitters[i];
        emitter.upper = static_cast<float>(sum / total);
        emitter.probability = emitter.upper - before;
        if (!(emitter.probability > 0)) continue;
        before = emitter.upper;
        chosen.push_back(emitter);
    }
    // A number just below 1 must find one too.
    if (!chosen.empty()) {
        chosen.back().probability += 1 - chosen.back().upper;
        chosen.back().upper = 1;
    }
    return chosen;
}

std::vector<bool> areaLightPanels(std::span<const LightState> lights, const Geometry& geometry,
                                  const Scene& scene) {
    std::vector<bool> panels(geometry.triangleCount(), false);
    const std::vector<LightState> areaLights = areaLightsOf(lights);
    if (!areaLights.empty())
        forEachEmissiveTriangle(
            areaLights, geometry, scene,
            [&](std::uint32_t triangle, const AreaEmitter&, bool panel) { panels[triangle] = panel; });
    return panels;
}

EmitterSample sampleEmitters(std::span<const AreaEmitter> emitters, const glm::vec3& position,
                             const glm::vec3& normal, glm::vec2 u) {
    if (emitters.empty()) return {};
    const auto found = std::upper_bound(emitters.begin(), emitters.end(), u.x,
                                        [](float x, const AreaEmitter& e) { return x < e.upper; });
    const AreaEmitter& emitter = found == emitters.end() ? emitters.back() : *found;
    const float lower = emitter.upper - emitter.probability;
    u.x = std::clamp((u.x - lower) / emitter.probability, 0.0f, 0x1.fffffep-1f);
    EmitterSample sample = emitter.kind == AreaEmitter::Kind::Sphere
                               ? sampleSphere(emitter, position, normal, u)
                               : sampleFlat(emitter, position, normal, u);
    sample.light /= emitter.probability;
    return sample;
}

} // namespace kestrel
