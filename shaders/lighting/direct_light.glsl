// The module `radiance` by the scene's lights: emission, and what a hit reflects of each light that its shadow map lets through:
// diffusely, and with HIGHLIGHTS specularly where the light has no extent.
#include "lib/radiance.glsl"
#if LIGHTS > 0
#include "lib/lights.glsl"
#include "lib/light_shadow.glsl"
#include "lib/sampling.glsl"
#include "shared/ggx.h"

layout(std140) uniform M(Maps) {
    LightMapCounts M(counts);
    LightMap M(maps)[MAPS];
    LightRecord M(lights)[LIGHTS];
};
#ifdef SHADOWS
uniform sampler2DArray M(shadow_maps);
float M(visible)(uint slot, Surface at) {
    LIGHT_MAP_OF(map, M(maps), slot, at.position)
    return shadowVisibility(M(shadow_maps), M(maps)[map], at.position, at.normal, M(counts).bias, SHADOW_TAPS);
}
#define VISIBLE(slot, at) M(visible)(slot, at)
#else
#define VISIBLE(slot, at) 1.0
#endif

#ifdef HIGHLIGHTS
vec3 M(toEye) = vec3(0.0);
vec3 M(reflected) = vec3(0.0);
#endif
vec3 M(punctual)(uint slot, Surface at) {
    vec3 toLight;
    float distanceToLight;
    vec3 arriving = punctualLight(M(lights)[slot], at.position, toLight, distanceToLight);
    float cosine = leavesFace(toLight, at.normal) ? max(0.0, dot(at.shadingNormal, toLight)) : 0.0;
#ifdef HIGHLIGHTS
    float visible = VISIBLE(slot, at);
    vec3 lobe = specularLobe(at.shadingNormal, M(toEye), toLight, mix(vec3(dielectricReflectance), at.albedo, at.metallic),
                             ggxAlpha(at.roughness));
    if (cosine > 0.0) M(reflected) += arriving * visible * lobe;
    return arriving * (cosine * visible);
#else
    return arriving * (cosine * VISIBLE(slot, at));
#endif
}

vec3 M(irradiance)(Surface at) {
    vec3 sum = vec3(0.0);
#if POINT_LIGHTS > 0
    EACH_LIGHT(slot, 0, POINT_LIGHTS, M(counts).points, sum += M(punctual)(slot, at);)
#endif
    const uint spots = uint(POINT_LIGHTS);
#if SPOT_LIGHTS > 0
    EACH_LIGHT(slot, spots, SPOT_LIGHTS, M(counts).spots, sum += M(punctual)(slot, at);)
#endif
    const uint directionals = spots + uint(SPOT_LIGHTS);
#if DIRECTIONAL_LIGHTS > 0
    EACH_LIGHT(slot, directionals, DIRECTIONAL_LIGHTS, M(counts).directionals, sum += M(punctual)(slot, at);)
#endif
    const uint rectangles = directionals + uint(DIRECTIONAL_LIGHTS);
#if RECTANGLE_LIGHTS > 0
    EACH_LIGHT(slot, rectangles, RECTANGLE_LIGHTS, M(counts).rectangles,
               sum += rectangleLight(M(lights)[slot], at.position, at.shadingNormal, at.normal) * VISIBLE(slot, at);)
#endif
    const uint spheres = rectangles + uint(RECTANGLE_LIGHTS);
#if SPHERE_LIGHTS > 0
    EACH_LIGHT(slot, spheres, SPHERE_LIGHTS, M(counts).spheres,
               sum += sphereLight(M(lights)[slot], at.position, at.shadingNormal, at.normal) * VISIBLE(slot, at);)
#endif
    return sum;
}
#endif

vec3 M(surface)(Surface at, vec3 toward) {
    vec3 leaving = vec3(0.0);
#ifdef EMISSION
    leaving += at.emission;
#endif
#if LIGHTS > 0
#ifdef HIGHLIGHTS
    M(toEye) = toward;
    M(reflected) = vec3(0.0);
#endif
    leaving += at.albedo * ((1.0 - at.metallic) / pi) * min(M(irradiance)(at), vec3(lightMaximum));
#ifdef HIGHLIGHTS
    leaving += min(M(reflected), vec3(lightMaximum));
#endif
#endif
    return leaving;
}

vec3 M(miss)(vec3 direction) { return vec3(0.0); }
