#include "views.h"
#include <bit>
#include <fmt/format.h>

namespace kestrel {

using Structure = FragmentLists::Structure;

std::uint64_t abufferPixels(const FragmentLists& lists, const Extent& frame) {
    const auto side = static_cast<std::uint64_t>(lists.side);
    return (lists.mainView ? std::uint64_t{frame.width} * frame.height : 0) +
           shared::abufferFaces * side * side;
}

int abufferPixelWords(const FragmentLists& lists) {
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

int abufferNodeWords(const FragmentLists& lists) {
    const bool twoWays = lists.structure == Structure::DLL || lists.structure == Structure::DLLB;
    const int own = twoWays ? 3 : 2;
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
    if (lists.structure == Structure::DLL || lists.structure == Structure::DLLB)
        defines.emplace("TWO_WAYS", "1");
    if (lists.decoupled) defines.emplace("DECOUPLED", "1");
    return defines;
}

std::vector<std::string> abufferShaders(const FragmentLists& lists, bool ofCube, const char* fragment) {
    if (lists.blended == Blended::Alone && !ofCube)
        return {"abuffer/scene.vert", "abuffer/by_rays.geom", fragment};
    return {"abuffer/scene.vert", fragment};
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
