// Ambient occlusion from the depth buffer by horizons, as engines use it: GTAO (Jimenez, Wu, Pesce, Jarabo
// 2016) and the visibility bitmask (Therrien, Levesque, Gilet 2023).
#pragma once
#include "graph/registry.h"

namespace kestrel {

class HorizonAmbientOcclusion final : public Pass {
public:
    enum class Method { Gtao, Bitmask };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    Method method = Method::Gtao;
    int slices = 2;
    int steps = 8;
    float radius = 0.5f;
    float maximumRadius = 512;
    float thickness = 0.1f;
    float exponent = 1;
};

} // namespace kestrel
