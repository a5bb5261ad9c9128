// Makes anything visible: channels, ranges, layers and slices of textures, and cells of an occupancy map.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class DebugView final : public Pass {
public:
    enum class Show { Colour, Red, Green, Blue, Alpha, Normal, HeatMap };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    Show show = Show::Colour;
    glm::vec2 range{0, 1};
    int layer = 0;
    int mip = 0;
    float slice = 0.5f;

private:
    [[nodiscard]] Declaration declareTexture(const Desc& desc) const;
    [[nodiscard]] Declaration declareOccupancy() const;
    void showTexture(Commands& commands, ResourceKind kind) const;
    void showOccupancy(Commands& commands) const;
};

} // namespace kestrel
