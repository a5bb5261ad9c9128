#include "abuffer_bounds.h"
#include <algorithm>
#include <cstring>
#include <fmt/format.h>

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
        .internal("boxes", PortKind::Buffer, "With `proxy`: two corners of each instance's bounding box")
        .flag("main_view", &ABufferBounds::mainView, "Sees what the camera sees, at the frame's resolution")
        .flag("cube", &ABufferBounds::cube, "Sees what lies around the eye")
        .choice("blended", &ABufferBounds::blended, {"tested", "kept", "alone"},
                "Fragments of blended materials: where alpha is at least the cutoff, as rays meet them; "
                "wherever it is above 0; these alone, and nothing else, at pixels whose rays meet them")
        .number("side", &ABufferBounds::side, 0, 8192, "pixels",
                "Of a face of the cube; 0: as high as the frame")
        .number("near", &ABufferBounds::nearPlane, 1e-9, 1e9, "scene units",
                "By how much each face's eye stands behind the frame's")
        .choice("source", &ABufferBounds::source, {"geometry", "proxy"},
                "Draws the scene's triangles, or the bounding boxes of its instances, which are fewer and "
                "tell wider bounds and no number of fragments")
        .choice("drawing", &ABufferBounds::drawing, {"by_view", "geometry_shader", "vertex_layer"},
                "Triangles into the faces: face after face, or into all in one draw by a geometry shader or "
                "by instances")
        .flag("count_layers", &ABufferBounds::countLayers,
              "Reports the fragments in all, and the layers of a pixel that has any, average and maximum");
}

Declaration ABufferBounds::declare(const World& world, const Inputs&, const Demand& demand) const {
    Declaration declaration;
    FragmentLists lists;
    lists.mainView = mainView;
    lists.side = cube ? (side > 0 ? side : static_cast<int>(world.size.height)) : 0;
    lists.nearPlane = static_cast<float>(nearPlane);
    lists.counted = source == Source::Geometry;
    if (!mainView && !cube)
        declaration.leftOut.push_back({"every view", "neither the frame nor the cube is asked for"});
    if (source == Source::Geometry)
        if (const auto why = abufferCannotDraw(drawing, world.capabilities))
            declaration.problems.push_back({"", *why, true});

    lists.blended = blended;
    const bool nothing = !abufferHasFragments(lists, world.facts);
    if (source == Source::Proxy && !nothing) {
        declaration.outputs.push_back(
            {.port = "boxes",
             .desc = Desc::buffer(2 * sizeof(glm::vec4) * world.facts.instances, Format::RGBA32F)});
        declaration.steps.push_back({.name = "boxes",
                                     .run = &ABufferBounds::makeBoxes,
                                     .uses = {{.port = "boxes", .access = Access::Copy, .write = true}},
                                     .group = "bounds"});
    }
    const auto view = [&](const char* port, Desc desc, bool ofCube, bool seen) {
        if (!demand.reads(port)) return;
        desc.lists = lists;
        Output output{.port = port, .desc = desc};
        // No fragment: nothing lies between the bounds.
        (nothing || !seen ? output.constant : output.clear) = glm::vec4(-3e38f, 0, 0, 0);
        declaration.outputs.push_back(std::move(output));
        if (nothing || !seen) return;
        const ABufferViews views = ofCube ? ABufferViews::Faces : ABufferViews::Frame;
        const auto add = [&](Step step, int layer) {
            step.uses.push_back({.port = port, .access = Access::Attachment, .write = true, .layer = layer});
            step.group = "bounds";
            step.defines.emplace("VIEW_BLOCK", ofCube ? "CubeBoundsView" : "BoundsView");
            step.defines.emplace("OUTPUT", ofCube ? "out_cube_bounds" : "out_bounds");
            declaration.steps.push_back(std::move(step));
        };
        if (source == Source::Proxy) {
            for (std::uint32_t face = 0; face < (ofCube ? shared::abufferFaces : 1); ++face)
                add(proxyStep(world, lists, ofCube, face), ofCube ? static_cast<int>(face) : -1);
            return;
        }
        Step step = abufferSceneStep(world, lists, views, drawing, true, "abuffer/bounds.frag");
        step.run = [lists, views, how = drawing](Commands& commands) {
            DrawState state = DrawState::overwrite();
            state.blend = Blend::MaxAndSum;
            abufferDrawScene(commands, state, lists, commands.frame().size, views, how, true);
        };
        add(std::move(step), -1);
    };
    view("bounds", Desc::texture2D(Format::RGBA32F, world.size), false, mainView);
    const auto faceSide = static_cast<std::uint32_t>(std::max(lists.side, 1));
    view("cube_bounds", Desc::array2D(Format::RGBA32F, {faceSide, faceSide, shared::abufferFaces}), true,
         cube);
    if (countLayers && lists.counted && !nothing && demand.reads("bounds") && demand.reads("cube_bounds"))
        declaration.steps.push_back({.name = "layers",
                                     .run = &ABufferBounds::reportLayers,
                                     .uses = {{.port = "bounds", .access = Access::Host},
                                              {.port = "cube_bounds", .access = Access::Host}},
                                     .group = "report"});
    if (nothing)
        declaration.leftOut.push_back({"drawing", world.facts.triangles == 0
                                                      ? "the scene has no triangles"
                                                      : "no material is blended, and others are not stored"});
    if (source == Source::Proxy)
        declaration.leftOut.push_back({"numbers of fragments", "bounding boxes do not tell them"});
    if (!world.facts.hasMasked)
        declaration.leftOut.push_back({"alpha test", "no material is masked or blended"});
    declaration.depends = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                          Causes::Materials | Causes::Properties | Causes::Size;
    return declaration;
}

Step ABufferBounds::proxyStep(const World& world, const FragmentLists& lists, bool ofCube,
                              std::uint32_t face) const {
    Step step{.name = ofCube ? fmt::format("face_{}", face) : "frame",
              .shaders = {"abuffer/proxy.vert", "abuffer/proxy.frag"},
              .defines = abufferDefines(lists, world.size),
              .uses = {{.port = "boxes", .access = Access::Fetch}}};
    step.defines.emplace("VIEW", ofCube ? "(1u + face)" : "0u");
    if (ofCube) step.defines.emplace("CUBE", "1");
    step.run = [ofCube, face](Commands& commands) {
        DrawState state = DrawState::overwrite();
        state.blend = Blend::MaxAndSum;
        // A box's face before the near plane or beyond the far one bounds what is within them too.
        state.depthClamp = true;
        if (ofCube) commands.set("face", face);
        commands.drawVertices(state, 36, commands.facts().instances);
    };
    return step;
}

void ABufferBounds::makeBoxes(Commands& commands) const {
    const Geometry& geometry = commands.geometry();
    std::vector<glm::vec4> boxes;
    boxes.reserve(2 * geometry.instances.size());
    for (const Geometry::Range& range : geometry.instances) {
        Box box;
        for (std::uint32_t i = 0; i < range.count; ++i) box.add(geometry.positions[range.first + i]);
        const bool any = !box.empty();
        boxes.emplace_back(any ? box.min : glm::vec3(0), any ? 1 : 0);
        boxes.emplace_back(any ? box.max : glm::vec3(0), 0);
    }
    commands.upload("boxes", boxes);
}

void ABufferBounds::reportLayers(Commands& commands) const {
    double fragments = 0, most = 0, pixels = 0;
    for (const char* port : {"bounds", "cube_bounds"}) {
        const std::vector<std::byte> bytes = commands.download(port);
        for (size_t at = 0; at + sizeof(glm::vec4) <= bytes.size(); at += sizeof(glm::vec4)) {
            glm::vec4 seen;
            std::memcpy(&seen, bytes.data() + at, sizeof(seen));
            fragments += seen.a;
            most = std::max(most, double{seen.a});
            pixels += seen.a > 0 ? 1 : 0;
        }
    }
    commands.report("fragments", fragments);
    commands.report("layers, average", pixels > 0 ? fragments / pixels : 0);
    commands.report("layers, maximum", most);
}

} // namespace kestrel
