// Light reflected by rough surfaces, by rays through any tracer.
#pragma once
#include "graph/registry.h"

namespace kestrel {

// `result` is the radiance that leaves each surface towards the eye by its specular lobe: GGX microfacets
// (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007) with Smith masking and
// Schlick's Fresnel term, the roughness squared as alpha and 4 % reflectance of what is not metal, as glTF
// says. Sampled by visible normals (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018);
// directions are never replaced. One bounce off microfacets: rough metal loses what would bounce twice, so it
// reflects at most what arrives.
class GlossyReflection final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int rays = 1;
    float distance = 0;
    float maxRoughness = 1;
};

} // namespace kestrel
