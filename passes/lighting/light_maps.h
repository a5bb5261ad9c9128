// Which lights get maps, how many layers those take, and the block that drawing and lookup share
// (shared/light_map.h).
#pragma once
#include "draw/light_faces.h"
#include "execute/commands.h"
#include "shared/light_map.h"
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

using LightKinds = std::array<bool, 5>; // by LightKind: point, spot, directional, rectangle, sphere

// What a pass maps: lights of these kinds, in this order; where there are more than maxLights, the strongest
// of each kind.
struct LightMapLayout {
    std::array<std::uint32_t, 5> counts{}; // by LightKind
    std::array<std::uint32_t, 5> slots{};  // what programs are made for: counts, rounded up to powers of two
                                           // where those fit
    std::uint32_t layers = 0;              // of the map arrays
    bool mapped = true;                    // false: lights without maps
    bool wideSpots = false;                // some spot light's map may have several faces
    std::uint32_t nested = 0;              // smaller maps of each directional light
    bool follows = false; // the map of a directional light covers what the camera sees from near, not all
    std::uint32_t leftOut = 0; // lights for which there is no place

    [[nodiscard]] std::uint32_t lights() const;
    [[nodiscard]] std::uint32_t allSlots() const;
    [[nodiscard]] std::uint32_t allMaps() const; // a slot each, and the nested ones
    [[nodiscard]] std::uint32_t firstSlot(LightKind kind) const;
    // POINT_LIGHTS, SPOT_LIGHTS, DIRECTIONAL_LIGHTS, RECTANGLE_LIGHTS, SPHERE_LIGHTS: slots; LIGHTS: all of
    // them; MAPS: allMaps(); NESTED_MAPS; WIDE_SPOTS where there may be some.
    [[nodiscard]] Defines defines() const;
    [[nodiscard]] std::uint64_t blockBytes() const;
};

// The scene's lights of `kinds`; `mapped` false: none of them gets a layer. Directional lights get `nested`
// smaller maps each.
LightMapLayout lightMapLayout(const SceneFacts& facts, const LightKinds& kinds, bool mapped,
                              std::uint32_t nested = 0);

// A directional light's map covers the whole scene. Where that is wide (draw/near_scene.h), its texels are
// too: smaller maps lie about what the camera sees, each four times as wide as the one within (or more, where
// maxNestedMaps are not enough), the smallest as wide as the camera sees at nestedMapReach near planes. How
// many this camera asks for: none where the scene is not wide, or with more than maxNestedLights directional
// lights.
inline constexpr std::uint32_t maxNestedMaps = 7, maxNestedLights = 4;
inline constexpr float nestedMapReach = 64;
std::uint32_t nestedMaps(const SceneFacts& facts, const CameraState& camera);

// What a block holds: 192 bytes a light, of the 16 KiB that every device allows.
inline constexpr std::uint32_t maxLights = 64;
inline constexpr std::uint64_t maxLightMapBytes = std::uint64_t{1} << 30;
// The resolution at which these maps are made: the one asked for, or what takes no more memory than
// maxLightMapBytes. `bytes` is what a texel of all arrays takes.
int lightMapResolution(const LightMapLayout& layout, int resolution, int bytes);
// What is not as it was asked for, each in one sentence with figure and limit: fewer lights, a lower
// resolution.
std::vector<LeftOut> lightMapShortage(const LightMapLayout& layout, int resolution, int bytes);
// Tells them in the log, once as long as they stay the same: `told` is the pass's memory of it.
void warnOfShortage(const std::vector<LeftOut>& shortage, std::string& told);

// How the maps of a frame are displaced against aliasing.
struct LightMapJitter {
    bool texel = false; // by a random part of a texel
    float position = 0; // random offset of the light, as a share of the radius of nearScene()
};

// The block: counts, maps, and light records of each slot. Maps cover the scene; faces
// are wider than their share of directions by lightMapGuard texels on each side, so that filters need no
// neighbour.
inline constexpr float lightMapGuard = 3;
std::vector<std::byte> lightMapBlock(const LightMapLayout& layout, const std::vector<LightState>& lights,
                                     const SceneFacts& facts, int resolution, float bias,
                                     const LightMapJitter& jitter, const FrameInfo& frame);

// The raster step that draws into array attachments (its uses are the caller's), and running it: one draw a
// layer.
Step lightMapStep(std::string name, const World& world, const LightMapLayout& layout);
void drawLightMaps(const LightMapLayout& layout, Commands& commands);

} // namespace kestrel
