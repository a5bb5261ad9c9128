#include "disc_samples.h"
#include "core/check.h"
#include "shared/random.h"
#include <cmath>
#include <numbers>

namespace kestrel {

std::vector<glm::vec4> discSamples(OcclusionKernelType kernel, int count) {
    KESTREL_CHECK(count > 0 && (count & (count - 1)) == 0);
    std::vector<glm::vec4> samples;
    for (int i = 0; i < count; ++i) {
        const auto index = static_cast<std::uint32_t>(count + i);
        const double u = shared::reverseBits32(index) / 4294967296.0;
        const double angle = 2 * std::numbers::pi * i / count;
        double radius = 0, density = 0;
        if (kernel == OcclusionKernelType::Vao) {
            radius = std::sqrt(1 - std::pow(u, 2.0 / 3));
            density = 2 * std::sqrt(1 - radius * radius);
        } else {
            radius = 2 / std::numbers::pi * std::asin(std::pow(u, 1.25));
            density = 0.9 * std::pow(1 - radius, 1.5);
        }
        samples.emplace_back(radius * std::sin(angle), radius * std::cos(angle),
                             std::sqrt(1 - radius * radius), 1 / density);
    }
    return samples;
}

} // namespace kestrel
