#include "reference/ambient_occlusion.h"
#include "core/error.h"
#include "reference/sampling.h"
#include "shared/ray.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

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
        const float off = inputs_.faceNormal.channels > 3
                              ? inputs_.faceNormal.at(x, y, 3)
                              : settings_.relativeOffset * std::max({size.x, size.y, size.z, radius_});
        const glm::vec3 origin = position + off * face;
        const glm::mat3 basis = basisAround(normal);
        const auto dimension = shared::randomReference + static_cast<std::uint32_t>(half);
        const std::uint32_t seed = shared::pixelSeed(glm::uvec2(x, y), dimension, settings_.seed);
        // Samples whose indices are equal modulo `stride` share a stratum of the first dimension: packets of
        // rays that run alike. How many are blocked does not depend on the order.
        const int stride = (half_ + tracePacket - 1) / tracePacket;
        for (int k = 0; k < stride; ++k) {
            for (int i = k; i < half_; i += stride) {
                const glm::vec3 direction =
                    basis * cosineDirection(sobolPoint(static_cast<std::uint32_t>(i), seed));
                if (shared::leavesFace(direction, face))
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
