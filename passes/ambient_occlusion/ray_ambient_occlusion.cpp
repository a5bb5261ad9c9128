#include "ray_ambient_occlusion.h"
#include "draw/face_input.h"
#include "execute/commands.h"

namespace kestrel {

PassType RayAmbientOcclusion::type() {
    Describe<RayAmbientOcclusion> table("RayAmbientOcclusion",
                                        "Ambient occlusion by rays through any tracer");
    addSurface(table)
        .input("tracer", PortKind::Tracer, "Who answers the visibility queries")
        .output("visibility", PortKind::Texture,
                "Share of the cosine-weighted hemisphere that is open; 1 where nothing is")
        .carries({.channels = 1})
        .range(0, 1);
    return addRays(table, "visibility", "How far occluders count; 0: any distance");
}

Declaration RayAmbientOcclusion::declare(const World& world, const Inputs& inputs,
                                         const Demand& demand) const {
    const Desc& depth = inputs["depth"].desc;
    return declareEffect(
        world, inputs, demand,
        {.port = "visibility", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)}, glm::vec4(1),
        {.shaders = {"ambient_occlusion/ray_ambient_occlusion.comp"}}, requests::AnyHit);
}

void RayAmbientOcclusion::execute(const Step&, Commands& commands) {
    commands.set("maximumDistance", distance);
    commands.dispatchOver(commands.desc("visibility").extent);
}

} // namespace kestrel
