// The scene as one face of a light's map sees it.
#include "lib/light_map_block.glsl"
#include "lib/vertex.glsl"

#ifndef LIGHT_MAP_NO_VERTEX
out LightMapVertex LIGHT_MAP_VERTEX vertex;
#endif

void main() {
#ifndef LIGHT_MAP_NO_VERTEX
    vertex.position = in_position;
    vertex.normal = in_normal;
    vertex.texCoord = in_tex_coord;
    vertex.texCoord1 = in_tex_coord1;
#ifdef MATERIAL_NORMAL_MAPS
    vertex.tangent = in_tangent;
#endif
#ifdef MATERIAL_COLOURS
    vertex.colour = in_colour;
#endif
#endif
    LightMap map = light_maps[map_slot];
    vec3 local = lightMapLocal(map.axisX, map.axisY, map.axisZ, in_position - map.origin);
    vec3 ahead = lightMapTurned(local, map_face);
    bool parallel = map.faces == 0u;
    float w = parallel ? 1.0 : ahead.z;
    float depth = parallel ? (map.farEnd - ahead.z) * map.inverseRange : map.nearPlane;
    gl_Position = vec4(ahead.xy / map.halfWidth + map.jitter * w, depth, w);
}
