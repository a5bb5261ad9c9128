// Reflective shadow maps (Dachsbacher and Stamminger, "Reflective Shadow Maps", 2005): what each light sees,
// with the light that goes back from there. The module `radiance` answers for hits of rays (ROMA paper,
// sections 5.1 and 6): a hit is projected into every map; where it lies on the surface that the texel holds,
// and is seen from that surface's lit side, the texel's radiance counts.
#pragma once
#include "graph/registry.h"
#include "light_maps.h"

namespace kestrel {

class ReflectiveShadowMap : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int resolution = 512;
    bool directional = true;
    bool areaLights = true;
    bool jitter = false;
    float positionJitter = 0;
    float bias = 1.5f;

private:
    void uploadViews(Commands& commands, int bytes, bool follows); // that a texel of all arrays takes
    [[nodiscard]] LightMapLayout layout(const SceneFacts& facts, bool follows) const;
    std::string told_; // of what cannot be as asked for
};

} // namespace kestrel
