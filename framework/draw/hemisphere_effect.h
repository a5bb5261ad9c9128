// What effects share that send rays over the hemisphere of every pixel and bear that a tracer replaces
// directions by nearby ones (ROMA paper, section 5). Needs no GL.
#pragma once
#include "graph/registry.h"

namespace kestrel {

// Inputs "depth", "normal", "face_normal", "tracer"; outputs the effect's own and "weight", how much a frame
// counts.
class HemisphereEffect : public Pass {
public:
    enum class Estimator { Paper, CosineRatio };

    int rays = 1;
    float distance = 0; // scene units; 0: any
    bool snap = true;
    Estimator estimator = Estimator::CosineRatio;

protected:
    // The output "weight" and the properties. `counts`: what a frame adds to a mean; `reach`: what distance
    // means.
    template<class T>
    static Describe<T>& addRays(Describe<T>& table, const std::string& counts, const std::string& reach) {
        return table
            .output("weight", PortKind::Texture,
                    "How much this frame's " + counts +
                        " counts in a mean over frames (for snapping tracers); 1 where nothing is")
            .carries({.channels = 1})
            .number("rays", static_cast<int T::*>(&T::rays), 1, 256, "rays", "Rays a pixel and frame")
            .number("distance", static_cast<float T::*>(&T::distance), 0, 1e9, "scene units", reach)
            .flag("snap", static_cast<bool T::*>(&T::snap),
                  "Bears that a tracer replaces directions by nearby ones")
            .choice(
                "estimator", static_cast<Estimator T::*>(&T::estimator), {"paper", "cosine_ratio"},
                "How replaced directions count: all alike, or by their cosine over the mean cosine of those "
                "they stand for");
    }

    // `output` of `nothing` where there is no surface, made by `step` through "tracer", of which it asks
    // `asked`: the step gets the uses of inputs, output and weight, and is repeated as raySteps() says.
    [[nodiscard]] Declaration declareEffect(const World& world, const Inputs& inputs, const Demand& demand,
                                            Output output, const glm::vec4& nothing, Step step,
                                            Bits asked) const;
};

} // namespace kestrel
