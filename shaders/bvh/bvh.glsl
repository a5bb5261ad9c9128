// Module: `tracer` (PROVIDES_TRACER) or `hits` (PROVIDES_HITS) through a bounding volume hierarchy. Layout: shared/bvh.h;
// the CPU mirror is framework/scene/bvh_trace.cpp.
#include "lib/tracer.glsl"
#include "lib/scene.glsl"
#include "lib/iterations.glsl"
#include "shared/bvh.h"
#include "shared/ray.h"
#include "shared/triangle.h"

layout(rgba32ui) uniform readonly uimageBuffer M(nodes);
layout(rgba32ui) uniform readonly uimageBuffer M(triangles);

void M(aim)(inout Ray ray) {}

void M(triangleAt)(uint index, out vec3 p0, out vec3 p1, out vec3 p2, out uvec3 ids) {
    uvec4 a = imageLoad(M(triangles), int(3u * index));
    uvec4 b = imageLoad(M(triangles), int(3u * index + 1u));
    uvec4 c = imageLoad(M(triangles), int(3u * index + 2u));
    p0 = uintBitsToFloat(a.xyz);
    p1 = uintBitsToFloat(b.xyz);
    p2 = uintBitsToFloat(c.xyz);
    ids = uvec3(a.w, b.w, c.w);
}

// Meets both children of an inner node; `near` is the one to go to first, `far` the one to keep, leaves of no triangle
// where nothing was met.
void M(children)(uint node, vec3 origin, vec3 inverse, float tMin, float tMax, out uint near, out uint far, out float farEntry) {
    uvec4 a = imageLoad(M(nodes), int(4u * node));
    uvec4 b = imageLoad(M(nodes), int(4u * node + 1u));
    uvec4 c = imageLoad(M(nodes), int(4u * node + 2u));
    uvec4 d = imageLoad(M(nodes), int(4u * node + 3u));
    float left, right;
    bool meetsLeft = intersectBox(origin, inverse, tMin, tMax, uintBitsToFloat(a.xyz), uintBitsToFloat(b.xyz), left);
    bool meetsRight = intersectBox(origin, inverse, tMin, tMax, uintBitsToFloat(c.xyz), uintBitsToFloat(d.xyz), right);
    uint leftReference = meetsLeft ? a.w : bvhLeaf(0u, 0u);
    uint rightReference = meetsRight ? c.w : bvhLeaf(0u, 0u);
    bool leftFirst = meetsLeft && (!meetsRight || left <= right);
    near = leftFirst ? leftReference : rightReference;
    far = leftFirst ? rightReference : leftReference;
    farEntry = leftFirst ? right : left;
}

#ifdef PROVIDES_TRACER

// The nearest hit, or with `stopAtFirst` whichever is found first. Inner nodes are walked in one loop and a leaf's
// triangles tested in another: on a driver that runs both sides of every branch for all lanes, a loop is the only thing
// that can be left, and a triangle test in the walk would be paid at every node.
bool M(traverse)(Ray ray, bool stopAtFirst, out float t, out vec2 barycentrics, out uint triangle) {
    vec3 origin = offFace(ray.origin, ray.normal);
    vec3 inverse = inverseDirection(ray.direction);
    TriangleRay sheared = triangleRay(origin, ray.direction);
    uint references[bvhStackSize];
    float entries[bvhStackSize];
    int size = 0;
    uint reference = 0u;
    float tMax = ray.tMax;
    bool found = false;
    triangle = 0xffffffffu;
    t = tMax;
    barycentrics = vec2(0.0);
    while (true) {
        ITERATION;
        while (!bvhIsLeaf(reference)) {
            ITERATION;
            uint far;
            float farEntry;
            M(children)(reference, origin, inverse, ray.tMin, tMax, reference, far, farEntry);
            if (bvhLeafCount(far) > 0u || !bvhIsLeaf(far)) {
                references[size] = far;
                if (!stopAtFirst) entries[size] = farEntry;
                ++size;
            }
        }
        uint at = bvhLeafFirst(reference);
        uint end = at + bvhLeafCount(reference);
        for (; at < end; ++at) {
            ITERATION;
            vec3 p0, p1, p2;
            uvec3 ids;
            M(triangleAt)(at, p0, p1, p2, ids);
            TriangleHit hit;
            bool met = intersectTriangle(sheared, ray.tMin, tMax, p0, p1, p2, hit);
#ifdef MATERIAL_MASKED
            if (met && ids.z >= 2u) met = sceneCovers(ids.x, vec2(hit.u, hit.v));
#endif
            // Among hits at one distance the lowest triangle counts, so that the order of the walk does not.
            if (met && (!found || hit.t < t || ids.x < triangle)) {
                found = true;
                t = hit.t;
                tMax = hit.t;
                barycentrics = vec2(hit.u, hit.v);
                triangle = ids.x;
                if (stopAtFirst) break;
            }
        }
        if (stopAtFirst && found) break;
        if (stopAtFirst) {
            --size;
        } else {
            do { --size; } while (size >= 0 && entries[max(size, 0)] > tMax);
        }
        if (size < 0) break;
        reference = references[size];
    }
    return found;
}

bool M(anyHit)(Ray ray) {
    float t;
    vec2 barycentrics;
    uint triangle;
    return M(traverse)(ray, true, t, barycentrics, triangle);
}

#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    float t;
    vec2 barycentrics;
    uint triangle;
    bool found = M(traverse)(ray, false, t, barycentrics, triangle);
    hit = Hit(t, 0.0, 0u, uvec2(triangle, packUnorm2x16(barycentrics)));
    return found;
}
#endif

#ifdef REQUESTS_SURFACE
Surface M(surface)(Ray ray, Hit hit) { return sceneSurface(hit.id.x, unpackUnorm2x16(hit.id.y), ray.direction); }
#endif

#endif // PROVIDES_TRACER

#ifdef PROVIDES_HITS

void M(all)(Ray ray) {
    vec3 origin = offFace(ray.origin, ray.normal);
    vec3 inverse = inverseDirection(ray.direction);
    TriangleRay sheared = triangleRay(origin, ray.direction);
    uint references[bvhStackSize];
    int size = 0;
    uint reference = 0u;
    bool stopped = false;
    while (!stopped) {
        ITERATION;
        while (!bvhIsLeaf(reference)) {
            ITERATION;
            uint far;
            float farEntry;
            M(children)(reference, origin, inverse, ray.tMin, ray.tMax, reference, far, farEntry);
            if (bvhLeafCount(far) > 0u || !bvhIsLeaf(far)) references[size++] = far;
        }
        uint at = bvhLeafFirst(reference);
        uint end = at + bvhLeafCount(reference);
        for (; at < end; ++at) {
            ITERATION;
            vec3 p0, p1, p2;
            uvec3 ids;
            M(triangleAt)(at, p0, p1, p2, ids);
            TriangleHit hit;
            bool met = intersectTriangle(sheared, ray.tMin, ray.tMax, p0, p1, p2, hit);
#ifdef MATERIAL_MASKED
            if (met && ids.z >= 2u) met = sceneCovers(ids.x, vec2(hit.u, hit.v));
#endif
            if (met) stopped = M(visit)(ray, Hit(hit.t, 0.0, 0u, uvec2(ids.x, packUnorm2x16(vec2(hit.u, hit.v)))));
            if (stopped) break;
        }
        if (size == 0) break;
        reference = references[--size];
    }
}

#endif // PROVIDES_HITS
