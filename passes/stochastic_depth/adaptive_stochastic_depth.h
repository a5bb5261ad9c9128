// A stochastic depth map of two resolutions: the adaptive resolution that Brüll, Kern, Grosch ("Ray Traced
// Stochastic Depth Map for Ambient Occlusion", 2024) name as future work (section 6).
#pragma once
#include "graph/registry.h"
#include "trace_step.h"

namespace kestrel {

// Takes a coarse map and traces the cells of some of its texels anew, a ray a cell, only those cells that
// samples fall into: of a texel whose nearest depth is far from that of a neighbour (an edge), and of one
// that many samples share (density). A cell is a quarter of a texel per axis, which of a map of a quarter of
// the resolution is a pixel. Cells that are not traced answer as the coarse map does.
class AdaptiveStochasticDepth final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    bool edges = true;
    float edge = 0.5f;
    int density = 17;
    RayCollection collection = RayCollection::Reservoir;
    int maxCount = 8;
    bool zCull = false;
    bool interval = true;

private:
    void clearList(Commands& commands) const;
    void choose(Commands& commands) const;
    void trace(Commands& commands) const;
};

} // namespace kestrel
