#include "reference/transparency.h"
#include "core/error.h"
#include "reference/light_sampler.h"
#include "reference/primary_hits.h"
#include "reference/sampling.h"
#include "reference/surface_sample.h"
#include "shared/ggx.h"
#include "shared/random.h"
#include "shared/ray.h"
#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace kestrel {
namespace {

class BlendedSurfaces {
public:
    BlendedSurfaces(const GatherScene& scene, const CameraState& camera, const TransparencySettings& settings)
        : scene_(scene)
        , settings_(settings)
        , eye_(camera.position)
        , surfaces_(scene.geometry, scene.scene)
        , lights_(scene.lights, scene.geometry, scene.scene, false)
        , materials_(flattenedMaterials(scene.scene)) {}

    [[nodiscard]] const Material& materialOf(const TraceHit& hit) const {
        return materials_[scene_.geometry.materials[hit.triangle]];
    }

    // Whether the material is there for a ray that comes from this side.
    [[nodiscard]] bool isSeen(const TraceHit& hit, const glm::vec3& direction) const {
        if (materialOf(hit).doubleSided) return true;
        const std::uint32_t* corner = &scene_.geometry.indices[3 * static_cast<size_t>(hit.triangle)];
        const glm::vec3 a = scene_.geometry.positions[corner[0]];
        const glm::vec3 b = scene_.geometry.positions[corner[1]];
        const glm::vec3 c = scene_.geometry.positions[corner[2]];
        return glm::dot(glm::cross(b - a, c - a), direction) < 0;
    }

    // Colour and alpha of what a ray meets; `seed` is the pixel's.
    [[nodiscard]] glm::vec4 at(const TraceHit& hit, const glm::vec3& direction, std::uint32_t seed,
                               ShadowRays& rays) const {
        const SurfaceSample met = surfaces_.at(hit, direction);
        const glm::vec3 emission = settings_.emission ? met.emission : glm::vec3(0);
        if (materialOf(hit).unlit) return {met.albedo + emission, met.alpha};
        const glm::vec3 diffuse = met.albedo * (1 - met.metallic), size = glm::abs(met.position);
        const float start =
            shared::rayStart(glm::length(met.position - eye_), std::max({size.x, size.y, size.z}), met.reach);
        const LitPoint point{met.position, met.position + start * met.faceNormal, met.normal, met.faceNormal};
        rays.clear();
        lights_.addPunctual(rays, point, diffuse);
        if (settings_.highlights)
            lights_.addHighlights(
                rays, point, -glm::normalize(direction),
                glm::mix(glm::vec3(shared::dielectricReflectance), met.albedo, met.metallic),
                shared::ggxAlpha(met.roughness), glm::vec3(1));
        if (!lights_.emitters().empty())
            for (int i = 0; i < settings_.samples; ++i)
                lights_.addArea(rays, point, diffuse / static_cast<float>(settings_.samples),
                                sobolPoint(static_cast<std::uint32_t>(i), seed));
        const glm::vec3 light = settings_.shadows
                                    ? rays.trace(scene_.tracer)
                                    : std::accumulate(rays.light.begin(), rays.light.end(), glm::vec3(0));
        return {emission + light + diffuse * settings_.ambient, met.alpha};
    }

private:
    const GatherScene& scene_;
    const TransparencySettings& settings_;
    glm::vec3 eye_;
    SurfaceSampler surfaces_;
    LightSampler lights_;
    std::vector<Material> materials_;
};

} // namespace

TransparencyResult compositeBlended(const GatherScene& scene, const ReferenceTracer& seen,
                                    const CameraState& camera, const Image& opaque,
                                    const TransparencySettings& settings) {
    if (opaque.channels < 3)
        throw InputError(
            fmt::format("compositing needs 3 channels of the opaque picture, not {}", opaque.channels));
    const BlendedSurfaces surfaces(scene, camera, settings);
    const int width = opaque.width, height = opaque.height;
    TransparencyResult result{Image(width, height, 4), Image(width, height, 1)};
    forEachRow(
        height, settings.threads,
        [&](int y) {
            const std::vector<TraceRay> rays = cameraRays(camera, width, height, y);
            std::vector<TraceHit> hits;
            ShadowRays shadows;
            for (int x = 0; x < width; ++x) {
                const TraceRay& ray = rays[static_cast<size_t>(x)];
                hits.clear();
                seen.allHits(ray, [&](const TraceHit& hit) {
                    hits.push_back(hit);
                    return false;
                });
                std::sort(hits.begin(), hits.end(), [](const TraceHit& a, const TraceHit& b) {
                    return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
                });
                const std::uint32_t seed =
                    shared::pixelSeed(glm::uvec2(x, y), shared::randomReference + 32, settings.seed);
                glm::vec3 colour(0);
                float through = 1, met = 0;
                for (const TraceHit& hit : hits) {
                    if (!surfaces.isSeen(hit, ray.direction)) continue;
                    if (surfaces.materialOf(hit).alphaMode != AlphaMode::Blend) break;
                    const glm::vec4 surface = surfaces.at(hit, ray.direction, seed, shadows);
                    colour += through * surface.a * glm::vec3(surface);
                    through *= 1 - surface.a;
                    ++met;
                }
                for (int k = 0; k < 3; ++k)
                    result.picture.at(x, y, k) = colour[k] + through * opaque.at(x, y, k);
                const float covered = opaque.channels > 3 ? opaque.at(x, y, 3) : 1;
                result.picture.at(x, y, 3) = 1 - through * (1 - covered);
                result.surfaces.at(x, y) = met;
            }
        },
        settings.progress);
    return result;
}

} // namespace kestrel
