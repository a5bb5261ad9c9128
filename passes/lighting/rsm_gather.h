// One bounce of diffuse light gathered from reflective shadow maps without visibility (Dachsbacher and
// Stamminger, "Reflective Shadow Maps", 2005): each texel is a small lamp, and those near the point's own
// place in the map are asked.
#pragma once
#include "graph/registry.h"
#include "light_maps.h"
#include <optional>

namespace kestrel {

class RsmGather : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int samples = 64;
    float radius = 0.5f;
    bool rotate = true;
};

} // namespace kestrel
