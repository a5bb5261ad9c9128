#include "light_maps.h"
#include "core/check.h"
#include "core/log.h"
#include "draw/material_defines.h"
#include "draw/near_scene.h"
#include "shared/random.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <numeric>

namespace kestrel {

using shared::LightMap;
using shared::LightMapCounts;
using shared::LightRecord;

// std140.
static_assert(sizeof(LightMap) == 80 && offsetof(LightMap, jitter) == 64);
static_assert(sizeof(LightMapCounts) == 32 && sizeof(LightRecord) % 16 == 0);

namespace {

constexpr std::array<LightKind, 5> allKinds = {LightKind::Point, LightKind::Spot, LightKind::Directional,
                                               LightKind::Rectangle, LightKind::Sphere};

size_t indexOf(LightKind kind) { return static_cast<size_t>(kind); }

std::uint32_t countOf(const SceneFacts& facts, LightKind kind) {
    switch (kind) {
    case LightKind::Point:
        return facts.pointLights;
    case LightKind::Spot:
        return facts.spotLights;
    case LightKind::Directional:
        return facts.directionalLights;
    case LightKind::Rectangle:
        return facts.rectangleLights;
    case LightKind::Sphere:
        return facts.sphereLights;
    }
    return 0;
}

LightRecord recordOf(const LightState& light) {
    LightRecord record{};
    record.position = light.position;
    record.kind = static_cast<std::uint32_t>(light.kind);
    record.direction = light.direction;
    record.range = light.range;
    record.intensity = light.intensity;
    record.cosInnerCone = std::cos(light.innerCone);
    record.tangent = light.tangent;
    record.cosOuterCone = std::cos(light.outerCone);
    record.bitangent = light.bitangent;
    record.halfSize = light.halfSize;
    return record;
}

LightMap mapOf(const LightState& light, const Sphere& scene, int resolution) {
    const LightFaces faces = lightFacesOver(light, scene);
    const float guarded =
        static_cast<float>(resolution) / (static_cast<float>(resolution) - 2 * lightMapGuard);
    LightMap map{};
    map.axisX = light.tangent;
    map.axisY = light.bitangent;
    map.axisZ = light.direction;
    map.origin = faces.origin;
    map.faces = lightFaces(light);
    map.nearPlane = faces.nearPlane;
    map.halfWidth = faces.halfWidth * guarded;
    if (map.faces == 0) {
        map.inverseRange = 1 / faces.farPlane;
        map.farEnd = faces.farPlane;
    }
    return map;
}

// Half the width of smaller map `i` of `count`, from small to large.
float nestedHalfWidth(std::uint32_t i, std::uint32_t count, const CameraState& camera, const Sphere& scene) {
    const float smallest = nestedMapReach * std::max(camera.nearPlane, 1e-7f * scene.radius);
    const float growth = std::pow(std::max(1.0f, scene.radius / smallest), 1 / static_cast<float>(count));
    return smallest * std::pow(growth, static_cast<float>(i));
}

// A smaller map within `whole`: a cube about what the camera sees, more of it ahead of the eye than behind.
// It moves by whole texels, so that its shadows stand still. What comes between the cube and the light is in
// it too: rays start where those of the whole map do.
LightMap smallerMap(const LightMap& whole, float half, const CameraState& camera, int resolution) {
    const glm::vec3 ahead = -glm::vec3(camera.view[0][2], camera.view[1][2], camera.view[2][2]);
    const glm::vec3 middle = camera.position + 0.8f * half * ahead;
    const float texel = 2 * half / static_cast<float>(resolution);
    LightMap map = whole;
    map.origin = glm::vec3(0);
    for (const glm::vec3& axis : {whole.axisX, whole.axisY, whole.axisZ})
        map.origin += texel * std::round(glm::dot(axis, middle) / texel) * axis;
    map.halfWidth = half;
    map.farEnd = half;
    const float start = std::min(-half, glm::dot(whole.axisZ, whole.origin - map.origin));
    map.inverseRange = 1 / (half - start);
    return map;
}

// How strongly a light shines on the scene, or on what is seen of it from near, to choose between lights of
// one kind.
float strengthOf(const LightState& light, const Sphere& scene) {
    float strength = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
    if (light.kind == LightKind::Rectangle) strength *= 4 * light.halfSize.x * light.halfSize.y;
    if (light.kind == LightKind::Sphere) strength *= light.halfSize.x * light.halfSize.x;
    if (light.kind == LightKind::Directional) return strength;
    // As far as the middle of the scene, or as wide as it is where the light stands within.
    const float distance = std::max(glm::length(light.position - scene.centre), scene.radius);
    return distance > 0 ? strength / distance / distance : strength;
}

// The lights of a kind that have a place, in their order: the strongest where they are too many.
std::vector<size_t> chosenLights(LightKind kind, std::uint32_t count, const std::vector<LightState>& lights,
                                 const Sphere& scene) {
    std::vector<size_t> chosen;
    for (size_t i = 0; i < lights.size(); ++i)
        if (lights[i].kind == kind) chosen.push_back(i);
    if (chosen.size() <= count) return chosen;
    std::stable_sort(chosen.begin(), chosen.end(), [&](size_t a, size_t b) {
        return strengthOf(lights[a], scene) > strengthOf(lights[b], scene);
    });
    chosen.resize(count);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

// What lies where: slots in the order of kinds, layers one after another.
struct PlacedMap {
    size_t light;                          // index into the frame's lights
    std::uint32_t slot, firstLayer, faces; // a nested map has a slot behind those of the lights
    std::optional<std::uint32_t> nested;   // which one it is
};
std::vector<PlacedMap> placedMaps(const LightMapLayout& layout, const std::vector<LightState>& lights,
                                  const Sphere& scene) {
    std::vector<PlacedMap> placed;
    std::uint32_t layer = 0;
    for (const LightKind kind : allKinds) {
        std::uint32_t slot = layout.firstSlot(kind);
        for (const size_t i : chosenLights(kind, layout.counts[indexOf(kind)], lights, scene)) {
            placed.push_back({i, slot++, layer, lightFaces(lights[i]), {}});
            layer += std::max(1u, placed.back().faces);
        }
    }
    const std::uint32_t first = layout.firstSlot(LightKind::Directional);
    for (size_t whole = 0, all = placed.size(); whole < all && layout.nested > 0; ++whole) {
        if (lights[placed[whole].light].kind != LightKind::Directional) continue;
        for (std::uint32_t i = 0; i < layout.nested; ++i)
            placed.push_back({placed[whole].light,
                              layout.allSlots() + (placed[whole].slot - first) * layout.nested + i, layer++,
                              0, i});
    }
    KESTREL_CHECK(!layout.mapped || layer <= layout.layers);
    return placed;
}

// Fewer of the kinds with most lights, so that all of them together are `most`.
void fit(std::array<std::uint32_t, 5>& counts, std::uint32_t most) {
    for (std::uint32_t sum = std::accumulate(counts.begin(), counts.end(), 0u); sum > most; --sum)
        --*std::max_element(counts.begin(), counts.end());
}

// Both offsets of one light in one frame, from numbers of its own.
void displace(LightMap& map, std::uint32_t index, const LightMapJitter& jitter, float radius, int resolution,
              const FrameInfo& frame) {
    const std::uint32_t seed = shared::pixelSeed({index, 0}, shared::randomLightJitter, frame.seed);
    const glm::vec2 a = shared::scrambledSobol(frame.index, seed) - 0.5f;
    const glm::vec2 b = shared::scrambledSobol(frame.index, shared::hashCombine(seed, 1)) - 0.5f;
    const glm::vec2 c = shared::scrambledSobol(frame.index, shared::hashCombine(seed, 2)) - 0.5f;
    if (jitter.texel) map.jitter = 2.0f * a / static_cast<float>(resolution);
    if (map.faces > 0) map.origin += 2 * jitter.position * radius * glm::vec3(b, c.x);
}

} // namespace

std::uint32_t LightMapLayout::lights() const { return std::accumulate(counts.begin(), counts.end(), 0u); }

std::uint32_t LightMapLayout::allSlots() const { return std::accumulate(slots.begin(), slots.end(), 0u); }

std::uint32_t LightMapLayout::allMaps() const {
    return allSlots() + nested * slots[indexOf(LightKind::Directional)];
}

std::uint32_t LightMapLayout::firstSlot(LightKind kind) const {
    return std::accumulate(slots.begin(), slots.begin() + static_cast<std::ptrdiff_t>(indexOf(kind)), 0u);
}

Defines LightMapLayout::defines() const {
    constexpr std::array<const char*, 5> names = {"POINT_LIGHTS", "SPOT_LIGHTS", "DIRECTIONAL_LIGHTS",
                                                  "RECTANGLE_LIGHTS", "SPHERE_LIGHTS"};
    Defines result;
    for (size_t i = 0; i < names.size(); ++i) result.emplace(names[i], std::to_string(slots[i]));
    result.emplace("LIGHTS", std::to_string(allSlots()));
    result.emplace("MAPS", std::to_string(allMaps()));
    result.emplace("NESTED_MAPS", std::to_string(nested));
    if (wideSpots) result.emplace("WIDE_SPOTS", "1");
    return result;
}

std::uint64_t LightMapLayout::blockBytes() const {
    return sizeof(LightMapCounts) + std::uint64_t{allMaps()} * sizeof(LightMap) +
           std::uint64_t{allSlots()} * sizeof(LightRecord);
}

std::uint32_t nestedMaps(const SceneFacts& facts, const CameraState& camera) {
    const float smallest = nestedMapReach * camera.nearPlane;
    if (facts.directionalLights == 0 || facts.directionalLights > maxNestedLights || !isWide(facts, camera))
        return 0;
    const float fours = std::ceil(std::log2(facts.sphere.radius / smallest) / 2);
    return std::min(maxNestedMaps, static_cast<std::uint32_t>(fours));
}

LightMapLayout lightMapLayout(const SceneFacts& facts, const LightKinds& kinds, bool mapped,
                              std::uint32_t nested) {
    LightMapLayout layout;
    layout.mapped = mapped;
    for (const LightKind kind : allKinds)
        if (kinds[indexOf(kind)]) layout.counts[indexOf(kind)] = countOf(facts, kind);
    const std::uint32_t all = layout.lights();
    fit(layout.counts, maxLights);
    layout.leftOut = all - layout.lights();
    // Powers of two where there is room: fewer programs.
    for (size_t i = 0; i < layout.counts.size(); ++i)
        layout.slots[i] = layout.counts[i] > 0 ? std::bit_ceil(layout.counts[i]) : 0;
    if (layout.allSlots() > maxLights) layout.slots = layout.counts;
    if (!mapped) return layout;

    constexpr std::array<std::uint32_t, 5> faces = {6, 1, 1, 5, 6}; // of most lights of a kind
    for (size_t i = 0; i < faces.size(); ++i) layout.layers += layout.counts[i] * faces[i];
    if (layout.counts[indexOf(LightKind::Directional)] > 0) layout.nested = nested;
    layout.layers += layout.nested * layout.counts[indexOf(LightKind::Directional)];
    // Which of the spot lights are chosen is known only in the frame.
    const std::uint32_t wide = std::min(facts.wideSpotLights, layout.counts[indexOf(LightKind::Spot)]);
    layout.wideSpots = wide > 0;
    layout.layers += 4 * wide;
    return layout;
}

int lightMapResolution(const LightMapLayout& layout, int resolution, int bytes) {
    const auto most = static_cast<double>(maxLightMapBytes) / std::max(1u, layout.layers) / bytes;
    const int fitting = static_cast<int>(std::sqrt(most)) / 16 * 16;
    return std::clamp(fitting, 16, resolution);
}

std::vector<LeftOut> lightMapShortage(const LightMapLayout& layout, int resolution, int bytes) {
    std::vector<LeftOut> shortage;
    if (layout.leftOut > 0)
        shortage.push_back(
            {"weak lights",
             fmt::format("the scene has {} lights; the limit is {}: the {} weakest do not shine",
                         layout.lights() + layout.leftOut, maxLights, layout.leftOut)});
    const int made = lightMapResolution(layout, resolution, bytes);
    const auto side = static_cast<std::uint64_t>(resolution);
    if (made < resolution)
        shortage.push_back(
            {"map resolution",
             fmt::format("{} maps of {} x {} texels need {}; the limit is {}: they are made of {} x {}",
                         layout.layers, resolution, resolution,
                         bytesText(side * side * static_cast<std::uint64_t>(bytes) * layout.layers),
                         bytesText(maxLightMapBytes), made, made)});
    return shortage;
}

void warnOfShortage(const std::vector<LeftOut>& shortage, std::string& told) {
    std::string text;
    for (const LeftOut& item : shortage) text += item.why + "\n";
    if (text == told) return;
    told = text;
    for (const LeftOut& item : shortage) logWarning("{}", item.why);
}

std::vector<std::byte> lightMapBlock(const LightMapLayout& layout, const std::vector<LightState>& lights,
                                     const SceneFacts& facts, int resolution, float bias,
                                     const LightMapJitter& jitter, const FrameInfo& frame) {
    const CameraState& camera = frame.cameraState;
    const Sphere scene = facts.sphere, near = nearScene(facts, camera);
    const LightMapCounts counts{
        layout.counts[0], layout.counts[1], layout.counts[2], layout.counts[3], layout.counts[4], bias, 0, 0};
    std::vector<LightMap> maps(layout.allMaps());
    std::vector<LightRecord> records(layout.allSlots());
    for (const PlacedMap& placed : placedMaps(layout, lights, near)) {
        LightMap map = mapOf(lights[placed.light], scene, resolution);
        displace(map, static_cast<std::uint32_t>(placed.light), jitter, near.radius, resolution, frame);
        if (placed.nested)
            map = smallerMap(map, nestedHalfWidth(*placed.nested, layout.nested, camera, scene), camera,
                             resolution);
        else if (layout.follows && lights[placed.light].kind == LightKind::Directional)
            map = smallerMap(map, near.radius, camera, resolution);
        map.firstLayer = placed.firstLayer;
        maps[placed.slot] = map;
        if (!placed.nested) records[placed.slot] = recordOf(lights[placed.light]);
    }
    std::vector<std::byte> block(layout.blockBytes());
    std::byte* at = block.data();
    const auto append = [&at](const void* data, size_t bytes) {
        std::memcpy(at, data, bytes);
        at += bytes;
    };
    append(&counts, sizeof(counts));
    append(maps.data(), maps.size() * sizeof(LightMap));
    append(records.data(), records.size() * sizeof(LightRecord));
    return block;
}

Step lightMapStep(std::string name, const World& world, const LightMapLayout& layout) {
    Step step{.name = std::move(name),
              .run = [layout](Commands& commands) { drawLightMaps(layout, commands); },
              .shaders = {"lighting/light_map.vert", "lighting/light_map.frag"},
              .defines = layout.defines(),
              .uses = {{.port = "maps", .access = Access::Uniform}},
              .group = "generation"};
    step.defines.merge(materialDefines(world.facts));
    return step;
}

void drawLightMaps(const LightMapLayout& layout, Commands& commands) {
    // Light comes to both sides of every triangle.
    DrawState state;
    state.cull = Cull::None;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> layers; // slot and face
    const Sphere near = nearScene(commands.facts(), commands.frame().cameraState);
    for (const PlacedMap& placed : placedMaps(layout, commands.lights(), near))
        for (std::uint32_t face = 0; face < std::max(1u, placed.faces); ++face)
            layers.emplace_back(placed.slot, face);
    commands.drawSceneLayers(state,
                             {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided, TriangleClass::Masked,
                              TriangleClass::MaskedDoubleSided},
                             static_cast<std::uint32_t>(layers.size()), [&](std::uint32_t layer) {
                                 commands.set("map_slot", layers[layer].first);
                                 commands.set("map_face", layers[layer].second);
                             });
}

} // namespace kestrel
