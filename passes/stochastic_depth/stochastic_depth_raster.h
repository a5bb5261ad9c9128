// The rasterized stochastic depth map (Vermeer, Scandolo, Eisemann, "Stochastic-Depth Ambient Occlusion",
// 2021) where a mask asks for it (Brüll, Kern, Grosch, "Stenciled Volumetric Ambient Occlusion", 2022).
#pragma once
#include "graph/registry.h"

namespace kestrel {

// Draws the scene once at the map's resolution; slots are images, so that any number of them works and
// nothing depends on the positions of a driver's samples. (A form with gl_SampleMask on a target of K samples
// gives this map only where all samples can be placed at the centre of a pixel, by GL_ARB_sample_locations:
// llvmpipe has it not, so there is none.) Coverage masks and the k-buffer give the same map
// in whatever order fragments come, the reservoir depends on that order (drivers that shade in the order of
// drawing give the same each time).
class StochasticDepthRaster final : public Pass {
public:
    enum class Collection { CoverageMask, Reservoir, KBuffer };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int layers = 4;
    Collection collection = Collection::CoverageMask;
    bool interval = true;
    int divisor = 4;
    int guard = 0;
};

} // namespace kestrel
