// Looking things up in maps made from lights (shared/light_map.h).
#include "lib/iterations.glsl"
#include "shared/light_map.h"

// Does `BODY` for each light of one kind: `slot` runs over [FIRST, FIRST + SLOTS) of a block, of which `count` are in use.
// SLOTS is a constant and not 0: leave the whole out with #if where it is, since a loop without iterations still takes the time of
// one on a driver that masks. A single light takes no loop, for the same reason.
#define EACH_LIGHT(slot, FIRST, SLOTS, count, BODY)                                                                          \
    if (SLOTS == 1) {                                                                                                        \
        const uint slot = uint(FIRST);                                                                                       \
        BODY                                                                                                                 \
    } else {                                                                                                                 \
        for (uint slot = uint(FIRST); slot < uint(FIRST) + uint(SLOTS) && slot < uint(FIRST) + count; ++slot) {              \
            ITERATION;                                                                                                            \
            BODY                                                                                                             \
        }                                                                                                                    \
    }

// Where something lies in a map.
struct LightMapPlace {
    vec2 texel;      // coordinate on the face; the centre of a texel is at + 0.5
    int layer;
    float depth;     // reversed: 1 at the near plane
    float footprint; // width of a texel there, in scene units
    vec3 ahead;      // the face's right, up and forward of what was asked about
    bool inside;     // of the face
};

// Of a position in the map's axes; perspective maps take any length.
LightMapPlace lightMapPlaceLocal(LightMap map, vec3 local, float resolution) {
    uint face = map.faces > 1u ? min(lightMapFace(local), map.faces - 1u) : 0u;
    bool parallel = map.faces == 0u;
    LightMapPlace place;
    place.ahead = lightMapTurned(local, face);
    float w = parallel ? 1.0 : place.ahead.z;
    vec2 onFace = place.ahead.xy / (w * map.halfWidth) + map.jitter;
    place.texel = (onFace * 0.5 + 0.5) * resolution;
    place.layer = int(map.firstLayer + face);
    place.depth = parallel ? (map.farEnd - place.ahead.z) * map.inverseRange : map.nearPlane / place.ahead.z;
    place.footprint = 2.0 * w * map.halfWidth / resolution;
    place.inside = w > 0.0 && all(greaterThanEqual(place.texel, vec2(0.0))) && all(lessThan(place.texel, vec2(resolution)));
    return place;
}

// Whether a smaller one of a light's parallel maps holds a position, with room for filters about it.
bool lightMapHolds(LightMap map, vec3 position) {
    vec3 local = abs(lightMapLocal(map.axisX, map.axisY, map.axisZ, position - map.origin));
    return max(local.x, max(local.y, local.z)) < 0.98 * map.halfWidth;
}

// The map to look a position up in, of the light in `slot`: of a directional light's the smallest that holds it. Its smaller
// maps, NESTED_MAPS of them from small to large, lie behind those of all lights.
#if NESTED_MAPS > 0
#define LIGHT_MAP_OF(result, MAPS, slot, position)                                                                           \
    uint result = slot;                                                                                                      \
    if (slot >= uint(POINT_LIGHTS + SPOT_LIGHTS) && slot < uint(POINT_LIGHTS + SPOT_LIGHTS + DIRECTIONAL_LIGHTS)) {           \
        uint first = uint(LIGHTS) + (slot - uint(POINT_LIGHTS + SPOT_LIGHTS)) * uint(NESTED_MAPS);                           \
        for (uint i = uint(NESTED_MAPS); i-- > 0u;) {                                                                        \
            ITERATION;                                                                                                       \
            if (lightMapHolds(MAPS[first + i], position)) result = first + i;                                                \
        }                                                                                                                    \
    }
#else
#define LIGHT_MAP_OF(result, MAPS, slot, position) const uint result = slot;
#endif

LightMapPlace lightMapPlace(LightMap map, vec3 position, float resolution) {
    return lightMapPlaceLocal(map, lightMapLocal(map.axisX, map.axisY, map.axisZ, position - map.origin), resolution);
}
