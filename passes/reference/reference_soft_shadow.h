// Light straight from area lights and emissive meshes by Embree on the CPU: what SoftShadow is measured
// against.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class ReferenceSoftShadow final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int samples = 256;
    bool emission = true;
};

} // namespace kestrel
