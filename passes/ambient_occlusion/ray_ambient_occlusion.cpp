#include "ray_ambient_occlusion.h"
#include "draw/face_input.h"
#include "execute/commands.h"
#include "graph/many_rays.h"
#include <algorithm>
#include <string>

namespace kestrel {
namespace {

// That an invocation traces where the tracer takes many, as many as a step traces of one pixel.
constexpr unsigned long raysTogether = 16;

std::uint32_t pixelsTogether(const Step& step) {
    return step.defines.contains("PIXELS") ? static_cast<std::uint32_t>(std::stoi(step.defines.at("PIXELS")))
                                           : 1;
}

} // namespace

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
    const bool many = (inputs["tracer"].desc.provides & provides::ManyRays) != 0;
    Declaration declaration =
        declareEffect(world, inputs, demand,
                      {.port = "visibility", .desc = Desc::texture2D(Format::R32F, depth.extent, depth.view)},
                      glm::vec4(1), {.shaders = {"ambient_occlusion/ray_ambient_occlusion.comp"}},
                      many ? requests::ManyRays : requests::AnyHit);
    if (many)
        for (Step& step : declaration.steps)
            step.defines.emplace(
                "PIXELS", std::to_string(std::max(1ul, raysTogether / std::stoul(step.defines.at("RAYS")))));
    return declaration;
}

void RayAmbientOcclusion::execute(const Step& step, Commands& commands) {
    commands.set("maximumDistance", distance);
    const Extent extent = commands.desc("visibility").extent;
    const std::uint32_t pixels = pixelsTogether(step);
    commands.dispatchOver(extent.width, (extent.height + pixels - 1) / pixels);
}

} // namespace kestrel
