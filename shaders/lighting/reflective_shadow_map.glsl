// The module `radiance` by reflective shadow maps: one diffuse reflection of the light of each kind. Area lights are seen from
// their middle: what that sees receives their whole light, as in DirectLight.
//
// A hit counts as the surface that a texel holds if it lies within a tolerance of that surface's plane: so many texels as
// `bias` (a curved surface leaves its plane within one) and the error that the hit's tracer states. Distance from the plane,
// not along the ray of light: within a texel the latter grows without bound as the light comes in flat. Light leaves to the
// lit side only, so that a thin wall keeps it out.
//
// Behind the plane only a share of the error counts. What lies there is mostly something else, in the shadow of what the
// texel holds, while a proxy reports the first cell that a ray meets, which stands before its surface.
#include "lib/radiance.glsl"
#if LIGHTS > 0
#include "lib/light_maps.glsl"

uniform sampler2DArray M(map_radiance);
uniform sampler2DArray M(map_normal);
layout(std140) uniform M(Maps) {
    LightMapCounts M(counts);
    LightMap M(maps)[LIGHTS];
    LightRecord M(lights)[LIGHTS];
};

// Through ROMA against Embree (FLIP of one bounce, hall and cornell): 0 gives 0.312 and 0.145, 0.2 0.256 and 0.104, 0.35 0.265
// and 0.102. The whole error lights what lies in shadow close behind: hall 0.329 where one cell either way had 0.295.
const float M(errorBehind) = 0.25;

// `faces` are those of the light's kind: what a map with others would need is left out.
vec3 M(fromMap)(uint slot, uint faces, Surface at, vec3 toward) {
    LightMap map = M(maps)[slot];
    map.faces = faces;
    LightMapPlace place = lightMapPlace(map, at.position, float(RESOLUTION));
    ivec3 texel = ivec3(clamp(ivec2(floor(place.texel)), ivec2(0), ivec2(RESOLUTION - 1)), place.layer);
    vec4 plane = texelFetch(M(map_normal), texel, 0);
    vec3 radiance = texelFetch(M(map_radiance), texel, 0).rgb;
    float before = dot(plane.xyz, at.position - map.origin) - plane.w;
    float off = before < 0.0 ? -before - M(errorBehind) * at.error : before - at.error;
    bool lit = place.inside && off <= M(counts).bias * place.footprint && dot(plane.xyz, toward) > 0.0;
    return lit ? radiance : vec3(0.0);
}
#endif

vec3 M(surface)(Surface at, vec3 toward) {
    vec3 sum = vec3(0.0);
#if LIGHTS > 0
#if POINT_LIGHTS > 0
    EACH_LIGHT(slot, 0, POINT_LIGHTS, M(counts).points, sum += M(fromMap)(slot, 6u, at, toward);)
#endif
#if SPOT_LIGHTS > 0
#ifdef WIDE_SPOTS
    EACH_LIGHT(slot, POINT_LIGHTS, SPOT_LIGHTS, M(counts).spots,
               sum += M(fromMap)(slot, M(maps)[slot].faces, at, toward);)
#else
    EACH_LIGHT(slot, POINT_LIGHTS, SPOT_LIGHTS, M(counts).spots, sum += M(fromMap)(slot, 1u, at, toward);)
#endif
#endif
#if DIRECTIONAL_LIGHTS > 0
    EACH_LIGHT(slot, POINT_LIGHTS + SPOT_LIGHTS, DIRECTIONAL_LIGHTS, M(counts).directionals,
               sum += M(fromMap)(slot, 0u, at, toward);)
#endif
#if RECTANGLE_LIGHTS > 0
    EACH_LIGHT(slot, POINT_LIGHTS + SPOT_LIGHTS + DIRECTIONAL_LIGHTS, RECTANGLE_LIGHTS, M(counts).rectangles,
               sum += M(fromMap)(slot, 5u, at, toward);)
#endif
#if SPHERE_LIGHTS > 0
    EACH_LIGHT(slot, POINT_LIGHTS + SPOT_LIGHTS + DIRECTIONAL_LIGHTS + RECTANGLE_LIGHTS, SPHERE_LIGHTS, M(counts).spheres,
               sum += M(fromMap)(slot, 6u, at, toward);)
#endif
#endif
    return sum;
}

vec3 M(miss)(vec3 direction) { return vec3(0.0); }
