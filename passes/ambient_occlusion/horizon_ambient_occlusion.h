// Ambient occlusion from the depth buffer by horizons, as engines use it: GTAO (Jimenez, Wu, Pesce, Jarabo
// 2016) and the visibility bitmask (Therrien, Levesque, Gilet 2023); and what no paper has, the bitmask over
// depth layers.
#pragma once
#include "graph/registry.h"

namespace kestrel {

// The bitmask with a constant thickness guesses what lies behind the first surface. With layers nothing is
// guessed: each surface that a texel of the map tells of takes the light that it hides away, and is no
// thicker than samples lie apart; a first surface far in front hides none of those behind.
class HorizonAmbientOcclusion final : public Pass {
public:
    enum class Method { Gtao, Bitmask };
    enum class Thickness { Constant, Layers };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    Method method = Method::Gtao;
    int slices = 2;
    int steps = 8;
    float radius = 0.5f;
    float maximumRadius = 512;
    Thickness thicknessFrom = Thickness::Constant;
    float thickness = 0.1f;
    float exponent = 1;
};

} // namespace kestrel
