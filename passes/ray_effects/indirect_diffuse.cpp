#include "indirect_diffuse.h"
#include "draw/face_input.h"
#include "draw/no_light.h"
#include "draw/ray_steps.h"
#include "execute/commands.h"

namespace kestrel {

PassType IndirectDiffuse::type() {
    return Describe<IndirectDiffuse>("IndirectDiffuse",
                                     "One bounce of diffuse light by rays through any tracer")
        .input("depth", PortKind::Texture, "Reversed depth of the surfaces")
        .carries(content::depth)
        .input("normal", PortKind::Texture, "Their normals, unit, render space")
        .carries(content::normal)
        .sameExtentAs("depth")
        .optionalInput("face_normal", PortKind::Texture, faceNormalDescription)
        .carries(content::normal)
        .sameExtentAs("depth")
        .input("tracer", PortKind::Tracer, "Who answers the closest-hit queries")
        .input("radiance", PortKind::Radiance, "The light at the ends of the rays")
        .output("result", PortKind::Texture,
                "Cosine-weighted mean of the radiance that arrives (irradiance over pi); 0 where nothing is")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .output("weight", PortKind::Texture,
                "How much this frame's result counts in a mean over frames (for snapping tracers); 1 where "
                "nothing is")
        .carries({.channels = 1})
        .number("rays", &IndirectDiffuse::rays, 1, 256, "rays", "Rays a pixel and frame")
        .number("distance", &IndirectDiffuse::distance, 0, 1e9, "scene units",
                "How far surfaces count, beyond it a ray meets nothing; 0: any distance")
        .flag("snap", &IndirectDiffuse::snap, "Bears that a tracer replaces directions by nearby ones")
        .choice("estimator", &IndirectDiffuse::estimator, {"paper", "cosine_ratio"},
                "How replaced directions count: all alike, or by their cosine over the mean cosine of those "
                "they stand for");
}

Declaration IndirectDiffuse::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& depth = inputs["depth"].desc;
    const bool snaps =
        snap && (inputs["tracer"].desc.provides & (provides::Snaps | provides::AlwaysSnaps)) != 0;
    const bool background = inputs["depth"].constant == glm::vec4(0);
    const bool weighted = demand.reads("weight");

    Output result{.port = "result", .desc = Desc::texture2D(Format::RGBA32F, depth.extent, depth.view)};
    Output weight{.port = "weight", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)};
    if (background) result.constant = noLight;
    if (background || !snaps) weight.constant = glm::vec4(1);
    declaration.outputs.push_back(result);
    if (weighted) declaration.outputs.push_back(weight);
    if (background) {
        declaration.leftOut.push_back({"tracing", "the depth is empty everywhere"});
        return declaration;
    }
    if (weighted && !snaps)
        declaration.leftOut.push_back({"weight", "the tracer traces the directions that were asked for"});

    const bool surfaces = (inputs["radiance"].desc.required & required::Surface) != 0;
    if (!surfaces)
        declaration.leftOut.push_back({"normals and materials of hits", "the radiance needs only positions"});
    Step step{
        .name = {},
        .shaders = {"ray_effects/indirect_diffuse.comp"},
        .uses = {{.port = "depth", .access = Access::Fetch},
                 {.port = "normal", .access = Access::Image},
                 {.port = "result", .access = Access::Image, .write = true}},
        .modules = {{"tracer", (surfaces ? requests::Surface | requests::ClosestHit : requests::ClosestHit) |
                                   (snap ? requests::Snap : 0)},
                    {"radiance", 0}}};
    if (surfaces) step.defines.emplace("REQUIRES_SURFACE", "1");
    if (snaps) {
        if (estimator == Estimator::CosineRatio) step.defines.emplace("COSINE_RATIO", "1");
        // Between steps the sum of weights must live somewhere, also if nobody else reads it.
        if (weighted || rays > maxRaysPerStep) {
            step.defines.emplace("WEIGHT", "1");
            step.uses.push_back({.port = "weight", .access = Access::Image, .write = true});
            if (!weighted) declaration.outputs.push_back(weight);
        }
    }
    useFaceNormal(declaration, step, inputs);
    declaration.steps = raySteps(std::move(step), rays, world.facts);
    declaration.depends = Causes::Frame;
    return declaration;
}

void IndirectDiffuse::execute(const Step&, Commands& commands) {
    commands.set("maximumDistance", distance);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
