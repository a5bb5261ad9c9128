// The second depth layer by peeling (Everitt, "Interactive Order-Independent Transparency", 2001), with a
// least distance from the first (Mara, McGuire, Nowrouzezahrai, Luebke, "Deep G-Buffers for Stable Global
// Illumination Approximation", 2016).
#pragma once
#include "graph/registry.h"

namespace kestrel {

class SecondDepthLayer final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    float separation = 0;
};

} // namespace kestrel
