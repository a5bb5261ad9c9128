// Ambient occlusion by rays through any tracer (ROMA paper, section 5, equation 1).
#pragma once
#include "graph/registry.h"

namespace kestrel {

class RayAmbientOcclusion final : public Pass {
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
