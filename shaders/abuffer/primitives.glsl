// Module: `tracer` (PROVIDES_TRACER) or `hits` (PROVIDES_HITS) through the primitives of an A-buffer (Vardis, Vasilakis,
// Papaioannou, "DIRT: Deferred Image-based Ray Tracing", HPG 2016). A ray passes the pixels of the views as it does with
// fragments (abuffer/march.glsl); a record there only says which triangle is worth a test, and the test is that of the
// hierarchy (shared/triangle.h), with the same numbers: hits are the same to the bit.
//
// The paper asks that a hit projects to the pixel in which it was found. Here time says so: what a ray spends in its pixels
// lies end to end. The nearest hit is settled once the ray has passed the pixel in which its time lies; of all hits each is
// handed on in the one pixel in which its time lies.
#include "lib/tracer.glsl"
#include "lib/scene.glsl"
#include "lib/iterations.glsl"
#include "shared/ray.h"
#include "shared/triangle.h"
#include "abuffer/lists.glsl"
#include "abuffer/primitive_lists.glsl"
#include "abuffer/march.glsl"

#ifdef COUNT_EXHAUSTED
layout(std430) buffer M(Exhausted) { uint M(exhausted)[]; };
#endif

layout(r32ui) uniform readonly uimageBuffer M(cells);
layout(rgba32ui) uniform readonly uimageBuffer M(records);
layout(std140) uniform M(CellsView) { ViewData M(view); };

void M(aim)(inout Ray ray) {}

// Iterations of this invocation in all, whatever rays it traces.
uint M(spent) = 0u;

ABufferMarch M(begin)(vec3 origin, Ray ray) {
    vec3 fromEye = origin - M(view).position.xyz;
    uint view = abufferViewAt(M(view), ABUFFER_SHAPE, fromEye, ray.direction, ray.tMin);
    return abufferMarch(M(view), ABUFFER_SHAPE, view, fromEye, ray.direction, ray.tMin, ray.tMax);
}

// The records of the pixel that the ray may meet there: [x, y), which is none where its depths are others.
uvec2 M(recordsAhead)(ABufferMarch march, out vec2 depths, out int firstBucket) {
    // Either end may be off by what a place along the ray is rounded by.
    float doubt = 2e-6 * (abs(march.ray.at.w) + min(max(abs(march.from), abs(march.to)), 1.0e30));
    depths = vec2(min(march.from, march.to) - doubt, max(march.from, march.to) + doubt);
    int pixel = ABUFFER_PIXEL(march.view, march.pixel);
    firstBucket = 0;
#ifdef SKIPPING
    float zMin = uintBitsToFloat(imageLoad(M(cells), pixel * PRIMITIVE_WORDS).r);
    float zMax = uintBitsToFloat(imageLoad(M(cells), pixel * PRIMITIVE_WORDS + 1).r);
    if (zMax < depths.x || zMin > depths.y) return uvec2(0u);
    firstBucket = int(abufferBucket(depths.x, zMin, zMax, uint(BUCKETS)));
    int lastBucket = int(abufferBucket(depths.y, zMin, zMax, uint(BUCKETS)));
#else
    int lastBucket = BUCKETS - 1;
#endif
    return uvec2(imageLoad(M(cells), PRIMITIVE_BEGIN(pixel, firstBucket)).r,
                 imageLoad(M(cells), PRIMITIVE_BEGIN(pixel, lastBucket + 1)).r);
}

// Goes on from record `at` to the next that is worth a test; its triangle. A loop of its own: it is all that can be left early
// on a driver that runs both sides of every branch.
uint M(nextTriangle)(inout uint at, uint end, vec2 depths, out uint bucket) {
    uvec4 record = uvec4(0u);
    for (; at < end; ++at) {
        ITERATION;
        ++M(spent);
        record = imageLoad(M(records), int(at));
#ifdef SKIPPING
        if (uintBitsToFloat(record.x) <= depths.y && uintBitsToFloat(record.y) >= depths.x) break;
#else
        break;
#endif
    }
    bucket = record.w;
    return record.z;
}

bool M(test)(uint triangle, TriangleRay sheared, float tMin, float tMax, out TriangleHit hit) {
    uvec4 corners = sceneTriangle(triangle);
    bool met = intersectTriangle(sheared, tMin, tMax, scenePosition(corners.x), scenePosition(corners.y),
                                 scenePosition(corners.z), hit);
#ifdef MATERIAL_MASKED
    if (met) met = sceneCovers(triangle, vec2(hit.u, hit.v));
#endif
    return met;
}

#ifdef PROVIDES_TRACER

struct M(Nearest) {
    float t;
    vec2 barycentrics;
    uint triangle; // noTriangle: none, or with `found` the ray was exhausted
    bool found;
};
#define noTriangle 0xffffffffu

// The nearest hit, or with `stopAtFirst` whichever is found first.
M(Nearest) M(traverse)(Ray ray, bool stopAtFirst) {
    vec3 origin = offFace(ray.origin, ray.normal);
    TriangleRay sheared = triangleRay(origin, ray.direction);
    M(Nearest) nearest = M(Nearest)(ray.tMax, vec2(0.0), noTriangle, false);
    bool exhausted = false;
    bool done = false;
    ABufferMarch march = M(begin)(origin, ray);
    while (march.views > 0 && !done) {
        ITERATION;
        ++M(spent);
        abufferEnter(march, M(view), ABUFFER_SHAPE);
        while (march.inside) {
            ITERATION;
            exhausted = ++M(spent) > uint(BUDGET);
            if (exhausted) break;
            abufferAhead(march, 0);
            vec2 depths;
            int firstBucket;
            uvec2 range = M(recordsAhead)(march, depths, firstBucket);
            while (range.x < range.y) {
                ITERATION;
                ++M(spent);
                uint bucket;
                uint triangle = M(nextTriangle)(range.x, range.y, depths, bucket);
                if (range.x == range.y) break;
                ++range.x;
                TriangleHit hit;
                // Among hits at one distance the lowest triangle counts.
                if (M(test)(triangle, sheared, ray.tMin, nearest.t, hit) &&
                    (!nearest.found || hit.t < nearest.t || triangle < nearest.triangle))
                    nearest = M(Nearest)(hit.t, vec2(hit.u, hit.v), triangle, true);
                if (stopAtFirst && nearest.found) break;
            }
            done = nearest.found && (stopAtFirst || nearest.t < march.next);
            if (done) break;
            abufferCross(march);
        }
        done = done || exhausted;
        if (!done) abufferTurn(march, ABUFFER_SHAPE);
    }
#ifdef COUNT_EXHAUSTED
    atomicAdd(M(exhausted)[0], 1u);
    if (exhausted) atomicAdd(M(exhausted)[1], 1u);
#endif
    // It ends there as if it had hit something.
    if (exhausted && !nearest.found) nearest = M(Nearest)(march.t, vec2(0.0), noTriangle, true);
    return nearest;
}

bool M(anyHit)(Ray ray) { return M(traverse)(ray, true).found; }

#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    M(Nearest) nearest = M(traverse)(ray, false);
    hit = Hit(nearest.t, 0.0, 0u, uvec2(nearest.triangle, packUnorm2x16(nearest.barycentrics)));
    return nearest.found;
}
#endif

#ifdef REQUESTS_SURFACE
Surface M(surface)(Ray ray, Hit hit) {
    if (hit.id.x == noTriangle) return facingSurface(ray, hit);
    return sceneSurface(hit.id.x, unpackUnorm2x16(hit.id.y), ray.direction);
}
#endif

#endif // PROVIDES_TRACER
