// Light straight from the scene's lights at the surfaces of a G-buffer. OUT_RESULT: irradiance over pi. OUT_SPECULAR: what
// point, spot and directional lights reflect towards the eye.
#include "lib/lights.glsl"
#include "lib/light_shadow.glsl"
#include "lib/sampling.glsl"
#include "lib/view.glsl"
#include "lib/face.glsl"
#ifdef OUT_SPECULAR
#include "shared/ggx.h"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
uniform sampler2D normal;
layout(std140) uniform DepthView { ViewData depthView; };
layout(std140) uniform Maps {
    LightMapCounts counts;
    LightMap maps[MAPS];
    LightRecord lights[LIGHTS];
};
#ifdef SHADOWS
uniform sampler2DArray shadow_maps;
#endif
#ifdef OUT_RESULT
layout(rgba32f) uniform writeonly image2D result;
#endif
#ifdef OUT_SPECULAR
uniform sampler2D albedo;
uniform sampler2D material;
layout(rgba32f) uniform writeonly image2D specular;
#endif

vec3 position, n, face;
vec3 irradiance = vec3(0.0);
#ifdef OUT_SPECULAR
vec3 glossy = vec3(0.0), toEye, f0;
float alpha;
#endif

float visible(uint slot) {
#ifdef SHADOWS
    LIGHT_MAP_OF(map, maps, slot, position)
    return shadowVisibility(shadow_maps, maps[map], position, n, counts.bias, SHADOW_TAPS);
#else
    return 1.0;
#endif
}

void addPunctual(uint slot) {
    vec3 toLight;
    float distanceToLight;
    vec3 arriving = punctualLight(lights[slot], position, toLight, distanceToLight) * visible(slot);
    if (!leavesFace(toLight, face)) return;
    irradiance += arriving * max(0.0, dot(n, toLight));
#ifdef OUT_SPECULAR
    glossy += arriving * specularLobe(n, toEye, toLight, f0, alpha);
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, textureSize(depth, 0)))) return;
    float z = texelFetch(depth, pixel, 0).r;
    n = texelFetch(normal, pixel, 0).xyz;
    bool background = z == 0.0 || dot(n, n) == 0.0;
    n = background ? vec3(0.0, 0.0, 1.0) : normalize(n);
    position = positionFromDepth(depthView, vec2(pixel) + 0.5, background ? 1.0 : z);
    face = faceAt(pixel, n, depthView, position, 0.0).xyz;
#ifdef OUT_SPECULAR
    vec3 base = texelFetch(albedo, pixel, 0).rgb;
    vec2 surface = texelFetch(material, pixel, 0).rg;
    toEye = towardsEye(depthView, position);
    f0 = mix(vec3(dielectricReflectance), base, surface.y);
    alpha = ggxAlpha(surface.x);
#endif

#if POINT_LIGHTS > 0
    EACH_LIGHT(slot, 0, POINT_LIGHTS, counts.points, addPunctual(slot);)
#endif
    const uint spots = uint(POINT_LIGHTS);
#if SPOT_LIGHTS > 0
    EACH_LIGHT(slot, spots, SPOT_LIGHTS, counts.spots, addPunctual(slot);)
#endif
    const uint directionals = spots + uint(SPOT_LIGHTS);
#if DIRECTIONAL_LIGHTS > 0
    EACH_LIGHT(slot, directionals, DIRECTIONAL_LIGHTS, counts.directionals, addPunctual(slot);)
#endif
#ifdef OUT_RESULT
    const uint rectangles = directionals + uint(DIRECTIONAL_LIGHTS);
#if RECTANGLE_LIGHTS > 0
    EACH_LIGHT(slot, rectangles, RECTANGLE_LIGHTS, counts.rectangles,
               irradiance += rectangleLight(lights[slot], position, n, face) * visible(slot);)
#endif
    const uint spheres = rectangles + uint(RECTANGLE_LIGHTS);
#if SPHERE_LIGHTS > 0
    EACH_LIGHT(slot, spheres, SPHERE_LIGHTS, counts.spheres,
               irradiance += sphereLight(lights[slot], position, n, face) * visible(slot);)
#endif
    imageStore(result, pixel, vec4(background ? vec3(0.0) : min(irradiance / pi, vec3(lightMaximum)), 1.0));
#endif
    ITERATIONS_END;
#ifdef OUT_SPECULAR
    imageStore(specular, pixel, vec4(background ? vec3(0.0) : min(glossy, vec3(lightMaximum)), 1.0));
#endif
}
