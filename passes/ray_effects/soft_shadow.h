// Light straight from area lights and emissive meshes, by shadow rays through any tracer.
#pragma once
#include "graph/registry.h"
#include "reference/area_emitters.h"
#include <vector>

namespace kestrel {

// `result` is the irradiance over pi that arrives: albedo times it is the diffuse light that leaves. Each ray
// chooses one emitter by area times luminance, and a point on it: `rays` is for all emitters together,
// whatever their number. Rectangles and triangles are sampled by area, spheres in the cone that they fill.
// Directions are never replaced unless `snap` is set.
//
// A frame's `visibility` is a ratio of what arrives to what could; the ratio of many frames is their mean
// weighted by `weight`. A plain mean counts frames whose points of the lights lie below the horizon as lit.
class SoftShadow final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int rays = 1;
    bool emission = true, snap = false;

private:
    void upload(Commands& commands);
    void trace(Commands& commands) const;

    std::vector<AreaEmitter> emitters_; // as uploaded
};

} // namespace kestrel
