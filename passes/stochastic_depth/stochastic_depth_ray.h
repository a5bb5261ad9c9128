// The ray traced stochastic depth map (Brüll, Kern, Grosch, "Ray Traced Stochastic Depth Map for Ambient
// Occlusion", 2024, section 3).
#pragma once
#include "graph/registry.h"
#include "trace_step.h"

namespace kestrel {

// One ray through each texel of the mask, from behind the first surface on, hands all its hits to a
// collection of a few slots. Random numbers depend on texel, seed and the hit's number along the ray, so that
// a still view gives a still map.
class StochasticDepthRay final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int layers = 4;
    RayCollection collection = RayCollection::Reservoir;
    int maxCount = 8;
    bool zCull = false;
    bool interval = true;
    bool jitter = true;
    int divisor = 4;
    int guard = 0;

private:
    void clearList(Commands& commands) const;
    void list(Commands& commands) const;
    void trace(Commands& commands) const;
};

} // namespace kestrel
