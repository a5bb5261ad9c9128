// What light meets first. SHADOW: the depth alone. Otherwise a reflective shadow map (Dachsbacher and Stamminger,
// "Reflective Shadow Maps", 2005): the radiance that the surface reflects diffusely, its plane, and its position.
#include "lib/light_map_block.glsl"
#ifndef LIGHT_MAP_NO_VERTEX
#include "lib/fragment.glsl"
in LightMapVertex LIGHT_MAP_VERTEX vertex;
#endif
#ifndef SHADOW
#include "lib/lights.glsl"
#include "lib/sampling.glsl"
#endif

#ifdef OUT_RADIANCE
out vec4 out_map_radiance;
#endif
#ifdef OUT_NORMAL
out vec4 out_map_normal;
#endif
#ifdef OUT_POSITION
out vec4 out_map_position;
#endif

void main() {
#ifndef LIGHT_MAP_NO_VERTEX
#ifdef MATERIAL_COLOURS
    vec4 colour = vertex.colour;
#else
    vec4 colour = vec4(1.0);
#endif
    TexCoords coords = fragmentTexCoords(vertex.texCoord, vertex.texCoord1);
    uint material = fragmentMaterial();
#ifdef MATERIAL_MASKED
    if (!materialCovers(material, vertex.texCoord, vertex.texCoord1, colour.a)) discard;
#endif
#endif
#ifndef SHADOW
    vec3 origin = light_maps[map_slot].origin;
    LightRecord light = light_map_lights[map_slot];
    vec3 toLight = light.kind == lightKindDirectional ? -light.direction : normalize(light.position - vertex.position);
    uvec4 corners = sceneTriangle(fragmentTriangle());
    vec3 face = faceNormal(scenePosition(corners.x), scenePosition(corners.y), scenePosition(corners.z), toLight);
    float side = dot(face, toLight) < 0.0 ? -1.0 : 1.0;
#ifdef OUT_RADIANCE
#ifdef MATERIAL_NORMAL_MAPS
    vec4 tangent = vertex.tangent;
#else
    vec4 tangent = vec4(0.0);
#endif
    vec3 smoothNormal = dot(vertex.normal, vertex.normal) > 0.0 ? vertex.normal : face;
    vec3 n = side * materialNormal(material, coords, smoothNormal, tangent);
    MaterialSample point = materialAt(material, coords, colour);
    vec3 albedo = point.baseColour.rgb * (1.0 - point.metallic);
    vec3 reflected = albedo / pi * lightIrradiance(light, vertex.position, n, side * face);
    out_map_radiance = vec4(min(reflected, vec3(65504.0)), 1.0); // the largest half float, never infinity
#endif
#ifdef OUT_NORMAL
    // With the distance of the plane from the map's origin: looking up asks how far off the plane a point is.
    out_map_normal = vec4(side * face, dot(side * face, vertex.position - origin));
#endif
#ifdef OUT_POSITION
    out_map_position = vec4(vertex.position, 1.0);
#endif
#endif
}
