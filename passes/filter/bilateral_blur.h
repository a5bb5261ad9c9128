// A separable blur that stops at edges of depth.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class BilateralBlur final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int radius = 4;
    float sharpness = 192;
    bool slope = true;
};

} // namespace kestrel
