// Ambient occlusion by rays through any tracer (ROMA paper, section 5, equation 1).
#pragma once
#include "draw/hemisphere_effect.h"

namespace kestrel {

class RayAmbientOcclusion final : public HemisphereEffect {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;
};

} // namespace kestrel
