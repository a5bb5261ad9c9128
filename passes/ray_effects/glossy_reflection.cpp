#include "glossy_reflection.h"
#include "draw/face_input.h"
#include "draw/no_light.h"
#include "draw/ray_steps.h"
#include "execute/commands.h"

namespace kestrel {

PassType GlossyReflection::type() {
    Describe<GlossyReflection> table("GlossyReflection",
                                     "Light reflected by rough surfaces, by rays through any tracer");
    return addSurface(table)
        .input("albedo", PortKind::Texture, "Their linear base colour")
        .carries(content::colour)
        .sameExtentAs("depth")
        .input("material", PortKind::Texture, "Their roughness, metallic, and in z whether they are unlit")
        .carries(content::material)
        .sameExtentAs("depth")
        .input("tracer", PortKind::Tracer, "Who answers the closest-hit queries")
        .input("radiance", PortKind::Radiance, "The light at the ends of the rays")
        .output("result", PortKind::Texture,
                "Radiance that leaves towards the eye by the specular lobe; 0 where nothing is")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity())
        .number("rays", &GlossyReflection::rays, 1, 256, "rays", "Rays a pixel and frame")
        .number("distance", &GlossyReflection::distance, 0, 1e9, "scene units",
                "How far surfaces count, beyond it a ray meets nothing; 0: any distance")
        .number("max_roughness", &GlossyReflection::maxRoughness, 0, 1, "",
                "Rougher surfaces are not traced: their result is 0");
}

Declaration GlossyReflection::declare(const World& world, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& depth = inputs["depth"].desc;
    Output result{.port = "result", .desc = Desc::texture2D(Format::RGBA32F, depth.extent, depth.view)};
    if (inputs["depth"].constant == glm::vec4(0)) {
        result.constant = noLight;
        declaration.outputs.push_back(std::move(result));
        declaration.leftOut.push_back({"tracing", "the depth is empty everywhere"});
        return declaration;
    }
    declaration.outputs.push_back(std::move(result));

    const bool surfaces = (inputs["radiance"].desc.required & required::Surface) != 0;
    if (!surfaces)
        declaration.leftOut.push_back({"normals and materials of hits", "the radiance needs only positions"});
    Step step{
        .name = {},
        .shaders = {"ray_effects/glossy_reflection.comp"},
        .uses = {{.port = "depth", .access = Access::Fetch},
                 {.port = "normal", .access = Access::Image},
                 // Read once a pixel: image units are kept for what a tracer reads at random.
                 {.port = "albedo", .access = Access::Fetch},
                 {.port = "material", .access = Access::Fetch},
                 {.port = "result", .access = Access::Image, .write = true}},
        .modules = {{"tracer", requests::ClosestHit | (surfaces ? requests::Surface : 0)}, {"radiance", 0}}};
    if (surfaces) step.defines.emplace("REQUIRES_SURFACE", "1");
    useFaceNormal(declaration, step, inputs);
    declaration.steps = raySteps(std::move(step), rays, inputs["tracer"].desc, world.facts);
    declaration.depends = Causes::Frame;
    return declaration;
}

void GlossyReflection::execute(const Step&, Commands& commands) {
    commands.set("maximumDistance", distance);
    commands.set("maximumRoughness", maxRoughness);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
