#include "ray_ambient_occlusion.h"
#include "draw/face_input.h"
#include "draw/ray_steps.h"
#include "execute/commands.h"

namespace kestrel {

PassType RayAmbientOcclusion::type() {
    return Describe<RayAmbientOcclusion>("RayAmbientOcclusion",
                                         "Ambient occlusion by rays through any tracer")
        .input("depth", PortKind::Texture, "Reversed depth of the surfaces")
        .carries(content::depth)
        .input("normal", PortKind::Texture, "Their normals, unit, render space")
        .carries(content::normal)
        .sameExtentAs("depth")
        .optionalInput("face_normal", PortKind::Texture, faceNormalDescription)
        .carries(content::normal)
        .sameExtentAs("depth")
        .input("tracer", PortKind::Tracer, "Who answers the visibility queries")
        .output("visibility", PortKind::Texture,
                "Share of the cosine-weighted hemisphere that is open; 1 where nothing is")
        .carries({.channels = 1})
        .output("weight", PortKind::Texture,
                "How much this frame's visibility counts in a mean over frames (for snapping tracers); 1 "
                "where nothing is")
        .carries({.channels = 1})
        .number("rays", &RayAmbientOcclusion::rays, 1, 256, "rays", "Rays a pixel and frame")
        .number("distance", &RayAmbientOcclusion::distance, 0, 1e9, "scene units",
                "How far occluders count; 0: any distance")
        .flag("snap", &RayAmbientOcclusion::snap, "Bears that a tracer replaces directions by nearby ones")
        .choice("estimator", &RayAmbientOcclusion::estimator, {"paper", "cosine_ratio"},
                "How replaced directions count: all alike, or by their cosine over the mean cosine of those "
                "they stand for");
}

Declaration RayAmbientOcclusion::declare(const World& world, const Inputs& inputs,
                                         const Demand& demand) const {
    Declaration declaration;
    const Desc& depth = inputs["depth"].desc;
    const bool snaps =
        snap && (inputs["tracer"].desc.provides & (provides::Snaps | provides::AlwaysSnaps)) != 0;
    const bool background = inputs["depth"].constant == glm::vec4(0);
    const bool weighted = demand.reads("weight");

    Output visibility{.port = "visibility", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)};
    Output weight{.port = "weight", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)};
    if (background) visibility.constant = glm::vec4(1);
    if (background || !snaps) weight.constant = glm::vec4(1);
    declaration.outputs.push_back(visibility);
    if (weighted) declaration.outputs.push_back(weight);
    if (background) {
        declaration.leftOut.push_back({"tracing", "the depth is empty everywhere"});
        return declaration;
    }
    if (weighted && !snaps)
        declaration.leftOut.push_back({"weight", "the tracer traces the directions that were asked for"});

    Step step{.shaders = {"ambient_occlusion/ray_ambient_occlusion.comp"},
              .uses = {{.port = "depth", .access = Access::Fetch},
                       {.port = "normal", .access = Access::Image},
                       {.port = "visibility", .access = Access::Image, .write = true}},
              .modules = {{"tracer", requests::AnyHit | (snap ? requests::Snap : 0)}}};
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

void RayAmbientOcclusion::execute(const Step&, Commands& commands) {
    commands.set("maximumDistance", distance);
    commands.dispatchOver(commands.desc("visibility").extent);
}

} // namespace kestrel
