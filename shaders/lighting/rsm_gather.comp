// One bounce from reflective shadow maps (Dachsbacher and Stamminger 2005, section 4.2). Samples are drawn from a disk on a
// plane: of a spot or directional light its map's, around the pixel's place in it; of a point light one that all directions
// are mapped to with their solid angles (Lambert's azimuthal projection), around the direction of the pixel. A sample lies at
// the radius R x1 and the angle 2 pi x2, so the density of samples is 1 / (2 pi R r), and each counts as the area
// 2 pi R^2 x1: the paper's weight x1^2 has no such derivation.
//
// A sample is the part of the surface that an area du dv of the plane stands for: r^2 dw / cos at the light, where of a spot
// light dw is du dv / (1 + u^2 + v^2)^(3/2). Its form factor is that of a disk (Wallace, Elmquist and
// Haines, "A Ray Tracing Algorithm for Progressive Radiosity", 1989), which stays finite where surfaces meet.
#include "lib/frame.glsl"
#include "lib/face.glsl"
#include "lib/light_maps.glsl"
#include "lib/sampling.glsl"
#include "lib/view.glsl"
#include "shared/random.h"

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D depth;
uniform sampler2D normal;
layout(rgba16f) uniform readonly image2DArray map_radiance;
layout(rgba32f) uniform readonly image2DArray map_normal;
layout(rgba32f) uniform readonly image2DArray map_position;
layout(rgba32f) uniform writeonly image2D result;
layout(std140) uniform DepthView { ViewData depthView; };
layout(std140) uniform Maps {
    LightMapCounts counts;
    LightMap maps[LIGHTS];
    LightRecord lights[LIGHTS];
};
uniform float radius;

vec3 position, n, face;

// Irradiance over pi from one map.
vec3 gathered(uint slot, uint seed, uint first) {
    LightMap map = maps[slot];
    int size = imageSize(map_radiance).x;
    bool parallel = map.faces == 0u;
    bool around = map.faces > 1u;
    vec3 local = lightMapLocal(map.axisX, map.axisY, map.axisZ, position - map.origin);
    // Where on the plane the disk lies; of a point light what turns the plane's axis towards the pixel.
    mat3 plane = mat3(1.0);
    vec2 centre = vec2(0.0);
    if (around) {
        plane = basisAround(dot(local, local) > 0.0 ? normalize(local) : vec3(0.0, 0.0, 1.0));
    } else {
        centre = parallel ? local.xy : local.z > 0.0 ? local.xy / local.z : vec2(0.0);
        float off = length(centre);
        // A pixel outside of the map asks the nearest part of it.
        if (!(off <= map.halfWidth)) centre = off > 0.0 && off < 1e30 ? centre * (map.halfWidth / off) : vec2(0.0);
    }
    float width = around ? 2.0 : 2.0 * map.halfWidth;
    float texelArea = width / float(size) * (width / float(size));
    float disk = radius * width;
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < uint(SAMPLES); ++i) {
        ITERATION;
        vec2 x = scrambledSobol(first + i, seed);
        vec2 uv = centre + disk * x.x * vec2(cos(2.0 * pi * x.y), sin(2.0 * pi * x.y));
        float r2 = dot(uv, uv);
        // At the radius 2 of the azimuthal projection all directions have been seen.
        vec3 direction = around ? plane * vec3(uv * sqrt(max(0.0, 1.0 - 0.25 * r2)), 1.0 - 0.5 * r2)
                                : vec3(uv, parallel ? 0.0 : 1.0);
        bool exists = !around || r2 <= 4.0;
        LightMapPlace place = lightMapPlaceLocal(map, direction, float(size));
        ivec3 texel = ivec3(clamp(ivec2(floor(place.texel)), ivec2(0), ivec2(size - 1)), place.layer);
        vec3 radiance = imageLoad(map_radiance, texel).rgb;
        vec4 lamp = imageLoad(map_normal, texel);
        vec4 from = imageLoad(map_position, texel);

        // Area of the surface for an area of the plane.
        vec3 fromLight = from.xyz - map.origin;
        float cosine = parallel ? -dot(lamp.xyz, map.axisZ) : -lamp.w * inversesqrt(max(dot(fromLight, fromLight), 1e-37));
        float turn = around ? 1.0 : 1.0 + r2;
        float spread = parallel ? 1.0 : dot(fromLight, fromLight) / (turn * sqrt(turn));
        spread /= max(cosine, 1e-3);
        float area = 2.0 * pi * disk * disk * x.x * spread;

        vec3 to = from.xyz - position;
        float d2 = dot(to, to);
        vec3 toLamp = d2 > 0.0 ? to * inversesqrt(d2) : vec3(0.0);
        float cosines = max(0.0, dot(n, toLamp)) * max(0.0, -dot(lamp.xyz, toLamp));
        float factor = area * cosines / max(pi * d2 + spread * texelArea, 1e-37);
        sum += exists && leavesFace(toLamp, face) && place.inside && from.w > 0.0 ? radiance * factor : vec3(0.0);
    }
    return sum / float(SAMPLES);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
    float z = texelFetch(depth, pixel, 0).r;
    n = texelFetch(normal, pixel, 0).xyz;
    bool background = z == 0.0 || dot(n, n) == 0.0;
    n = background ? vec3(0.0, 0.0, 1.0) : normalize(n);
    position = positionFromDepth(depthView, vec2(pixel) + 0.5, background ? 1.0 : z);
    face = faceAt(pixel, n, depthView, position, texelFetch(normal, pixel, 0).w).xyz;
#ifdef ROTATE
    uint seed = pixelSeed(uvec2(pixel), randomGather, frame.seed);
    uint first = frame.index * uint(SAMPLES);
#else
    uint seed = pixelSeed(uvec2(0u), randomGather, frame.seed);
    uint first = 0u;
#endif

    vec3 light = vec3(0.0);
#if POINT_LIGHTS > 0
    EACH_LIGHT(slot, 0, POINT_LIGHTS, counts.points, light += gathered(slot, hashCombine(seed, slot), first);)
#endif
#if SPOT_LIGHTS > 0
    EACH_LIGHT(slot, POINT_LIGHTS, SPOT_LIGHTS, counts.spots, light += gathered(slot, hashCombine(seed, slot), first);)
#endif
#if DIRECTIONAL_LIGHTS > 0
    EACH_LIGHT(slot, POINT_LIGHTS + SPOT_LIGHTS, DIRECTIONAL_LIGHTS, counts.directionals,
               light += gathered(slot, hashCombine(seed, slot), first);)
#endif
#if RECTANGLE_LIGHTS > 0
    EACH_LIGHT(slot, POINT_LIGHTS + SPOT_LIGHTS + DIRECTIONAL_LIGHTS, RECTANGLE_LIGHTS, counts.rectangles,
               light += gathered(slot, hashCombine(seed, slot), first);)
#endif
#if SPHERE_LIGHTS > 0
    EACH_LIGHT(slot, POINT_LIGHTS + SPOT_LIGHTS + DIRECTIONAL_LIGHTS + RECTANGLE_LIGHTS, SPHERE_LIGHTS, counts.spheres,
               light += gathered(slot, hashCombine(seed, slot), first);)
#endif
    ITERATIONS_END;
    imageStore(result, pixel, vec4(background ? vec3(0.0) : min(light, vec3(1e30)), 1.0));
}
