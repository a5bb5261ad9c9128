// Blended materials without an order (McGuire and Bavoil, "Weighted Blended Order-Independent Transparency",
// JCGT 2(2), 2013): one drawing, a mean of the colours weighted by alpha and depth, and exactly what all
// together let through. Exact for one surface, and where all have one colour.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class WeightedBlended final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    enum class Weight { None, Equation7, Equation8, Equation9, Equation10 };
    Weight weight = Weight::Equation7;
    float scale = 1;
    glm::vec3 ambient{0};

private:
    void draw(Commands& commands) const;
};

} // namespace kestrel
