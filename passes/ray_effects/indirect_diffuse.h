// One bounce of diffuse light by rays through any tracer (ROMA paper, section 5).
#pragma once
#include "graph/registry.h"

namespace kestrel {

// `result` is the cosine-weighted mean of the radiance that arrives at a surface (its irradiance over pi):
// albedo times it is the diffuse light that leaves. A ray brings what the module `radiance` says of its
// closest hit, or of its direction where it meets nothing.
class IndirectDiffuse final : public Pass {
public:
    enum class Estimator { Paper, CosineRatio };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int rays = 1;
    float distance = 0;
    bool snap = true;
    Estimator estimator = Estimator::CosineRatio;
};

} // namespace kestrel
