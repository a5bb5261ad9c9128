// Temporal anti-aliasing: jittered frames become a supersampled picture, followed over motion.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class TemporalAa final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    float feedback = 0.9f;
    float gamma = 1;
    float gammaStill = 3;
    bool tame = false;
};

} // namespace kestrel
