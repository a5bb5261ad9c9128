#include "views.h"
#include "draw/material_defines.h"
#include <bit>
#include <fmt/format.h>

namespace kestrel {

using Structure = FragmentLists::Structure;

std::uint64_t abufferPixels(const FragmentLists& lists, const Extent& frame) {
    const auto side = static_cast<std::uint64_t>(lists.side);
    return (lists.mainView ? std::uint64_t{frame.width} * frame.height : 0) +
           shared::abufferFaces * side * side;
}

namespace {

// What the structure itself has.
int structureWords(const FragmentLists& lists) {
    switch (lists.structure) {
    case Structure::LL:
        return 1;
    case Structure::SB:
    case Structure::DLL:
        break;
    case Structure::LLB:
        return 2 + lists.buckets;
    case Structure::DLLB:
        return 2 + 2 * lists.buckets;
    }
    return 2;
}

int linkWords(const FragmentLists& lists) {
    const bool twoWays = lists.structure == Structure::DLL || lists.structure == Structure::DLLB;
    return twoWays ? 3 : 2;
}

} // namespace

int abufferPixelWords(const FragmentLists& lists) { return structureWords(lists) + (lists.planes ? 1 : 0); }

int abufferNodeWords(const FragmentLists& lists) {
    const int own = linkWords(lists) + (lists.planes ? 1 : 0);
    // The link of SB is the triangle itself where data is not decoupled.
    return lists.decoupled || lists.structure == Structure::SB ? own : own + 1;
}

Defines abufferDefines(const FragmentLists& lists, const Extent& frame) {
    constexpr const char* names[] = {"SB", "LL", "DLL", "LLB", "DLLB"};
    const std::uint64_t mainPixels = lists.mainView ? std::uint64_t{frame.width} * frame.height : 0;
    const bool bucketed = lists.structure == Structure::LLB || lists.structure == Structure::DLLB;
    Defines defines = {
        {names[static_cast<int>(lists.structure)], "1"},
        {"BUCKETS", std::to_string(lists.buckets)},
        {"HEAD_FIRST", bucketed ? "2" : "0"},
        {"TAIL_FIRST", std::to_string(bucketed ? 2 + lists.buckets : 1)},
        {"PIXEL_WORDS", std::to_string(abufferPixelWords(lists))},
        {"NODE_WORDS", std::to_string(abufferNodeWords(lists))},
        {"MAIN_PIXELS", std::to_string(mainPixels)},
        {"MAIN_WIDTH", std::to_string(frame.width)},
        {"MAIN_SIZE", lists.mainView ? fmt::format("ivec2({}, {})", frame.width, frame.height) : "ivec2(0)"},
        {"SIDE", std::to_string(lists.side)},
        {"NEAR_PLANE", fmt::format("uintBitsToFloat({}u)", std::bit_cast<std::uint32_t>(lists.nearPlane))}};
    if (bucketed) defines.emplace("BUCKETED", "1");
    if (lists.blended == Blended::Alone) defines.emplace("BY_RAYS", "1");
    if (lists.shifted) defines.emplace("SHIFTED", "1");
    if (lists.structure == Structure::DLL || lists.structure == Structure::DLLB)
        defines.emplace("TWO_WAYS", "1");
    if (lists.decoupled)
        defines.emplace("DECOUPLED", "1");
    else // with SB it is the link, which planes come behind
        defines.emplace("TRIANGLE_WORD",
                        lists.structure == Structure::SB ? "1" : std::to_string(abufferNodeWords(lists) - 1));
    if (lists.planes)
        defines.insert({{"PLANES", "1"},
                        {"SPREAD_WORD", std::to_string(structureWords(lists))},
                        {"PLANE_WORD", std::to_string(linkWords(lists))}});
    return defines;
}

ABufferDrawing abufferDrawing(ABufferDrawing asked, const FragmentLists& lists) {
    return lists.blended == Blended::Alone ? ABufferDrawing::ByView : asked;
}

Step abufferSceneStep(const World& world, const FragmentLists& lists, ABufferViews views,
                      ABufferDrawing drawing, bool layered, const std::string& fragment, bool byNumber) {
    Step step{.name = views == ABufferViews::All     ? "views"
                      : views == ABufferViews::Faces ? "faces"
                                                     : "frame",
              .shaders = {"abuffer/scene.vert"},
              .defines = materialDefines(world.facts, lists.blended)};
    step.defines.merge(abufferDefines(lists, world.size));
    if (byNumber) step.defines.emplace("BY_NUMBER", "1");
    drawing = abufferDrawing(drawing, lists);
    const bool geometry = drawing == ABufferDrawing::GeometryShader;
    if (drawing == ABufferDrawing::ByView || (views == ABufferViews::Frame && !geometry)) {
        step.defines.emplace("VIEW", views == ABufferViews::Frame ? "0u" : "(1u + face)");
        if (views == ABufferViews::Faces) step.defines.emplace("CUBE", "1");
        if (views == ABufferViews::Frame && lists.blended == Blended::Alone)
            step.shaders.emplace_back("abuffer/by_rays.geom");
    } else {
        step.defines.emplace("SEVERAL_VIEWS", "1");
        step.defines.emplace("FIRST_VIEW", views == ABufferViews::Faces ? "1" : "0");
        step.defines.emplace("LAST_VIEW",
                             views == ABufferViews::Frame ? "0" : std::to_string(shared::abufferFaces));
        if (layered && views == ABufferViews::Faces) step.defines.emplace("LAYERED", "1");
        step.defines.emplace(geometry ? "GEOMETRY_SHADER" : "VERTEX_LAYER", "1");
        if (geometry) step.shaders.emplace_back("abuffer/scene.geom");
    }
    step.shaders.push_back(fragment);
    return step;
}

void abufferDrawScene(Commands& commands, DrawState state, const FragmentLists& lists, const Extent& frame,
                      ABufferViews views, ABufferDrawing drawing, bool layered) {
    drawing = abufferDrawing(drawing, lists);
    const glm::uvec2 faces(static_cast<std::uint32_t>(lists.side)), main(frame.width, frame.height);
    state.viewport = views == ABufferViews::Faces ? faces : main;
    if (views != ABufferViews::Frame) state.secondViewport = faces;
    if (views == ABufferViews::Frame || drawing != ABufferDrawing::ByView) {
        if (views != ABufferViews::Frame && drawing == ABufferDrawing::VertexLayer)
            state.instances = shared::abufferFaces + (views == ABufferViews::All ? 1 : 0);
        commands.drawScene(state, abufferClasses(lists.blended));
    } else if (layered) {
        commands.drawSceneLayers(state, abufferClasses(lists.blended), shared::abufferFaces,
                                 [&](std::uint32_t face) { commands.set("face", face); });
    } else {
        for (std::uint32_t face = 0; face < shared::abufferFaces; ++face) {
            commands.set("face", face);
            commands.drawScene(state, abufferClasses(lists.blended));
        }
    }
}

std::optional<std::string> abufferCannotDraw(ABufferDrawing drawing, const Capabilities& capabilities) {
    constexpr const char* extension = "GL_ARB_shader_viewport_layer_array";
    if (drawing != ABufferDrawing::VertexLayer || capabilities.has(extension)) return std::nullopt;
    return fmt::format("`vertex_layer` needs {}, which this driver has not", extension);
}

std::vector<TriangleClass> abufferClasses(Blended blended) {
    if (blended == Blended::Alone) return {TriangleClass::Masked, TriangleClass::MaskedDoubleSided};
    return {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided, TriangleClass::Masked,
            TriangleClass::MaskedDoubleSided};
}

bool abufferHasFragments(const FragmentLists& lists, const SceneFacts& facts) {
    return facts.triangles > 0 && (lists.blended != Blended::Alone || facts.hasBlend);
}

} // namespace kestrel
