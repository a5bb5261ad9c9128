#include "light_maps.h"
#include "core/check.h"
#include "draw/material_defines.h"
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

// Tangent of half a face's angle, without the guard.
float halfWidthOf(const LightState& light) {
    if (light.kind != LightKind::Spot) return 1;
    constexpr float widest = 1.3962634f; // 80 degrees: a flat map has no use for more
    return std::tan(std::clamp(light.outerCone, 1e-3f, widest));
}

LightMap mapOf(const LightState& light, const Sphere& scene, int resolution) {
    const float radius = scene.radius > 0 ? scene.radius : 1;
    const float guarded =
        static_cast<float>(resolution) / (static_cast<float>(resolution) - 2 * lightMapGuard);
    LightMap map{};
    map.axisX = light.tangent;
    map.axisY = light.bitangent;
    map.axisZ = light.direction;
    map.origin = light.position;
    map.faces = lightMapFaces(light.kind);
    if (light.kind == LightKind::Directional) {
        // The slab of the scene's bounding sphere, a little wider than rounding.
        const float wide = 1.001f * radius;
        map.origin = scene.centre - wide * light.direction;
        map.halfWidth = wide * guarded;
        map.inverseRange = 1 / (2 * wide);
        return map;
    }
    // Depth is one over the distance, in float: a near plane costs no precision far away.
    map.nearPlane = 1e-4f * radius;
    if (light.kind == LightKind::Sphere) map.nearPlane = std::max(map.nearPlane, light.halfSize.x);
    map.halfWidth = halfWidthOf(light) * guarded;
    return map;
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

std::uint32_t LightMapLayout::firstSlot(LightKind kind) const {
    return std::accumulate(slots.begin(), slots.begin() + static_cast<std::ptrdiff_t>(indexOf(kind)), 0u);
}

Defines LightMapLayout::defines() const {
    constexpr std::array<const char*, 5> names = {"POINT_LIGHTS", "SPOT_LIGHTS", "DIRECTIONAL_LIGHTS",
                                                  "RECTANGLE_LIGHTS", "SPHERE_LIGHTS"};
    Defines result;
    for (size_t i = 0; i < names.size(); ++i) result.emplace(names[i], std::to_string(slots[i]));
    result.emplace("LIGHTS", std::to_string(allSlots()));
    return result;
}

std::uint64_t LightMapLayout::blockBytes() const {
    return sizeof(LightMapCounts) + std::uint64_t{allSlots()} * (sizeof(LightMap) + sizeof(LightRecord));
}

std::uint32_t lightMapFaces(LightKind kind) {
    switch (kind) {
    case LightKind::Directional:
        return 0;
    case LightKind::Spot:
        return 1;
    case LightKind::Rectangle:
        return 5;
    case LightKind::Point:
    case LightKind::Sphere:
        break;
    }
    return 6;
}

LightMapLayout lightMapLayout(const SceneFacts& facts, const LightKinds& kinds, bool mapped) {
    LightMapLayout layout;
    layout.mapped = mapped;
    for (const LightKind kind : allKinds) {
        if (!kinds[indexOf(kind)]) continue;
        const std::uint32_t count = countOf(facts, kind);
        layout.counts[indexOf(kind)] = count;
        layout.slots[indexOf(kind)] = count > 0 ? std::bit_ceil(count) : 0;
        if (mapped) layout.layers += count * std::max(1u, lightMapFaces(kind));
    }
    return layout;
}

std::optional<std::string> lightMapMistake(const LightMapLayout& layout, int resolution, int bytes) {
    if (layout.allSlots() > maxLightSlots)
        return fmt::format("the scene has {} lights, which take {} slots (powers of two for each kind); the "
                           "limit is {}",
                           layout.lights(), layout.allSlots(), maxLightSlots);
    const auto side = static_cast<std::uint64_t>(resolution);
    const std::uint64_t need = side * side * static_cast<std::uint64_t>(bytes) * layout.layers;
    if (need > maxLightMapBytes)
        return fmt::format("{} maps of {} x {} texels need {}; the limit is {}: lower the resolution",
                           layout.layers, resolution, resolution, bytesText(need),
                           bytesText(maxLightMapBytes));
    return {};
}

std::vector<std::byte> lightMapBlock(const LightMapLayout& layout, const std::vector<LightState>& lights,
                                     const Sphere& scene, int resolution, float bias,
                                     const LightMapJitter& jitter, const FrameInfo& frame) {
    const LightMapCounts counts{
        layout.counts[0], layout.counts[1], layout.counts[2], layout.counts[3], layout.counts[4], bias, 0, 0};
    std::vector<LightMap> maps(layout.allSlots());
    std::vector<LightRecord> records(layout.allSlots());
    std::uint32_t layer = 0;
    for (const LightKind kind : allKinds) {
        if (layout.counts[indexOf(kind)] == 0) continue;
        std::uint32_t slot = layout.firstSlot(kind);
        for (size_t i = 0; i < lights.size(); ++i) {
            if (lights[i].kind != kind) continue;
            KESTREL_CHECK_LT(slot, layout.firstSlot(kind) + layout.counts[indexOf(kind)]);
            LightMap map = mapOf(lights[i], scene, resolution);
            displace(map, static_cast<std::uint32_t>(i), jitter, scene.radius, resolution, frame);
            map.firstLayer = layer;
            layer += std::max(1u, map.faces);
            maps[slot] = map;
            records[slot] = recordOf(lights[i]);
            ++slot;
        }
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
    // Choosing the layer in the vertex shader spares a stage where the driver can.
    if (world.capabilities.has("GL_ARB_shader_viewport_layer_array"))
        step.defines.emplace("LAYER_BY_VERTEX", "1");
    else
        step.shaders.emplace_back("lighting/light_map.geom");
    return step;
}

void drawLightMaps(const LightMapLayout& layout, Commands& commands) {
    // Light comes to both sides of every triangle.
    DrawState state;
    state.cull = Cull::None;
    int layer = 0;
    for (const LightKind kind : allKinds)
        for (std::uint32_t i = 0; i < layout.counts[indexOf(kind)]; ++i)
            for (std::uint32_t face = 0; face < std::max(1u, lightMapFaces(kind)); ++face) {
                commands.set("map_slot", layout.firstSlot(kind) + i);
                commands.set("map_face", face);
                commands.set("map_layer", layer++);
                commands.drawScene(state, {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided,
                                           TriangleClass::Masked, TriangleClass::MaskedDoubleSided});
            }
}

} // namespace kestrel
