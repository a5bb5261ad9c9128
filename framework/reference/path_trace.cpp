#include "reference/path_trace.h"
#include "core/error.h"
#include "reference/light_sampler.h"
#include "reference/sampling.h"
#include "reference/surface_sample.h"
#include "shared/bsdf.h"
#include "shared/ray.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

glm::vec3 colourAt(const Image& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

void checkPathInputs(const PathInputs& inputs) {
    std::vector<Problem> problems;
    const auto check = [&](const Image& image, const char* name, int channels) {
        if (image.channels < channels)
            problems.push_back({{},
                                fmt::format("tracing paths needs {} channels of the {}, not {}", channels,
                                            name, image.channels)});
        if (!image.sameSize(inputs.position))
            problems.push_back(
                {{},
                 fmt::format("tracing paths needs images of one size: the position is {}, the {} {}",
                             inputs.position.sizeText(), name, image.sizeText())});
    };
    check(inputs.position, "position", 3);
    check(inputs.normal, "normal", 3);
    check(inputs.albedo, "albedo", 3);
    check(inputs.material, "material", 3);
    if (!inputs.faceNormal.empty()) check(inputs.faceNormal, "face normal", 4);
    if (!inputs.emission.empty()) check(inputs.emission, "emission", 3);
    if (!inputs.refraction.empty()) check(inputs.refraction, "refraction", 2);
    if (!problems.empty()) throw InputError(std::move(problems));
}

float largestOf(const glm::vec3& position) {
    const glm::vec3 size = glm::abs(position);
    return std::max({size.x, size.y, size.z});
}

// Where a path turns.
struct PathPoint {
    glm::vec3 position{0}, normal{0}, face{0}; // unit, on the side that the path came from
    float start = 0;                           // how far off the face rays begin
    shared::BsdfSurface bsdf{};
    glm::vec3 emission{0};
    bool unlit = false;
};

// Paths of one pixel and half, in step.
struct PathWave {
    std::vector<TraceRay> rays; // of those that go on
    std::vector<std::uint32_t> samples;
    std::vector<glm::vec3> throughputs;
    std::vector<std::uint8_t> diffuse; // whether the diffuse part drew the ray
    std::vector<TraceHit> hits;
    ShadowRays shadows;
    void clear() {
        rays.clear();
        samples.clear();
        throughputs.clear();
        diffuse.clear();
    }
};

struct PathLight {
    glm::vec3 direct{0}, indirect{0};
};

class PathTracing {
public:
    PathTracing(const GatherScene& scene, const PathInputs& inputs, const CameraState& camera,
                const PathSettings& settings)
        : scene_(scene)
        , inputs_(inputs)
        , settings_(settings)
        , half_(static_cast<std::uint32_t>(std::max(1, (settings.samples + 1) / 2)))
        , eye_(camera.position)
        , backward_(glm::inverse(camera.view)[2])
        , parallel_(camera.orthographic)
        , surfaces_(scene.geometry, scene.scene)
        , lights_(scene.lights, scene.geometry, scene.scene, false) {
        if (settings.areaLights) panels_ = areaLightPanels(scene.lights, scene.geometry, scene.scene);
    }

    PathResult run() const {
        const int width = inputs_.position.width, height = inputs_.position.height;
        PathResult result{Image(width, height, 3), Image(width, height, 3), 0, 0};
        std::vector<double> squares(static_cast<size_t>(height), 0), counts(static_cast<size_t>(height), 0);
        forEachRow(
            height, settings_.threads,
            [&](int y) {
                PathWave wave;
                for (int x = 0; x < width; ++x) {
                    glm::vec3 radiance = settings_.environment, indirect(0);
                    if (colourAt(inputs_.normal, x, y) != glm::vec3(0)) {
                        const PathLight a = pixel(x, y, 0, wave), b = pixel(x, y, 1, wave);
                        indirect = 0.5f * (a.indirect + b.indirect);
                        radiance = 0.5f * (a.direct + b.direct) + indirect;
                        const glm::vec3 apart = a.direct + a.indirect - b.direct - b.indirect;
                        squares[static_cast<size_t>(y)] += double{glm::dot(apart, apart)};
                        counts[static_cast<size_t>(y)] += 1;
                    }
                    for (int k = 0; k < 3; ++k) {
                        result.radiance.at(x, y, k) = radiance[k];
                        result.indirect.at(x, y, k) = indirect[k];
                    }
                }
            },
            settings_.progress);
        double sum = 0, pixels = 0;
        for (size_t y = 0; y < squares.size(); ++y) {
            sum += squares[y];
            pixels += counts[y];
        }
        if (pixels > 0) result.noise = 0.5 * std::sqrt(sum / (3 * pixels));
        result.samples = static_cast<std::uint64_t>(pixels) * 2 * half_;
        return result;
    }

private:
    [[nodiscard]] PathPoint firstPoint(int x, int y) const {
        PathPoint point;
        point.position = colourAt(inputs_.position, x, y);
        point.normal = glm::normalize(colourAt(inputs_.normal, x, y));
        point.face =
            inputs_.faceNormal.empty() ? point.normal : glm::normalize(colourAt(inputs_.faceNormal, x, y));
        point.start = inputs_.faceNormal.empty() ? shared::rayStart(glm::distance(eye_, point.position),
                                                                    largestOf(point.position), 0)
                                                 : inputs_.faceNormal.at(x, y, 3);
        point.bsdf = {colourAt(inputs_.albedo, x, y), inputs_.material.at(x, y, 1),
                      inputs_.material.at(x, y, 0), 0, 1.5f};
        if (!inputs_.refraction.empty()) {
            point.bsdf.transmission = inputs_.refraction.at(x, y, 0);
            point.bsdf.eta = inputs_.refraction.at(x, y, 1);
        }
        if (!inputs_.emission.empty()) point.emission = colourAt(inputs_.emission, x, y);
        point.unlit = inputs_.material.at(x, y, 2) > 0.5f;
        return point;
    }

    [[nodiscard]] PathPoint metPoint(const TraceRay& ray, const TraceHit& hit) const {
        const SurfaceSample met = surfaces_.at(hit, ray.direction);
        PathPoint point;
        point.position = met.position;
        point.normal = met.normal;
        point.face = met.faceNormal;
        // As from an eye where the ray came from.
        point.start = shared::rayStart(hit.t, largestOf(met.position), met.reach);
        point.bsdf = {met.albedo, met.metallic, met.roughness, met.transmission, met.eta};
        point.emission = met.emission;
        point.unlit = met.unlit;
        return point;
    }

    // Asks the lights, and lets the path of this sample go on unless `last`.
    void scatter(const PathPoint& at, const glm::vec3& toward, const glm::vec3& throughput,
                 std::uint32_t sample, std::uint32_t seed, bool last, PathWave& onward) const {
        const auto numbers = [&](std::uint32_t use) {
            return shared::scrambledSobol(sample, shared::hashCombine(seed, use));
        };
        // A smooth normal can look away from where the path comes from; the face never does.
        const glm::vec3 normal = glm::dot(at.normal, toward) > 0 ? at.normal : at.face;
        const glm::mat3 basis = basisAround(normal);
        const shared::BsdfSample drawn = shared::sampleBsdf(at.bsdf, toward * basis, numbers(0).x, numbers(1),
                                                            cosineDirection(numbers(2)));
        if (luminance(drawn.diffuse) > 0) {
            const LitPoint lit{at.position, at.position + at.start * at.face, normal, at.face};
            const glm::vec3 scale = throughput * drawn.diffuse;
            lights_.addPunctual(onward.shadows, lit, scale);
            if (settings_.areaLights) lights_.addArea(onward.shadows, lit, scale, numbers(3));
        }
        if (last || drawn.lobe == shared::bsdfNone) return;
        const glm::vec3 direction = glm::normalize(basis * drawn.direction);
        const glm::vec3 side = drawn.lobe == shared::bsdfTransmission ? -at.face : at.face;
        if (!shared::leavesFace(direction, side)) return;
        onward.rays.push_back({at.position + at.start * side, direction});
        onward.samples.push_back(sample);
        onward.throughputs.push_back(throughput * drawn.weight);
        onward.diffuse.push_back(drawn.lobe == shared::bsdfDiffuse ? 1 : 0);
    }

    // The mean over a pixel's half of the paths.
    PathLight pixel(int x, int y, std::uint32_t half, PathWave& wave) const {
        PathLight light;
        const PathPoint first = firstPoint(x, y);
        light.direct = first.unlit ? first.bsdf.colour + first.emission : first.emission;
        if (first.unlit) return light;
        const std::uint32_t seed =
            shared::pixelSeed(glm::uvec2(x, y), shared::randomReference + 32 + half, settings_.seed);
        const auto seedOf = [&](int bounce) {
            return shared::hashCombine(seed, static_cast<std::uint32_t>(bounce));
        };
        const glm::vec3 toEye = glm::normalize(parallel_ ? backward_ : eye_ - first.position);
        const float share = 1.0f / static_cast<float>(half_);
        wave.clear();
        wave.shadows.clear();
        for (std::uint32_t i = 0; i < half_; ++i)
            scatter(first, toEye, glm::vec3(1), i, seedOf(0), settings_.bounces == 0, wave);
        light.direct += share * wave.shadows.trace(scene_.tracer);
        PathWave onward;
        for (int bounce = 1; bounce <= settings_.bounces && !wave.rays.empty(); ++bounce) {
            wave.hits.assign(wave.rays.size(), {});
            scene_.tracer.closestHits(wave.rays, wave.hits, false);
            onward.clear();
            onward.shadows.clear();
            for (size_t i = 0; i < wave.rays.size(); ++i) {
                const glm::vec3& throughput = wave.throughputs[i];
                const TraceHit& hit = wave.hits[i];
                if (hit.triangle == TraceHit::none) {
                    light.indirect += share * throughput * settings_.environment;
                    continue;
                }
                const PathPoint met = metPoint(wave.rays[i], hit);
                if (met.unlit) {
                    light.indirect += share * throughput * (met.bsdf.colour + met.emission);
                    continue;
                }
                const bool asked = wave.diffuse[i] != 0 && !panels_.empty() && panels_[hit.triangle];
                if (!asked) light.indirect += share * throughput * met.emission;
                scatter(met, -wave.rays[i].direction, throughput, wave.samples[i], seedOf(bounce),
                        bounce == settings_.bounces, onward);
            }
            light.indirect += share * onward.shadows.trace(scene_.tracer);
            std::swap(wave, onward);
        }
        return light;
    }

    const GatherScene& scene_;
    const PathInputs& inputs_;
    const PathSettings& settings_;
    std::uint32_t half_; // paths of each half
    glm::vec3 eye_, backward_;
    bool parallel_;
    SurfaceSampler surfaces_;
    LightSampler lights_;
    std::vector<bool> panels_; // by triangle; empty: none
};

} // namespace

PathResult tracePaths(const GatherScene& scene, const PathInputs& inputs, const CameraState& camera,
                      const PathSettings& settings) {
    checkPathInputs(inputs);
    return PathTracing(scene, inputs, camera, settings).run();
}

} // namespace kestrel
