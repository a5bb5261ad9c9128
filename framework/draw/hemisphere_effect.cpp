#include "draw/hemisphere_effect.h"
#include "draw/face_input.h"
#include "draw/ray_steps.h"

namespace kestrel {

Declaration HemisphereEffect::declareEffect(const World& world, const Inputs& inputs, const Demand& demand,
                                            Output output, const glm::vec4& nothing, Step step,
                                            Bits asked) const {
    Declaration declaration;
    const Desc& depth = inputs["depth"].desc;
    const bool snaps =
        snap && (inputs["tracer"].desc.provides & (provides::Snaps | provides::AlwaysSnaps)) != 0;
    const bool background = inputs["depth"].constant == glm::vec4(0);
    const bool weighted = demand.reads("weight");

    Output weight{.port = "weight", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)};
    if (background) output.constant = nothing;
    if (background || !snaps) weight.constant = glm::vec4(1);
    step.uses.push_back({.port = "depth", .access = Access::Fetch});
    step.uses.push_back({.port = "normal", .access = Access::Image});
    step.uses.push_back({.port = output.port, .access = Access::Image, .write = true});
    declaration.outputs.push_back(std::move(output));
    if (weighted) declaration.outputs.push_back(weight);
    if (background) {
        declaration.leftOut.push_back({"tracing", "the depth is empty everywhere"});
        return declaration;
    }
    if (weighted && !snaps)
        declaration.leftOut.push_back({"weight", "the tracer traces the directions that were asked for"});

    step.modules.push_back({"tracer", asked | (snap ? requests::Snap : 0)});
    if (snaps) {
        if (estimator == Estimator::CosineRatio) step.defines.emplace("COSINE_RATIO", "1");
        // Between steps the sum of weights must live somewhere, also if nobody else reads it.
        if (weighted || rays > raysPerStep(inputs["tracer"].desc)) {
            step.defines.emplace("WEIGHT", "1");
            step.uses.push_back({.port = "weight", .access = Access::Image, .write = true});
            if (!weighted) declaration.outputs.push_back(weight);
        }
    }
    useFaceNormal(declaration, step, inputs);
    declaration.steps = raySteps(std::move(step), rays, inputs["tracer"].desc, world.facts);
    declaration.depends = Causes::Frame;
    return declaration;
}

} // namespace kestrel
