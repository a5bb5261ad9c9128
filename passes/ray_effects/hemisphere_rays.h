// One ray a pixel over the cosine-weighted hemisphere, as a buffer: what RayQuery traces.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class HemisphereRays final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    float distance = 0;
};

} // namespace kestrel
