#include "reference/ambient_occlusion.h"
#include "core/error.h"
#include "shared/random.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace kestrel {
namespace {

glm::vec3 vectorAt(const Image& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

void checkInputs(const OcclusionInputs& inputs) {
    std::vector<Problem> problems;
    const auto check = [&](const Image& image, const char* name) {
        if (image.channels < 3) {
            problems.push_back(
                {{},
                 fmt::format("ambient occlusion needs 3 channels of the {}, not {}", name, image.channels)});
        }
        if (!image.sameSize(inputs.position)) {
            problems.push_back(
                {{},
                 fmt::format("ambient occlusion needs images of one size: the position is {}, the "
                             "{} {}",
                             inputs.position.sizeText(), name, image.sizeText())});
        }
    };
    check(inputs.position, "position");
    check(inputs.normal, "normal");
    if (!inputs.faceNormal.empty()) check(inputs.faceNormal, "face normal");
    if (!problems.empty()) throw InputError(std::move(problems));
}

// The unit disk with equal areas and little distortion (Shirley and Chiu, "A Low Distortion Map Between Disk
// and Square", 1997).
glm::vec2 concentricDisk(const glm::vec2& u) {
    const glm::vec2 s = 2.0f * u - 1.0f;
    if (s.x == 0 && s.y == 0) return {0, 0};
    constexpr float quarter = std::numbers::pi_v<float> / 4;
    const bool wide = std::abs(s.x) > std::abs(s.y);
    const float radius = wide ? s.x : s.y;
    const float angle = wide ? quarter * (s.y / s.x) : 2 * quarter - quarter * (s.x / s.y);
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

// Two unit vectors perpendicular to the unit vector n (Duff et al., "Building an Orthonormal Basis,
// Revisited", 2017).
void basisOf(const glm::vec3& n, glm::vec3& tangent, glm::vec3& bitangent) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1 / (sign + n.z), b = n.x * n.y * a;
    tangent = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
}

// Point `index` of the Owen-scrambled Sobol sequence of `seed`: shared::scrambledSobol without the shuffled
// order, which only a running sequence needs.
glm::vec2 sobolPoint(std::uint32_t index, std::uint32_t seed) {
    const std::uint32_t x = shared::reverseBits32(shared::laineKarras(index, shared::hashCombine(seed, 1)));
    const std::uint32_t y = shared::owenScramble(shared::sobol1(index), shared::hashCombine(seed, 2));
    return {shared::unitFloat(x), shared::unitFloat(y)};
}

constexpr int packet = 16; // rays that the tracer takes at once

class OcclusionPass {
public:
    OcclusionPass(const ReferenceTracer& tracer, const OcclusionInputs& inputs,
                  const OcclusionSettings& settings)
        : tracer_(tracer)
        , inputs_(inputs)
        , settings_(settings)
        , half_(std::max(1, (settings.samples + 1) / 2))
        , radius_(tracer.bounds().empty() ? 0 : 0.5f * glm::length(tracer.bounds().size()))
        , halves_(inputs.position.width, inputs.position.height, 2, 1.0f) {}

    OcclusionResult run() {
        forEachRow(
            halves_.height, settings_.threads, [this](int y) { traceRow(y); }, settings_.progress);
        return gather();
    }

private:
    void traceRow(int y) {
        std::vector<TraceRay> rays;
        std::vector<std::uint8_t> hits;
        for (int x = 0; x < halves_.width; ++x) {
            const glm::vec3 normal = vectorAt(inputs_.normal, x, y);
            if (normal == glm::vec3(0)) continue;
            for (int half = 0; half < 2; ++half) {
                rays.clear();
                addRays(rays, x, y, glm::normalize(normal), half);
                hits.assign(rays.size(), 0);
                tracer_.anyHits(rays, hits);
                const auto open = std::count(hits.begin(), hits.end(), std::uint8_t{0});
                halves_.at(x, y, half) = static_cast<float>(open) / static_cast<float>(half_);
            }
        }
    }

    void addRays(std::vector<TraceRay>& rays, int x, int y, const glm::vec3& normal, int half) const {
        const glm::vec3 position = vectorAt(inputs_.position, x, y);
        const glm::vec3 face =
            inputs_.faceNormal.empty() ? normal : glm::normalize(vectorAt(inputs_.faceNormal, x, y));
        const glm::vec3 size = glm::abs(position);
        const float scale = std::max({size.x, size.y, size.z, radius_});
        const glm::vec3 origin = position + face * (settings_.relativeOffset * scale);
        glm::vec3 tangent, bitangent;
        basisOf(normal, tangent, bitangent);
        const auto dimension = shared::randomReference + static_cast<std::uint32_t>(half);
        const std::uint32_t seed = shared::pixelSeed(glm::uvec2(x, y), dimension, settings_.seed);
        // Samples whose indices are equal modulo `stride` share a stratum of the first dimension: packets of
        // rays that run alike. How many are blocked does not depend on the order.
        const int stride = (half_ + packet - 1) / packet;
        for (int k = 0; k < stride; ++k) {
            for (int i = k; i < half_; i += stride) {
                const glm::vec2 disk = concentricDisk(sobolPoint(static_cast<std::uint32_t>(i), seed));
                const float up = std::sqrt(std::max(0.0f, 1 - glm::dot(disk, disk)));
                const glm::vec3 direction = tangent * disk.x + bitangent * disk.y + normal * up;
                if (glm::dot(direction, face) > 0)
                    rays.push_back({origin, direction, 0, settings_.maximumDistance});
            }
        }
    }

    [[nodiscard]] OcclusionResult gather() const {
        OcclusionResult result{Image(halves_.width, halves_.height, 1, 1.0f), 0, 0};
        double sum = 0;
        std::uint64_t pixels = 0;
        for (int y = 0; y < halves_.height; ++y) {
            for (int x = 0; x < halves_.width; ++x) {
                if (vectorAt(inputs_.normal, x, y) == glm::vec3(0)) continue;
                const float a = halves_.at(x, y, 0), b = halves_.at(x, y, 1);
                result.visibility.at(x, y) = 0.5f * (a + b);
                sum += static_cast<double>(a - b) * static_cast<double>(a - b);
                ++pixels;
            }
        }
        if (pixels > 0) result.noise = 0.5 * std::sqrt(sum / static_cast<double>(pixels));
        result.rays = pixels * 2 * static_cast<std::uint64_t>(half_);
        return result;
    }

    const ReferenceTracer& tracer_;
    const OcclusionInputs& inputs_;
    const OcclusionSettings& settings_;
    int half_;     // samples of each half
    float radius_; // of the geometry's bounds
    Image halves_; // visibility by each half
};

} // namespace

OcclusionResult ambientOcclusion(const ReferenceTracer& tracer, const OcclusionInputs& inputs,
                                 const OcclusionSettings& settings) {
    checkInputs(inputs);
    return OcclusionPass(tracer, inputs, settings).run();
}

} // namespace kestrel
