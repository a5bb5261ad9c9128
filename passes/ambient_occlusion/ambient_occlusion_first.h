// Ambient occlusion from the depth buffer, and where it needs more than the first surface: the first pass of
// stenciled volumetric ambient occlusion (Brüll, Kern, Grosch 2022; Brüll, Kern, Grosch, "Ray Traced
// Stochastic Depth Map for Ambient Occlusion", 2024, section 2 and figure 3).
#pragma once
#include "disc_samples.h"
#include "graph/registry.h"

namespace kestrel {

// Per sample of the disc: the sphere's free chord by the depth there (vao) or the horizon's occlusion (hbao).
// Where a first surface far before the sphere hides what occludes, the sample's bit is set in the mask; and
// the texel of the stochastic depth map that answers for it learns between which distances from the eye it
// must look.
class AmbientOcclusionFirst final : public Pass {
public:
    enum class Samples { Eight, Sixteen, ThirtyTwo };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    OcclusionKernelType kernel = OcclusionKernelType::Vao;
    Samples samples = Samples::Eight;
    float radius = 0.5f;
    float exponent = 2;
    float thickness = 0;
    float cutoff = 6;          // pixels: halos that are smaller are not seen (2024, section 3.4)
    float maximumRadius = 512; // pixels (2024, section 3.5)
    bool dual = false;
    int divisor = 4;
    int guard = 512;

private:
    void prepare(Commands& commands) const;
    void occlude(Commands& commands) const;
    void list(Commands& commands) const;
    void mark(Commands& commands) const;
    [[nodiscard]] int sampleCount() const { return 8 << static_cast<int>(samples); }
    [[nodiscard]] View mapView(const View& depth) const;
};

} // namespace kestrel
