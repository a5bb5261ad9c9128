#include "dielectric_layer.h"
#include "shared/ggx.h"
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace kestrel {

float throughDielectricLayer(float cosView, float roughness) {
    constexpr int n = 24; // strata a side
    const float cosine = std::max(cosView, 1e-3f);
    const glm::vec3 view(std::sqrt(std::max(0.0f, 1 - cosine * cosine)), 0, cosine);
    const float alpha = shared::ggxAlpha(roughness);
    const glm::vec3 f0(shared::dielectricReflectance);
    float mixed = 0, reflected = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const glm::vec2 u((static_cast<float>(i) + 0.5f) / n, (static_cast<float>(j) + 0.5f) / n);
            const float radius = std::sqrt(u.x), angle = 2 * std::numbers::pi_v<float> * u.y;
            const glm::vec3 light(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - u.x));
            mixed += shared::schlickFresnel(f0, glm::dot(view, glm::normalize(view + light))).x;
            // As GlossyReflection weighs its rays.
            const glm::vec3 facet = shared::ggxVisibleNormal(view, alpha, u);
            const glm::vec3 leaving = 2 * glm::dot(view, facet) * facet - view;
            if (leaving.z > 0)
                reflected += shared::schlickFresnel(f0, glm::dot(view, facet)).x *
                             shared::ggxShadowing(view.z, leaving.z, alpha);
        }
    return 1 - std::max(mixed, reflected) / (n * n);
}

const std::vector<float>& dielectricLayerTable() {
    static const std::vector<float> table = [] {
        std::vector<float> values;
        constexpr float last = dielectricLayerSide - 1;
        for (int r = 0; r < dielectricLayerSide; ++r)
            for (int c = 0; c < dielectricLayerSide; ++c)
                values.push_back(
                    throughDielectricLayer(static_cast<float>(c) / last, static_cast<float>(r) / last));
        return values;
    }();
    return table;
}

} // namespace kestrel
