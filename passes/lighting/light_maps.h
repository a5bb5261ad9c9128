// Which lights get maps, how many layers those take, and the block that drawing and lookup share
// (shared/light_map.h).
#pragma once
#include "execute/commands.h"
#include "shared/light_map.h"
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

using LightKinds = std::array<bool, 5>; // by LightKind: point, spot, directional, rectangle, sphere

// What a pass maps: lights of these kinds, in this order.
struct LightMapLayout {
    std::array<std::uint32_t, 5> counts{}; // by LightKind
    std::array<std::uint32_t, 5> slots{};  // counts rounded up to powers of two: what programs are made for
    std::uint32_t layers = 0;              // of the map arrays
    bool mapped = true;                    // false: lights without maps

    [[nodiscard]] std::uint32_t lights() const;
    [[nodiscard]] std::uint32_t allSlots() const;
    [[nodiscard]] std::uint32_t firstSlot(LightKind kind) const;
    // POINT_LIGHTS, SPOT_LIGHTS, DIRECTIONAL_LIGHTS, RECTANGLE_LIGHTS, SPHERE_LIGHTS: slots; LIGHTS: all of
    // them.
    [[nodiscard]] Defines defines() const;
    [[nodiscard]] std::uint64_t blockBytes() const;
};

// Faces of a light's map, 0 for parallel rays (which take one layer).
std::uint32_t lightMapFaces(LightKind kind);

// The scene's lights of `kinds`; `mapped` false: none of them gets a layer.
LightMapLayout lightMapLayout(const SceneFacts& facts, const LightKinds& kinds, bool mapped);

// Why these maps cannot be made: too many lights for a block, or more memory than maxLightMapBytes. `bytes`
// is what a texel of all arrays takes.
inline constexpr std::uint32_t maxLightSlots = 64;
inline constexpr std::uint64_t maxLightMapBytes = std::uint64_t{1} << 30;
std::optional<std::string> lightMapMistake(const LightMapLayout& layout, int resolution, int bytes);

// How the maps of a frame are displaced against aliasing.
struct LightMapJitter {
    bool texel = false; // by a random part of a texel
    float position = 0; // random offset of the light, as a share of the scene's radius
};

// The block: counts, maps, and light records of each slot. Maps cover a scene of that bounding sphere; faces
// are wider than their share of directions by lightMapGuard texels on each side, so that filters need no
// neighbour. Spot lights wider than 80 degrees to each side are mapped up to there.
inline constexpr float lightMapGuard = 3;
std::vector<std::byte> lightMapBlock(const LightMapLayout& layout, const std::vector<LightState>& lights,
                                     const Sphere& scene, int resolution, float bias,
                                     const LightMapJitter& jitter, const FrameInfo& frame);

// The raster step that draws into array attachments (its uses are the caller's), and running it: one draw a
// layer.
Step lightMapStep(std::string name, const World& world, const LightMapLayout& layout);
void drawLightMaps(const LightMapLayout& layout, Commands& commands);

} // namespace kestrel
