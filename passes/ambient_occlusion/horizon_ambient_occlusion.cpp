#include "horizon_ambient_occlusion.h"
#include "execute/commands.h"

namespace kestrel {

PassType HorizonAmbientOcclusion::type() {
    return Describe<HorizonAmbientOcclusion>(
               "HorizonAmbientOcclusion",
               "Ambient occlusion from the depth buffer by slices: horizons (GTAO) or a visibility bitmask")
        .input("view_depth", PortKind::Texture,
               "Distance along the view axis, with a guard band or without; 0 where nothing is")
        .carries(content::viewDepth)
        .input("normal", PortKind::Texture, "Normals of the surfaces, unit, render space")
        .carries(content::normal)
        .sameExtentAs("view_depth")
        .optionalInput("layers", PortKind::Layers,
                       "Depths behind the first surface, of every texel, for `thickness_from` layers")
        .output("visibility", PortKind::Texture,
                "Share of the cosine-weighted hemisphere that is open; 1 where nothing is")
        .carries({.channels = 1})
        .range(0, 1)
        .choice("method", &HorizonAmbientOcclusion::method, {"gtao", "bitmask"},
                "The highest horizon of each side, or sectors that light passes between")
        .number("slices", &HorizonAmbientOcclusion::slices, 1, 32, "", "Planes through the line of sight")
        .number("steps", &HorizonAmbientOcclusion::steps, 1, 64, "samples", "To each side of a slice")
        .number("radius", &HorizonAmbientOcclusion::radius, 1e-9, 1e9, "scene units",
                "How far occluders count")
        .number("maximum_radius", &HorizonAmbientOcclusion::maximumRadius, 1, 4096, "pixels",
                "The radius is made smaller where it would look larger")
        .choice("thickness_from", &HorizonAmbientOcclusion::thicknessFrom, {"constant", "layers"},
                "How far what the bitmask meets reaches back: by `thickness`, or surfaces alone count, those "
                "behind the first too")
        .number("thickness", &HorizonAmbientOcclusion::thickness, 0, 1e9, "scene units",
                "Of what the depth shows, along the line of sight; for the bitmask without layers")
        .number("exponent", &HorizonAmbientOcclusion::exponent, 0.1, 16, "", "Power of the result");
}

Declaration HorizonAmbientOcclusion::declare(const World& world, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const bool layers = method == Method::Bitmask && thicknessFrom == Thickness::Layers;
    if (layers && !inputs.connected("layers"))
        declaration.problems.push_back({"layers", "`thickness_from` layers needs it connected"});
    View inner = inputs["view_depth"].desc.view;
    inner.guard = 0;
    Output visibility{.port = "visibility",
                      .desc = Desc::texture2D(Format::R16F, world.extentOf(inner), inner)};
    if (inputs["view_depth"].constant == glm::vec4(0)) {
        visibility.constant = glm::vec4(1);
        declaration.outputs.push_back(std::move(visibility));
        declaration.leftOut.push_back({"occlusion", "the depth is empty everywhere"});
        return declaration;
    }
    declaration.outputs.push_back(std::move(visibility));
    Step step{.name = "horizons",
              .shaders = {"ambient_occlusion/horizon.comp"},
              .defines = {{"SLICES", std::to_string(slices)}, {"STEPS", std::to_string(steps)}},
              .uses = {{.port = "view_depth", .access = Access::Image},
                       {.port = "normal", .access = Access::Image},
                       {.port = "visibility", .access = Access::Image, .write = true}}};
    if (method == Method::Bitmask) step.defines.emplace("BITMASK", "1");
    if (layers) {
        // Of 0.3 to 0.6 the one with the least error on `tower` and `hall` together.
        step.defines.emplace("LAYERS", "0.5");
        step.modules.push_back({"layers", 0});
    }
    declaration.steps.push_back(std::move(step));
    declaration.depends = Causes::Properties;
    return declaration;
}

void HorizonAmbientOcclusion::execute(const Step&, Commands& commands) {
    commands.set("radius", radius);
    commands.set("maximumRadius", maximumRadius);
    if (method == Method::Bitmask && thicknessFrom == Thickness::Constant)
        commands.set("thickness", thickness);
    commands.set("exponent", exponent);
    commands.dispatchOver(commands.desc("visibility").extent);
}

} // namespace kestrel
