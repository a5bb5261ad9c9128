// Light that comes straight from the scene's lights, through shadow maps.
//
// Rectangles and spheres are evaluated exactly over their whole area (Lambert's formula, Snyder's for a
// sphere), but their shadow is that of their middle: hard, and wrong by the width of the penumbra. Soft
// shadows of area lights are the business of a pass that samples them.
#pragma once
#include "graph/registry.h"
#include "light_maps.h"

namespace kestrel {

class DirectLight : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    enum class Filter { Nearest, Two, Four };
    int resolution = 1024;
    bool shadows = true;
    Filter filter = Filter::Two;
    float bias = 1;
    bool emission = true;
    bool areaLights = true;
    bool highlights = false;

private:
    void uploadViews(Commands& commands, const LightMapLayout& maps);
    [[nodiscard]] LightMapLayout layout(const SceneFacts& facts, std::uint32_t nested) const;
    [[nodiscard]] Defines lightDefines(const LightMapLayout& maps) const;
    void declareShading(const World& world, const Inputs& inputs, const Demand& demand,
                        const LightMapLayout& maps, Declaration& declaration) const;
    void declareModule(const World& world, const LightMapLayout& maps, Declaration& declaration) const;
    std::string told_; // of what cannot be as asked for
};

} // namespace kestrel
