// One bounce of diffuse light by rays through any tracer (ROMA paper, section 5).
#pragma once
#include "draw/hemisphere_effect.h"

namespace kestrel {

// `result` is the cosine-weighted mean of the radiance that arrives at a surface (its irradiance over pi):
// albedo times it is the diffuse light that leaves. A ray brings what the module `radiance` says of its
// closest hit, or of its direction where it meets nothing.
class IndirectDiffuse final : public HemisphereEffect {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;
};

} // namespace kestrel
