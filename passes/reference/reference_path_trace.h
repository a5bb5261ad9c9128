// Path tracing by Embree on the CPU: what PathTrace is measured against.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class ReferencePathTrace final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int samples = 256;
    int bounces = 2;
    bool areaLights = true;
    glm::vec3 environment{0};
};

} // namespace kestrel
