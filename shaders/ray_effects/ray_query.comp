// Each invocation traces one ray of the buffer.
#include "shared/ray.h"
#include "lib/tracer.glsl"
#include "lib/trips.glsl"
#include <port:tracer>

layout(local_size_x = GROUP_SIZE) in;

layout(std430) readonly buffer Rays { RayRecord rays[]; };
layout(std430) writeonly buffer Hits { HitRecord hits[]; };

void main() {
    uint id = gl_GlobalInvocationID.y * uint(GROUPS_PER_ROW * GROUP_SIZE) + gl_GlobalInvocationID.x;
    if (id >= uint(rays.length())) return;
    RayRecord record = rays[id];
    Ray ray = Ray(record.origin, record.normal, record.direction, record.tMin, record.tMax, 1.0, 0u);
    bool exists = (record.flags & 1u) != 0u;
    ray.tMax = exists ? ray.tMax : -1.0;
    tracer_aim(ray);
    HitRecord result = HitRecord(rayInfinity, ray.weight, 0u, 0u, ray.direction, 0u);
    TRIPS_BEGIN;
#ifdef CLOSEST
    Hit hit;
    if (tracer_closestHit(ray, hit) && exists) {
        result.t = hit.t;
        result.idX = hit.id.x;
        result.idY = hit.id.y;
        result.source = hit.source;
    }
#else
    if (tracer_anyHit(ray) && exists) result.t = 0.0;
#endif
    TRIPS_END;
    hits[id] = result;
}
