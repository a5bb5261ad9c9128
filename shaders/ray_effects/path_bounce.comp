// One ray of each path: what the surface that it meets sends out, what the lights give there, and the next ray.
#include "lib/iterations.glsl"
#include "lib/radiance.glsl"
#include <port:tracer>
#include <port:radiance>
#include "ray_effects/path.glsl"
#ifdef SURFACES
#include "lib/material.glsl"
#endif
#ifdef PANELS
#include "lib/lights.glsl"
#endif

layout(local_size_x = 64) in;

uniform uint bounce;

#ifdef PANELS
// Whether a surface that glows like this is the visible side of an area light, whose light the lights are asked for
// (areaLightPanels() of framework/reference/area_emitters.h).
bool showsAreaLight(vec3 position, vec3 emission) {
    const float samePlace = 1e-3;
    bool shows = false;
    for (uint i = 0u; i < scene_light_count; ++i) {
        ITERATION;
        LightRecord light = scene_lights[i];
        vec3 r = position - light.position;
        bool sphere = light.kind == lightKindSphere;
        float tolerance = samePlace * max(light.halfSize.x, sphere ? 0.0 : light.halfSize.y);
        vec2 across = abs(vec2(dot(r, light.tangent), dot(r, light.bitangent)));
        bool onPlane = abs(dot(r, light.direction)) <= tolerance && all(lessThanEqual(across, light.halfSize + tolerance));
        bool liesOn = sphere ? abs(length(r) - light.halfSize.x) <= tolerance : onPlane;
        const vec3 weights = vec3(0.2126, 0.7152, 0.0722);
        bool alike = dot(abs(emission - light.intensity), weights) <= 0.01 * dot(light.intensity, weights);
        shows = shows || ((sphere || light.kind == lightKindRectangle) && liesOn && alike);
    }
    return shows;
}
#endif

void main() {
    // Groups are whole: those after the end of the list trace an empty interval.
    uint list = (bounce - 1u) * uint(ALIVE_WORDS);
    bool exists = gl_GlobalInvocationID.x < alive[list];
    uint slot = exists ? alive[list + aliveHeader + gl_GlobalInvocationID.x] : 0u;
    uint record = slot * pathRecordTexels;
    vec4 first = paths[record];
    vec4 third = paths[record + 2u];
    vec3 throughput = third.rgb;
    ivec2 pixel = unpackPixel(floatBitsToUint(third.w));
    Ray ray = surfaceRay(first.xyz, paths[record + 3u].xyz, paths[record + 1u].xyz);
    tracer_aim(ray);
    if (!exists) ray.tMax = -1.0; // an empty interval: no tracer walks it
    Hit hit;
    vec3 arriving;
    bool goes = false;
    if (tracer_closestHit(ray, hit)) {
#ifdef SURFACES
        Surface at = tracer_surface(ray, hit);
        MaterialRecord of = scene_materials[at.material];
        vec3 size = abs(at.position);
        // As from an eye where the ray came from.
        float start = rayStart(hit.t, max(size.x, max(size.y, size.z)), at.reach);
        // What a tracer knows no surface of takes in all light.
        bool known = at.error == 0.0;
        BsdfSurface bsdf = BsdfSurface(known ? at.albedo : vec3(0.0), at.metallic, at.roughness, of.transmission,
                                       relativeIndex(of.ior, at.front));
        goes = exists;
        vec3 own = at.emission;
#ifdef PANELS
        if (floatBitsToUint(first.w) == bsdfDiffuse && showsAreaLight(at.position, own)) own = vec3(0.0);
#endif
        arriving = throughput * own + scatter(at, bsdf, -ray.direction, start, throughput, slot, pixel, bounce, goes);
#ifdef UNLIT
        if (known && (of.flags & materialFlagUnlit) != 0u) {
            arriving = throughput * (bsdf.colour + at.emission);
            goes = false;
        }
#endif
#else
        arriving = throughput * radiance_surface(facingSurface(ray, hit), -ray.direction);
#endif
    } else {
        arriving = throughput * radiance_miss(ray.direction);
    }
    ITERATIONS_END;
    if (exists) light[2u * slot + 1u].rgb += arriving;
#ifndef LAST
    goOn(slot, goes, bounce);
#endif
}
