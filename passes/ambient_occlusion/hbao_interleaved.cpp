#include "hbao_interleaved.h"
#include "execute/commands.h"

namespace kestrel {

static constexpr std::uint32_t pattern = 4; // pixels a side, as in the shaders

PassType HbaoInterleaved::type() {
    return Describe<HbaoInterleaved>("HbaoInterleaved",
                                     "Horizon-based ambient occlusion from the depth buffer, split into 16 "
                                     "layers of a quarter of its resolution with one jitter each")
        .input("view_depth", PortKind::Texture,
               "Distance along the view axis, with a guard band or without; 0 where nothing is")
        .carries(content::viewDepth)
        .input("normal", PortKind::Texture, "Normals of the surfaces, unit, render space")
        .carries(content::normal)
        .sameExtentAs("view_depth")
        .output("visibility", PortKind::Texture, "Visibility by what the depth shows; 1 where nothing is")
        .carries({.channels = 1})
        .range(0, 1)
        .internal("layers", PortKind::Texture,
                  "The depth of every fourth pixel of every fourth row, 16 times")
        .number("directions", &HbaoInterleaved::directions, 1, 32, "", "Around a pixel")
        .number("steps", &HbaoInterleaved::steps, 1, 32, "samples", "Along each direction")
        .number("radius", &HbaoInterleaved::radius, 1e-9, 1e9, "scene units", "How far occluders count")
        .number("bias", &HbaoInterleaved::bias, 0, 0.9, "",
                "Sine of the elevation over the surface up to which nothing occludes")
        .number("exponent", &HbaoInterleaved::exponent, 0.1, 16, "", "Power of the result")
        .number("maximum_radius", &HbaoInterleaved::maximumRadius, 1, 4096, "pixels",
                "The radius is made smaller where it would look larger")
        .flag("deinterleaved", &HbaoInterleaved::deinterleaved,
              "Reads from the layers; otherwise the same from the depth itself");
}

Declaration HbaoInterleaved::declare(const World& world, const Inputs& inputs, const Demand&) const {
    Declaration declaration;
    const Desc& depth = inputs["view_depth"].desc;
    View inner = depth.view;
    inner.guard = 0;
    Output visibility{.port = "visibility",
                      .desc = Desc::texture2D(Format::R16F, world.extentOf(inner), inner)};
    declaration.depends = Causes::Properties;
    if (inputs["view_depth"].constant == glm::vec4(0)) {
        visibility.constant = glm::vec4(1);
        declaration.outputs.push_back(std::move(visibility));
        declaration.leftOut.push_back({"occlusion", "the depth is empty everywhere"});
        return declaration;
    }
    declaration.outputs.push_back(std::move(visibility));

    Step occlude{.name = "occlude",
                 .run = &HbaoInterleaved::occlude,
                 .shaders = {"ambient_occlusion/hbao_interleaved.comp"},
                 .defines = {{"DIRECTIONS", std::to_string(directions)}, {"STEPS", std::to_string(steps)}},
                 .uses = {{.port = "view_depth", .access = Access::Image},
                          {.port = "normal", .access = Access::Image},
                          {.port = "visibility", .access = Access::Image, .write = true}}};
    if (deinterleaved) {
        const auto quarter = [](std::uint32_t length) { return (length + pattern - 1) / pattern; };
        declaration.outputs.push_back(
            {.port = "layers",
             .desc = Desc::array2D(Format::R32F, {quarter(depth.extent.width), quarter(depth.extent.height),
                                                  pattern * pattern})});
        declaration.steps.push_back({.name = "deinterleave",
                                     .run = &HbaoInterleaved::split,
                                     .shaders = {"ambient_occlusion/deinterleave.comp"},
                                     .uses = {{.port = "view_depth", .access = Access::Image},
                                              {.port = "layers", .access = Access::Image, .write = true}}});
        occlude.defines.emplace("DEINTERLEAVED", "1");
        occlude.uses.push_back({.port = "layers", .access = Access::Image});
    }
    declaration.steps.push_back(std::move(occlude));
    return declaration;
}

void HbaoInterleaved::split(Commands& commands) const {
    const Extent layers = commands.desc("layers").extent;
    commands.dispatchOver(pattern * layers.width, pattern * layers.height);
}

void HbaoInterleaved::occlude(Commands& commands) const {
    commands.set("radius", radius);
    commands.set("bias", bias);
    commands.set("exponent", exponent);
    commands.set("maximumRadius", maximumRadius);
    const Extent extent = commands.desc("visibility").extent;
    // A layer after the other, each as large as its part of the frame is at most.
    commands.dispatchOver(extent.width / pattern + 1, extent.height / pattern + 1, pattern * pattern);
}

} // namespace kestrel
