#include "reference/gather.h"
#include "core/error.h"
#include "reference/light_sampler.h"
#include "reference/sampling.h"
#include "reference/surface_sample.h"
#include "shared/ggx.h"
#include "shared/ray.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>

namespace kestrel {
namespace {

glm::vec3 rgbAt(const Image& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

void checkGatherInputs(const GatherInputs& inputs, bool material) {
    std::vector<Problem> problems;
    const auto check = [&](const Image& image, const char* name, int channels) {
        if (image.channels < channels)
            problems.push_back({{},
                                fmt::format("gathering light needs {} channels of the {}, not {}", channels,
                                            name, image.channels)});
        if (!image.sameSize(inputs.position))
            problems.push_back(
                {{},
                 fmt::format("gathering light needs images of one size: the position is {}, the {} {}",
                             inputs.position.sizeText(), name, image.sizeText())});
    };
    check(inputs.position, "position", 3);
    check(inputs.normal, "normal", 3);
    if (!inputs.faceNormal.empty()) check(inputs.faceNormal, "face normal", 3);
    if (material) {
        check(inputs.albedo, "albedo", 3);
        check(inputs.material, "material", 3);
    }
    if (!problems.empty()) throw InputError(std::move(problems));
}

// A pixel that light is gathered for, and the half of its samples that is drawn.
struct GatherPoint {
    int x, y;
    glm::vec3 position, normal, face; // unit
    glm::vec3 origin;                 // off the face
    std::uint32_t seed;               // of the pixel and half
};

// What the rays of one row need, used again from pixel to pixel.
struct GatherScratch {
    std::vector<TraceRay> rays;
    std::vector<glm::vec3> shares; // how much a ray's light counts
    std::vector<TraceHit> hits;
    ShadowRays shadows;
};

// Distinguishes the random numbers of a sample's second step (the point on a light, seen from the hit) from
// its first.
constexpr std::uint32_t gatherSecondStep = 0x51ed270bu;

using Halves = std::array<Image, 2>; // light, and in the fourth channel what becomes `visibility`

class Gathering {
public:
    // The mean over `half_` samples, as in Halves.
    using Estimate = std::function<glm::vec4(const GatherPoint&, GatherScratch&)>;

    Gathering(const GatherScene& scene, const GatherInputs& inputs, const GatherSettings& settings,
              bool meshes)
        : scene_(scene)
        , inputs_(inputs)
        , settings_(settings)
        , half_(std::max(1, (settings.samples + 1) / 2))
        , radius_(scene.tracer.bounds().empty() ? 0 : 0.5f * glm::length(scene.tracer.bounds().size()))
        , surfaces_(scene.geometry, scene.scene)
        , lights_(scene.lights, scene.geometry, scene.scene, meshes) {}

    GatherResult run(const Estimate& estimate) const {
        const int width = inputs_.position.width, height = inputs_.position.height;
        Halves halves{Image(width, height, 4), Image(width, height, 4)};
        forEachRow(
            height, settings_.threads,
            [&](int y) {
                GatherScratch scratch;
                for (int x = 0; x < width; ++x) {
                    if (rgbAt(inputs_.normal, x, y) == glm::vec3(0)) continue;
                    for (size_t half = 0; half < 2; ++half) {
                        const glm::vec4 mean = estimate(pointAt(x, y, half), scratch);
                        for (int k = 0; k < 4; ++k) halves[half].at(x, y, k) = mean[k];
                    }
                }
            },
            settings_.progress);
        return gathered(halves);
    }

    // The light that arrives along the rays of `scratch`, times their shares, over the number of samples.
    glm::vec3 arriving(const GatherPoint& point, GatherScratch& scratch) const {
        scratch.hits.assign(scratch.rays.size(), {});
        scene_.tracer.closestHits(scratch.rays, scratch.hits, false);
        scratch.shadows.clear();
        glm::vec3 light(0);
        for (size_t i = 0; i < scratch.rays.size(); ++i) {
            if (scratch.hits[i].triangle == TraceHit::none) {
                light += scratch.shares[i] * settings_.environment;
                continue;
            }
            const SurfaceSample met = surfaces_.at(scratch.hits[i], scratch.rays[i].direction);
            if (settings_.emission) light += scratch.shares[i] * met.emission;
            const glm::vec3 share = scratch.shares[i] * met.albedo * (1 - met.metallic);
            // As from an eye where the ray came from.
            const float start = shared::rayStart(scratch.hits[i].t, largestOf(met.position), met.reach);
            const glm::vec3 origin = met.position + start * met.faceNormal;
            const LitPoint lit{met.position, origin, met.normal, met.faceNormal};
            lights_.addPunctual(scratch.shadows, lit, share);
            lights_.addArea(scratch.shadows, lit, share,
                            sobolPoint(static_cast<std::uint32_t>(i), point.seed ^ gatherSecondStep));
        }
        light += scratch.shadows.trace(scene_.tracer);
        return light / static_cast<float>(half_);
    }

    // Calls `sample` with the points of a pixel's half. Samples whose indices are equal modulo the stride
    // share a stratum of the first dimension: packets of rays that run alike.
    void forEachSample(const GatherPoint& point, const std::function<void(const glm::vec2&)>& sample) const {
        const int stride = (half_ + tracePacket - 1) / tracePacket;
        for (int k = 0; k < stride; ++k)
            for (int i = k; i < half_; i += stride)
                sample(sobolPoint(static_cast<std::uint32_t>(i), point.seed));
    }

    [[nodiscard]] const LightSampler& lights() const { return lights_; }
    [[nodiscard]] int samples() const { return half_; }

private:
    static float largestOf(const glm::vec3& position) {
        const glm::vec3 size = glm::abs(position);
        return std::max({size.x, size.y, size.z});
    }

    [[nodiscard]] GatherPoint pointAt(int x, int y, size_t half) const {
        const glm::vec3 normal = glm::normalize(rgbAt(inputs_.normal, x, y));
        GatherPoint point{x, y, rgbAt(inputs_.position, x, y), normal, normal, {}, 0};
        if (!inputs_.faceNormal.empty()) point.face = glm::normalize(rgbAt(inputs_.faceNormal, x, y));
        const float off = inputs_.faceNormal.channels > 3
                              ? inputs_.faceNormal.at(x, y, 3)
                              : settings_.relativeOffset * std::max(largestOf(point.position), radius_);
        point.origin = point.position + off * point.face;
        // Apart from those of ambient occlusion.
        const auto dimension = shared::randomReference + 16 + static_cast<std::uint32_t>(half);
        point.seed = shared::pixelSeed(glm::uvec2(x, y), dimension, settings_.seed);
        return point;
    }

    [[nodiscard]] GatherResult gathered(const Halves& halves) const {
        const int width = halves[0].width, height = halves[0].height;
        GatherResult result{Image(width, height, 3), Image(width, height, 1, 1.0f), 0, 0};
        double sum = 0;
        std::uint64_t pixels = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                if (rgbAt(inputs_.normal, x, y) == glm::vec3(0)) continue;
                for (int k = 0; k < 3; ++k) {
                    const float a = halves[0].at(x, y, k), b = halves[1].at(x, y, k);
                    result.light.at(x, y, k) = 0.5f * (a + b);
                    sum += static_cast<double>(a - b) * static_cast<double>(a - b);
                }
                result.visibility.at(x, y) = 0.5f * (halves[0].at(x, y, 3) + halves[1].at(x, y, 3));
                ++pixels;
            }
        }
        if (pixels > 0) result.noise = 0.5 * std::sqrt(sum / static_cast<double>(3 * pixels));
        result.samples = pixels * 2 * static_cast<std::uint64_t>(half_);
        return result;
    }

    const GatherScene& scene_;
    const GatherInputs& inputs_;
    const GatherSettings& settings_;
    int half_; // samples of each half
    float radius_;
    SurfaceSampler surfaces_;
    LightSampler lights_;
};

} // namespace

GatherResult gatherIndirectDiffuse(const GatherScene& scene, const GatherInputs& inputs,
                                   const GatherSettings& settings) {
    checkGatherInputs(inputs, false);
    const Gathering gathering(scene, inputs, settings, false);
    return gathering.run([&](const GatherPoint& point, GatherScratch& scratch) {
        const glm::mat3 basis = basisAround(point.normal);
        scratch.rays.clear();
        gathering.forEachSample(point, [&](const glm::vec2& u) {
            const glm::vec3 direction = basis * cosineDirection(u);
            if (shared::leavesFace(direction, point.face))
                scratch.rays.push_back({point.origin, direction, 0, settings.maximumDistance});
        });
        scratch.shares.assign(scratch.rays.size(), glm::vec3(1));
        return glm::vec4(gathering.arriving(point, scratch), 1);
    });
}

GatherResult gatherSoftShadow(const GatherScene& scene, const GatherInputs& inputs,
                              const GatherSettings& settings) {
    checkGatherInputs(inputs, false);
    const Gathering gathering(scene, inputs, settings, settings.emission);
    return gathering.run([&](const GatherPoint& point, GatherScratch& scratch) {
        scratch.shadows.clear();
        gathering.forEachSample(point, [&](const glm::vec2& u) {
            gathering.lights().addArea(
                scratch.shadows, {point.position, point.origin, point.normal, point.face}, glm::vec3(1), u);
        });
        glm::vec3 unshadowed(0);
        const glm::vec3 arrives = scratch.shadows.trace(scene.tracer, &unshadowed);
        const float bright = luminance(unshadowed);
        return glm::vec4(arrives / static_cast<float>(gathering.samples()),
                         bright > 0 ? luminance(arrives) / bright : 1.0f);
    });
}

GatherResult gatherGlossyReflection(const GatherScene& scene, const GatherInputs& inputs,
                                    const CameraState& camera, const GatherSettings& settings) {
    checkGatherInputs(inputs, true);
    const Gathering gathering(scene, inputs, settings, false);
    const glm::vec3 backward = glm::vec3(glm::inverse(camera.view)[2]);
    return gathering.run([&](const GatherPoint& point, GatherScratch& scratch) {
        const glm::vec3 toEye =
            glm::normalize(camera.orthographic ? backward : camera.position - point.position);
        const glm::mat3 basis = basisAround(point.normal);
        const glm::vec3 view = toEye * basis, material = rgbAt(inputs.material, point.x, point.y);
        const float alpha = shared::ggxAlpha(material.x);
        const glm::vec3 f0 = glm::mix(glm::vec3(shared::dielectricReflectance),
                                      rgbAt(inputs.albedo, point.x, point.y), material.y);
        scratch.rays.clear();
        scratch.shares.clear();
        if (material.z < 0.5f)
            gathering.forEachSample(point, [&](const glm::vec2& u) {
                const glm::vec3 facet = shared::ggxVisibleNormal(view, alpha, u);
                const glm::vec3 leaving = 2 * glm::dot(view, facet) * facet - view;
                const glm::vec3 direction = glm::normalize(basis * leaving);
                if (!(leaving.z > 0) || !shared::leavesFace(direction, point.face)) return;
                scratch.rays.push_back({point.origin, direction, 0, settings.maximumDistance});
                scratch.shares.push_back(shared::schlickFresnel(f0, glm::dot(view, facet)) *
                                         shared::ggxShadowing(view.z, leaving.z, alpha));
            });
        return glm::vec4(gathering.arriving(point, scratch), 1);
    });
}

} // namespace kestrel
