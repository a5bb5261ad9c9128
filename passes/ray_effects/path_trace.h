// Path tracing through any tracer (Vardis, Vasilakis, Papaioannou, "A Multiview and Multilayer Approach for
// Interactive Ray Tracing", 2016, section 4.1).
#pragma once
#include "graph/registry.h"

namespace kestrel {

// From the surfaces of a G-buffer on: one ray a path and bounce, drawn by the BSDF (shaders/shared/bsdf.h);
// at every surface what the module `radiance` says of the lights, by their shadow maps; what is met sends out
// its emission, and a ray that meets nothing brings what the module says of its direction. ReferencePathTrace
// tells the same by Embree, and how emission and lights stand to each other.
//
// `result` and `indirect` are the means over the frames since something other than the frame changed, with
// the number of paths in alpha; they need no Accumulate. With `adaptive` the paths of all pixels in the mean
// are reported.
class PathTrace final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int bounces = 2;
    int samples = 1;
    bool adaptive = false;
    float share = 0.25f;
    int warmUp = 16;
    bool areaLights = true;

private:
    struct Shape;
    [[nodiscard]] Shape shapeOf(const World& world, const Inputs& inputs, const Demand& demand) const;
    void declareChoice(const Shape& shape, Declaration& declaration) const;
    void declarePath(const World& world, const Inputs& inputs, const Shape& shape, int path,
                     Declaration& declaration) const;
    void report(Commands& commands);
    void prepare(Commands& commands);
    void choose(Commands& commands) const;
    void total(Commands& commands) const;
    void clear(Commands& commands, int lists, std::uint64_t stride) const;
    void begin(Commands& commands, int path) const;
    void bounce(Commands& commands, int path, int bounce, std::uint64_t stride) const;
    void add(Commands& commands, int path) const;

    std::uint32_t frames_ = 0; // in the present mean, with this one
    double paths_ = 0;         // in it, of all pixels, where they are chosen
};

} // namespace kestrel
