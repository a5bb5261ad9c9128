// What the programs that draw maps of lights hand from stage to stage, and their block.
#include "lib/frame.glsl"
#include "shared/light_map.h"

layout(std140) uniform Maps {
    LightMapCounts light_map_counts;
    LightMap light_maps[MAPS];
    LightRecord light_map_lights[LIGHTS];
};

uniform uint map_slot;
uniform uint map_face;

// With SHADOW only depth is drawn.
#if defined(SHADOW) && !defined(MATERIAL_MASKED)
#define LIGHT_MAP_NO_VERTEX
#endif
#ifdef MATERIAL_NORMAL_MAPS
#define LIGHT_MAP_TANGENT vec4 tangent;
#else
#define LIGHT_MAP_TANGENT
#endif
#ifdef MATERIAL_COLOURS
#define LIGHT_MAP_COLOUR vec4 colour;
#else
#define LIGHT_MAP_COLOUR
#endif
#define LIGHT_MAP_VERTEX                                                                                                     \
    {                                                                                                                        \
        vec3 position;                                                                                                       \
        vec3 normal;                                                                                                         \
        vec2 texCoord;                                                                                                       \
        vec2 texCoord1;                                                                                                      \
        LIGHT_MAP_TANGENT LIGHT_MAP_COLOUR                                                                                   \
    }
