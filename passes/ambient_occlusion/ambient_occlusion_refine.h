// Ambient occlusion with what lies behind the first surface: the second pass of stenciled volumetric ambient
// occlusion (Brüll, Kern, Grosch 2022; 2024, section 2 and figure 3).
#pragma once
#include "graph/registry.h"

namespace kestrel {

// Refines the pixels that AmbientOcclusionFirst lists, those samples that its mask names; all others stay. By
// `layers` of any kind, or by every hit along a ray a sample, which is the truth that layers sample
// (Ray-SVAO).
class AmbientOcclusionRefine final : public Pass {
public:
    enum class Source { Layers, Hits };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    Source source = Source::Layers;
    bool dual = false;
};

} // namespace kestrel
