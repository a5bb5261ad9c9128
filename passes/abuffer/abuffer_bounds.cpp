#include "abuffer_bounds.h"
#include "draw/material_defines.h"
#include "views.h"

namespace kestrel {

PassType ABufferBounds::type() {
    return Describe<ABufferBounds>("ABufferBounds",
                                   "Depth bounds and number of fragments of each pixel, seen by the "
                                   "camera and by a cube about the eye")
        .output("bounds", PortKind::Texture,
                "Of the frame's view: least depth negated, largest depth, nothing, fragments")
        .carries({.channels = 4, .space = Space::View})
        .output("cube_bounds", PortKind::Texture,
                "The same of the cube's six faces, whose axes are render space's")
        .carries({.channels = 4, .space = Space::View})
        .flag("main_view", &ABufferBounds::mainView, "Sees what the camera sees, at the frame's resolution")
        .flag("cube", &ABufferBounds::cube, "Sees what lies around the eye")
        .choice("blended", &ABufferBounds::blended, {"tested", "kept", "alone"},
                "Fragments of blended materials: where alpha is at least the cutoff, as rays meet them; "
                "wherever it is above 0; these alone, and nothing else, at pixels whose rays meet them")
        .number("side", &ABufferBounds::side, 0, 8192, "pixels",
                "Of a face of the cube; 0: as high as the frame")
        .number("near", &ABufferBounds::nearPlane, 1e-9, 1e9, "scene units",
                "By how much each face's eye stands behind the frame's");
}

Declaration ABufferBounds::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    FragmentLists lists;
    lists.mainView = mainView;
    lists.side = cube ? (side > 0 ? side : static_cast<int>(world.size.height)) : 0;
    lists.nearPlane = static_cast<float>(nearPlane);
    if (!mainView && !cube)
        declaration.leftOut.push_back({"every view", "neither the frame nor the cube is asked for"});

    lists.blended = blended;
    const bool nothing = !abufferHasFragments(lists, world.facts);
    const auto view = [&](const char* port, Desc desc, bool ofCube, bool seen) {
        if (!demand.reads(port)) return;
        desc.lists = lists;
        Output output{.port = port, .desc = desc};
        // No fragment: nothing lies between the bounds.
        (nothing || !seen ? output.constant : output.clear) = glm::vec4(-3e38f, 0, 0, 0);
        declaration.outputs.push_back(std::move(output));
        if (nothing || !seen) return;
        Step step{.name = ofCube ? "faces" : "frame",
                  .run = ofCube ? &ABufferBounds::drawCube : &ABufferBounds::drawMain,
                  .shaders = abufferShaders(lists, ofCube, "abuffer/bounds.frag"),
                  .defines = materialDefines(world.facts, blended),
                  .uses = {{.port = port, .access = Access::Attachment, .write = true}},
                  .group = "bounds"};
        step.defines.merge(abufferDefines(lists, world.size));
        step.defines.emplace("VIEW_BLOCK", ofCube ? "CubeBoundsView" : "BoundsView");
        if (ofCube) step.defines.emplace("CUBE", "1");
        declaration.steps.push_back(std::move(step));
    };
    view("bounds", Desc::texture2D(Format::RGBA32F, world.size), false, mainView);
    const auto faceSide = static_cast<std::uint32_t>(std::max(lists.side, 1));
    view("cube_bounds", Desc::array2D(Format::RGBA32F, {faceSide, faceSide, shared::abufferFaces}), true,
         cube);
    if (nothing)
        declaration.leftOut.push_back({"drawing", world.facts.triangles == 0
                                                      ? "the scene has no triangles"
                                                      : "no material is blended, and others are not stored"});
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});
    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Properties | Causes::Size;
    return declaration;
}

void ABufferBounds::drawMain(Commands& commands) {
    DrawState state = DrawState::overwrite();
    state.blend = Blend::MaxAndSum;
    commands.drawScene(state, abufferClasses(blended));
}

void ABufferBounds::drawCube(Commands& commands) {
    DrawState state = DrawState::overwrite();
    state.blend = Blend::MaxAndSum;
    commands.drawSceneLayers(state, abufferClasses(blended), shared::abufferFaces,
                             [&](std::uint32_t face) { commands.set("face", face); });
}

} // namespace kestrel
