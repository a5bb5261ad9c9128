// Ray against triangle and box, the same formulas on both sides of the C++/GLSL border.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

#ifdef __cplusplus
using glm::floatBitsToInt, glm::intBitsToFloat;
#endif

struct TriangleHit {
    float t; // distance along the direction
    float u; // barycentric weight of the second vertex
    float v; // and of the third
};

// GLSL's precise, which C++ needs not: both sides are compiled without contraction.
#ifdef __cplusplus
#define UNCONTRACTED
#else
#define UNCONTRACTED precise
#endif

// What a ray's tests have in common: a shear along its largest axis makes that axis of the ray (Woop, Benthin and Wald,
// "Watertight Ray/Triangle Intersection", 2013).
struct TriangleRay {
    vec3 origin;
    vec3 direction;
    vec2 shear;
    uint axis;     // 0 x, 1 y, 2 z
    float inverse; // 1 / the direction's component there
};

// The axis last, the others in turn.
inline vec3 axisLast(vec3 v, uint axis) {
    return axis == 2u ? v : (axis == 0u ? vec3(v.y, v.z, v.x) : vec3(v.z, v.x, v.y));
}

inline TriangleRay triangleRay(vec3 origin, vec3 direction) {
    const float x = abs(direction.x);
    const float y = abs(direction.y);
    const float z = abs(direction.z);
    TriangleRay ray;
    ray.origin = origin;
    ray.direction = direction;
    ray.axis = z >= x && z >= y ? 2u : (x >= y ? 0u : 1u);
    const vec3 along = axisLast(direction, ray.axis);
    ray.shear = vec2(along.x / along.z, along.y / along.z);
    ray.inverse = 1.0f / along.z;
    return ray;
}

// Where a point (relative to the origin) lies beside the ray.
inline vec2 besideRay(TriangleRay ray, vec3 point) {
    const vec3 p = axisLast(point, ray.axis);
    UNCONTRACTED float x = ray.shear.x * p.z;
    UNCONTRACTED float y = ray.shear.y * p.z;
    UNCONTRACTED float dx = p.x - x;
    UNCONTRACTED float dy = p.y - y;
    return vec2(dx, dy);
}

// Twice the signed area of the triangle of the edge from b to c and the ray: its sign tells the side on which the edge
// passes the ray. `side`: that side, in the sign bit, where an edge that goes through the ray passes it as if the ray stood
// a little beside it, towards x and yet less towards y (what rasterizers call the top-left rule). Products are compared,
// not subtracted: rounding keeps their order, and the same edge from c to b has exactly the other side. (A difference of
// different floats has the sign of their order. Signs are kept as words: a CPU driver packs and unpacks booleans.)
inline float edgeArea(vec2 b, vec2 c, OUT(int) side) {
    UNCONTRACTED float p = c.x * b.y;
    UNCONTRACTED float q = c.y * b.x;
    UNCONTRACTED float area = p - q;
    const float beside = c.y != b.y ? c.y - b.y : b.x - c.x;
    side = floatBitsToInt(p != q ? area : beside);
    return area;
}

// Is there an intersection with tMin <= t <= tMax (0 <= tMin), from either side? An edge or vertex that triangles share
// belongs to exactly one of those that meet around the ray: a surface is met once, and no ray slips through. That holds since
// a corner lies at the same place beside the ray for all triangles that share it. Degenerate triangles are missed.
inline bool intersectTriangle(TriangleRay ray, float tMin, float tMax, vec3 p0, vec3 p1, vec3 p2, OUT(TriangleHit) hit) {
    const vec3 a = p0 - ray.origin;
    const vec3 b = p1 - ray.origin;
    const vec3 c = p2 - ray.origin;
    const vec2 a2 = besideRay(ray, a);
    const vec2 b2 = besideRay(ray, b);
    const vec2 c2 = besideRay(ray, c);
    int sideA, sideB, sideC;
    const float wa = edgeArea(b2, c2, sideA);
    const float wb = edgeArea(c2, a2, sideB);
    const float wc = edgeArea(a2, b2, sideC);
    const vec3 normal = cross(b - a, c - a);
    const float slope = dot(normal, ray.direction);
    // On the plane, but no farther off than the corners are: of a triangle seen along its plane the slope is rounding.
    // By bits, which are ordered as the floats are from 0 up; what is told wrongly lies behind the origin either way.
    const vec3 depth = vec3(axisLast(a, ray.axis).z, axisLast(b, ray.axis).z, axisLast(c, ray.axis).z) * ray.inverse;
    const int lowest = min(floatBitsToInt(depth.x), min(floatBitsToInt(depth.y), floatBitsToInt(depth.z)));
    const int highest = max(floatBitsToInt(depth.x), max(floatBitsToInt(depth.y), floatBitsToInt(depth.z)));
    const int plane = max(min(floatBitsToInt(dot(normal, a) / slope), highest), lowest);
    const float t = intBitsToFloat(slope != 0.0f ? plane : lowest);
    const float sum = wa + wb + wc;
    hit.t = t;
    hit.u = wb / sum;
    hit.v = wc / sum;
    const bool inside = ((sideA ^ sideB) | (sideB ^ sideC)) >= 0;
    return inside && sum != 0.0f && t >= tMin && t <= tMax;
}

// 1 / direction with zeros replaced by numbers so small that no slab test notices, but 0 * infinity cannot arise.
inline vec3 inverseDirection(vec3 direction) {
    const float tiny = 1e-18f;
    const float x = abs(direction.x) > tiny ? direction.x : (direction.x < 0.0f ? -tiny : tiny);
    const float y = abs(direction.y) > tiny ? direction.y : (direction.y < 0.0f ? -tiny : tiny);
    const float z = abs(direction.z) > tiny ? direction.z : (direction.z < 0.0f ? -tiny : tiny);
    return vec3(1.0f / x, 1.0f / y, 1.0f / z);
}

// Does the ray's interval [tMin, tMax] meet the box? The far end is widened by what rounding can take away here (Ize,
// "Robust BVH Ray Traversal", 2013) and in the triangle's test, so that a flat box is not missed. `entry` is where the ray comes in.
inline bool intersectBox(vec3 origin, vec3 inverse, float tMin, float tMax, vec3 boxMin, vec3 boxMax,
                         OUT(float) entry) {
    const vec3 t0 = (boxMin - origin) * inverse;
    const vec3 t1 = (boxMax - origin) * inverse;
    const vec3 nearest = min(t0, t1);
    const vec3 farthest = max(t0, t1);
    entry = max(max(nearest.x, nearest.y), max(nearest.z, tMin));
    const float leave = min(farthest.x, min(farthest.y, farthest.z)) * 1.000001f;
    return entry <= min(leave, tMax);
}

SHARED_END
