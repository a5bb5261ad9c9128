// Module: `tracer` (PROVIDES_TRACER) or `hits` (PROVIDES_HITS) through the primitives of an A-buffer (Vardis,
// Vasilakis, Papaioannou, "DIRT: Deferred Image-based Ray Tracing", HPG 2016). A ray passes the pixels of the views as
// it does with fragments (abuffer/march.glsl); a record there only says which triangle is worth a test, and the test is
// that of the hierarchy (shared/triangle.h), with the same numbers: hits are the same to the bit.
//
// The paper asks that a hit projects to the pixel in which it was found. Here time says so: what a ray spends in its
// pixels lies end to end. The nearest hit is settled once the ray has passed the pixel in which its time lies; of all
// hits each is handed on in the one pixel in which its time lies.
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
#if LEVELS > 1
layout(r32ui) uniform readonly uimageBuffer M(block_bounds);
#endif
layout(std140) uniform M(CellsView) { ViewData M(view); };

void M(aim)(inout Ray ray) {}

// Iterations of this invocation in all, whatever rays it traces.
uint M(spent) = 0u;

ABufferMarch M(begin)(vec3 origin, Ray ray) {
    vec3 fromEye = origin - M(view).position.xyz;
    uint view = abufferViewAt(M(view), ABUFFER_SHAPE, fromEye, ray.direction, ray.tMin);
    return abufferMarch(M(view), ABUFFER_SHAPE, view, fromEye, ray.direction, ray.tMin, ray.tMax);
}

// The depths that the ray has ahead, either end off by what a place along it may be rounded by.
vec2 M(depthsAhead)(ABufferMarch march) {
    float doubt = 2e-6 * (abs(march.ray.at.w) + min(max(abs(march.from), abs(march.to)), 1.0e30));
    return vec2(min(march.from, march.to) - doubt, max(march.from, march.to) + doubt);
}

vec2 M(boundsOf)(int pixel) {
    return uintBitsToFloat(uvec2(imageLoad(M(cells), pixel * PRIMITIVE_WORDS).r, imageLoad(M(cells), pixel * PRIMITIVE_WORDS + 1).r));
}

#ifdef SKIPPING
#define LOOKS_AHEAD
#endif
#include <part:abuffer/ahead.glsl>

// The buckets of the ray's pixel that it may meet something in: first and last.
ivec2 M(bucketsAhead)(int pixel, vec2 depths) {
#ifdef SKIPPING
    vec2 bounds = M(boundsOf)(pixel);
    return ivec2(abufferBucket(depths.x, bounds.x, bounds.y, uint(BUCKETS)), abufferBucket(depths.y, bounds.x, bounds.y, uint(BUCKETS)));
#else
    return ivec2(0, BUCKETS - 1);
#endif
}

// Goes on from record `at` to the next that is worth a test; its triangle. A loop of its own: it is all that can be
// left early on a driver that runs both sides of every branch.
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
        abufferEnter(march, M(view), ABUFFER_SHAPE, M(steps));
        while (M(goesOn)(march)) {
            ITERATION;
            exhausted = ++M(spent) > uint(BUDGET);
            if (exhausted) break;
            vec2 depths = M(depthsAhead)(march);
            int pixel = ABUFFER_PIXEL(march.view, march.pixel);
            ivec2 buckets = M(bucketsAhead)(pixel, depths);
            uint at = imageLoad(M(cells), PRIMITIVE_BEGIN(pixel, buckets.x)).r;
            uint end = imageLoad(M(cells), PRIMITIVE_BEGIN(pixel, buckets.y + 1)).r;
            while (at < end) {
                ITERATION;
                ++M(spent);
                uint firstBucket;
                uint triangle = M(nextTriangle)(at, end, depths, firstBucket);
                if (at == end) break;
                ++at;
                TriangleHit hit;
                // Among hits at one distance the lowest triangle counts.
                if (M(test)(triangle, sheared, ray.tMin, nearest.t, hit) &&
                    (!nearest.found || hit.t < nearest.t || triangle < nearest.triangle))
                    nearest = M(Nearest)(hit.t, vec2(hit.u, hit.v), triangle, true);
                if (stopAtFirst && nearest.found) break;
            }
            done = nearest.found && (stopAtFirst || nearest.t < march.next);
            if (done) break;
            abufferCross(march, M(steps));
        }
        done = done || exhausted;
        if (!done) {
            // Where the rest of the view was skipped the hit may lie behind.
            done = nearest.found && nearest.t < march.t;
            abufferTurn(march, ABUFFER_SHAPE);
        }
    }
    M(countRay)(exhausted);
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

#ifdef PROVIDES_HITS

void M(all)(Ray ray) {
    vec3 origin = offFace(ray.origin, ray.normal);
    TriangleRay sheared = triangleRay(origin, ray.direction);
    bool stopped = false;
    bool exhausted = false;
    ABufferMarch march = M(begin)(origin, ray);
    while (march.views > 0 && !stopped) {
        ITERATION;
        ++M(spent);
        abufferEnter(march, M(view), ABUFFER_SHAPE, M(steps));
        while (M(goesOn)(march)) {
            ITERATION;
            exhausted = ++M(spent) > uint(BUDGET);
            stopped = exhausted;
            vec2 depths = M(depthsAhead)(march);
            int pixel = ABUFFER_PIXEL(march.view, march.pixel);
            ivec2 buckets = M(bucketsAhead)(pixel, depths);
            for (int bucket = buckets.x; bucket <= buckets.y && !stopped; ++bucket) {
                ITERATION;
                ++M(spent);
                uint at = imageLoad(M(cells), PRIMITIVE_BEGIN(pixel, bucket)).r;
                uint end = imageLoad(M(cells), PRIMITIVE_BEGIN(pixel, bucket + 1)).r;
                while (at < end && !stopped) {
                    ITERATION;
                    ++M(spent);
                    uint firstBucket;
                    uint triangle = M(nextTriangle)(at, end, depths, firstBucket);
                    if (at == end) break;
                    ++at;
                    TriangleHit hit;
                    bool met = M(test)(triangle, sheared, ray.tMin, ray.tMax, hit);
                    // In the first of its buckets that is looked at, in the pixel in which its time lies.
                    bool here = bucket == max(buckets.x, int(firstBucket)) && hit.t >= march.t &&
                                (hit.t < march.next || march.next >= march.tMax);
                    if (met && here)
                        stopped = M(visit)(ray, Hit(hit.t, 0.0, 0u, uvec2(triangle, packUnorm2x16(vec2(hit.u, hit.v)))));
                }
            }
            stopped = stopped || march.next > ray.tMax;
            if (stopped) break;
            abufferCross(march, M(steps));
        }
        if (!stopped) abufferTurn(march, ABUFFER_SHAPE);
    }
    M(countRay)(exhausted);
}

#endif // PROVIDES_HITS
