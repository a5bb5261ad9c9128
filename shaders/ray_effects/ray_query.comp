// Each invocation traces one ray of the buffer, or RAYS of them where the tracer takes many (REQUESTS_MANY).
#include "shared/ray.h"
#include "lib/tracer.glsl"
#include "lib/iterations.glsl"
#ifndef RAYS
#include <port:tracer>
#endif

layout(local_size_x = GROUP_SIZE) in;

#ifdef RAYS_STORAGE
layout(std430) readonly buffer Rays { vec4 rays[]; };
#define RAY_TEXEL(index) rays[index]
#define RAY_TEXELS rays.length()
#else
layout(rgba32ui) readonly uniform uimageBuffer rays; // bits: a record holds flags, and may hold infinity
#define RAY_TEXEL(index) uintBitsToFloat(imageLoad(rays, index))
#define RAY_TEXELS imageSize(rays)
#endif
#ifdef HITS
layout(std430) writeonly buffer Hits { HitRecord hits[]; };
#endif
#ifdef DISTANCES
layout(std430) writeonly buffer Distance { float distances[]; };
#endif

// A ray of the buffer, texel by texel, and whether it exists.
Ray rayAt(int id, out bool exists) {
    vec4 from = RAY_TEXEL(3 * id);
    vec4 along = RAY_TEXEL(3 * id + 1);
    vec4 surface = RAY_TEXEL(3 * id + 2);
    exists = (floatBitsToUint(surface.w) & 1u) != 0u;
    return Ray(from.xyz, surface.xyz, along.xyz, from.w, exists ? along.w : -1.0, 1.0, 0u);
}

#ifdef RAYS

// Invocations that a driver runs side by side start with neighbours and go on with neighbours.
const int abreast = 8;
int rayNumber(uint i) {
    int invocation = int(gl_GlobalInvocationID.y) * GROUPS_PER_ROW * GROUP_SIZE + int(gl_GlobalInvocationID.x);
    return (invocation / abreast * RAYS + int(i)) * abreast + invocation % abreast;
}

void tracer_aim(inout Ray ray);
Ray tracer_ray(uint i) {
    bool exists;
    Ray ray = rayAt(rayNumber(i), exists);
    tracer_aim(ray);
    return ray;
}
void put(int id, bool met, Hit hit) {
    float t = met ? hit.t : rayInfinity;
#ifdef DISTANCES
    distances[id] = t;
#endif
#ifdef HITS
    hits[id] = HitRecord(t, 1.0, met ? hit.id.x : 0u, met ? hit.id.y : 0u, RAY_TEXEL(3 * id + 1).xyz, met ? hit.source : 0u);
#endif
}
void tracer_give(uint i, bool met, Hit hit) { put(rayNumber(i), met, hit); }
#include <port:tracer>

void main() {
    int count = int(RAY_TEXELS) / 3;
    uint wanted = 0u;
    for (uint i = 0u; i < uint(RAYS); ++i) {
        ITERATION;
        int id = rayNumber(i);
        if (id < count && (floatBitsToUint(RAY_TEXEL(3 * id + 2).w) & 1u) != 0u) wanted |= 1u << i;
    }
#ifdef CLOSEST
    tracer_closestHits(wanted);
    uint met = 0u, left = ~wanted;
#else
    uint met = tracer_anyHits(wanted), left = 0xffffffffu;
#endif
    for (uint i = 0u; i < uint(RAYS); ++i) {
        ITERATION;
        int id = rayNumber(i);
        if (id < count && (left >> i & 1u) != 0u) put(id, (met >> i & 1u) != 0u, Hit(0.0, 0.0, 0u, uvec2(0u)));
    }
    ITERATIONS_END;
}

#else

void main() {
    int id = int(gl_GlobalInvocationID.y) * GROUPS_PER_ROW * GROUP_SIZE + int(gl_GlobalInvocationID.x);
    if (3 * id >= RAY_TEXELS) return;
    bool exists;
    Ray ray = rayAt(id, exists);
    tracer_aim(ray);
    Hit hit = noHit;
#ifdef CLOSEST
    bool met = tracer_closestHit(ray, hit) && exists;
#else
    bool met = tracer_anyHit(ray) && exists;
    hit.t = 0.0;
#endif
    ITERATIONS_END;
    float t = met ? hit.t : rayInfinity;
#ifdef DISTANCES
    distances[id] = t;
#endif
#ifdef HITS
    hits[id] = HitRecord(t, ray.weight, met ? hit.id.x : 0u, met ? hit.id.y : 0u, ray.direction, met ? hit.source : 0u);
#endif
}

#endif
