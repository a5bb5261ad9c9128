// Light reflected by rough surfaces by Embree on the CPU: what GlossyReflection is measured against.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class ReferenceGlossyReflection final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int samples = 256;
    float distance = 0;
    bool emission = true;
    glm::vec3 environment{0};
};

} // namespace kestrel
