#include "second_depth_layer.h"
#include "draw/material_defines.h"
#include "execute/commands.h"

namespace kestrel {

PassType SecondDepthLayer::type() {
    return Describe<SecondDepthLayer>("SecondDepthLayer", "The nearest surface behind the first, by drawing "
                                                          "the scene a second time")
        .input("view_depth", PortKind::Texture, "Distance of the first surface along the view axis")
        .carries(content::viewDepth)
        .output("second_depth", PortKind::Texture, "View depth of the second; 0 where there is none")
        .carries(content::viewDepth)
        .output("layers", PortKind::Layers, "The same as a layer behind the first")
        .internal("depth", PortKind::Texture, "Reversed depth of the second surface")
        .number("separation", &SecondDepthLayer::separation, 0, 1e9, "scene units",
                "Least distance between the two along the view axis, beside what rounding needs");
}

Declaration SecondDepthLayer::declare(const World& world, const Inputs& inputs, const Demand& demand) const {
    Declaration declaration;
    const Desc& first = inputs["view_depth"].desc;
    const bool nothing = world.facts.triangles == 0 || inputs["view_depth"].constant == glm::vec4(0);
    Output second{.port = "second_depth", .desc = Desc::texture2D(Format::R32F, first.extent, first.view)};
    (nothing ? second.constant : second.clear) = glm::vec4(0);
    declaration.outputs.push_back(std::move(second));
    if (demand.reads("layers")) {
        if (!std::holds_alternative<FrameView>(first.view.source))
            declaration.problems.push_back({"view_depth", "is not seen by the frame's camera"});
        declaration.outputs.push_back(
            {.port = "layers", .desc = Desc::layersModule({.count = 1, .ordered = true}, first.view)});
        declaration.modules.push_back({.port = "layers",
                                       .shader = "stochastic_depth/second_layer.glsl",
                                       .uses = {{.port = "second_depth", .access = Access::Image}}});
    }
    if (nothing) {
        declaration.leftOut.push_back({"peeling", "there is nothing in view"});
        return declaration;
    }
    declaration.outputs.push_back({.port = "depth",
                                   .desc = Desc::texture2D(Format::D32F, first.extent, first.view),
                                   .clear = glm::vec4(0)});
    declaration.steps.push_back(
        {.name = "peel",
         .shaders = {"stochastic_depth/scene.vert", "stochastic_depth/second_layer.frag"},
         .defines = materialDefines(world.facts),
         .uses = {{.port = "second_depth", .access = Access::Attachment, .write = true},
                  {.port = "depth", .access = Access::Attachment, .write = true},
                  {.port = "view_depth", .access = Access::Image}},
         .group = "generation"});
    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Properties | Causes::Size;
    return declaration;
}

void SecondDepthLayer::execute(const Step&, Commands& commands) {
    commands.set("separation", separation);
    // Both sides, as rays meet them.
    commands.drawScene({.cull = Cull::None}, {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided,
                                              TriangleClass::Masked, TriangleClass::MaskedDoubleSided});
}

} // namespace kestrel
