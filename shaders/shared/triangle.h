// Ray against triangle and box, the same formulas on both sides of the C++/GLSL border.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

struct TriangleHit {
    float t; // distance along the direction
    float u; // barycentric weight of the second vertex
    float v; // and of the third
};

// Is there an intersection with tMin <= t <= tMax, from either side? The signs of three edge tests in Plücker
// coordinates decide (as in Embree's robust mode): for two triangles that share an edge they are computed from the
// same numbers and are exact opposites, so that no ray slips through between them. Degenerate triangles are missed.
inline bool intersectTriangle(vec3 origin, vec3 direction, float tMin, float tMax, vec3 p0, vec3 p1, vec3 p2,
                              OUT(TriangleHit) hit) {
    const vec3 a = p0 - origin;
    const vec3 b = p1 - origin;
    const vec3 c = p2 - origin;
    const float wa = dot(cross(c - b, b + c), direction);
    const float wb = dot(cross(a - c, c + a), direction);
    const float wc = dot(cross(b - a, a + b), direction);
    const vec3 normal = cross(b - a, c - a);
    const float slope = dot(normal, direction);
    const float t = dot(normal, a) / slope;
    const float sum = wa + wb + wc;
    hit.t = t;
    hit.u = wb / sum;
    hit.v = wc / sum;
    const bool inside = min(wa, min(wb, wc)) >= 0.0f || max(wa, max(wb, wc)) <= 0.0f;
    // A zero slope or sum makes t, u, v infinite or NaN; every comparison below is false then or refused here.
    return inside && slope != 0.0f && sum != 0.0f && t >= tMin && t <= tMax;
}

// 1 / direction with zeros replaced by numbers so small that no slab test notices, but 0 * infinity cannot arise.
inline vec3 inverseDirection(vec3 direction) {
    const float tiny = 1e-18f;
    const float x = abs(direction.x) > tiny ? direction.x : (direction.x < 0.0f ? -tiny : tiny);
    const float y = abs(direction.y) > tiny ? direction.y : (direction.y < 0.0f ? -tiny : tiny);
    const float z = abs(direction.z) > tiny ? direction.z : (direction.z < 0.0f ? -tiny : tiny);
    return vec3(1.0f / x, 1.0f / y, 1.0f / z);
}

// Does the ray's interval [tMin, tMax] meet the box? The far end is widened by what rounding can take away (Ize,
// "Robust BVH Ray Traversal", 2013), so that a flat box is not missed. `entry` is where the ray comes in.
inline bool intersectBox(vec3 origin, vec3 inverse, float tMin, float tMax, vec3 boxMin, vec3 boxMax,
                         OUT(float) entry) {
    const vec3 t0 = (boxMin - origin) * inverse;
    const vec3 t1 = (boxMax - origin) * inverse;
    const vec3 nearest = min(t0, t1);
    const vec3 farthest = max(t0, t1);
    entry = max(max(nearest.x, nearest.y), max(nearest.z, tMin));
    const float leave = min(farthest.x, min(farthest.y, farthest.z)) * 1.0000004f;
    return entry <= min(leave, tMax);
}

SHARED_END
