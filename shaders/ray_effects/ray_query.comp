// Each invocation traces one ray of the buffer.
#include "shared/ray.h"
#include "lib/tracer.glsl"
#include "lib/iterations.glsl"
#include <port:tracer>

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

void main() {
    int id = int(gl_GlobalInvocationID.y) * GROUPS_PER_ROW * GROUP_SIZE + int(gl_GlobalInvocationID.x);
    if (3 * id >= RAY_TEXELS) return;
    // RayRecord, texel by texel.
    vec4 from = RAY_TEXEL(3 * id);
    vec4 along = RAY_TEXEL(3 * id + 1);
    vec4 surface = RAY_TEXEL(3 * id + 2);
    Ray ray = Ray(from.xyz, surface.xyz, along.xyz, from.w, along.w, 1.0, 0u);
    bool exists = (floatBitsToUint(surface.w) & 1u) != 0u;
    ray.tMax = exists ? ray.tMax : -1.0;
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
