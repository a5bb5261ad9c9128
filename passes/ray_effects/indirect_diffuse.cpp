#include "indirect_diffuse.h"
#include "draw/face_input.h"
#include "draw/no_light.h"
#include "execute/commands.h"

namespace kestrel {

PassType IndirectDiffuse::type() {
    Describe<IndirectDiffuse> table("IndirectDiffuse",
                                    "One bounce of diffuse light by rays through any tracer");
    addSurface(table)
        .input("tracer", PortKind::Tracer, "Who answers the closest-hit queries")
        .input("radiance", PortKind::Radiance, "The light at the ends of the rays")
        .output("result", PortKind::Texture,
                "Cosine-weighted mean of the radiance that arrives (irradiance over pi); 0 where nothing is")
        .carries(content::colour)
        .range(0, std::numeric_limits<double>::infinity());
    return addRays(table, "result", "How far surfaces count, beyond it a ray meets nothing; 0: any distance");
}

Declaration IndirectDiffuse::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    const Desc& depth = inputs["depth"].desc;
    const bool surfaces = (inputs["radiance"].desc.required & required::Surface) != 0;
    Step step{.shaders = {"ray_effects/indirect_diffuse.comp"}, .modules = {{"radiance", 0}}};
    if (surfaces) step.defines.emplace("REQUIRES_SURFACE", "1");
    Declaration declaration = declareEffect(
        world, inputs, demand,
        {.port = "result", .desc = Desc::texture2D(Format::RGBA32F, depth.extent, depth.view)}, noLight,
        std::move(step), surfaces ? requests::Surface | requests::ClosestHit : requests::ClosestHit);
    if (!surfaces && !declaration.steps.empty())
        declaration.leftOut.push_back({"normals and materials of hits", "the radiance needs only positions"});
    return declaration;
}

void IndirectDiffuse::execute(const Step&, Commands& commands) {
    commands.set("maximumDistance", distance);
    commands.dispatchOver(commands.desc("result").extent);
}

} // namespace kestrel
