// Module: `tracer` (PROVIDES_TRACER) or `hits` (PROVIDES_HITS) through the fragments of an A-buffer: a ray goes from
// pixel to pixel and from view to view (abuffer/march.glsl) and meets the fragments whose depth lies in the interval of
// depths that it has in the pixel (Vardis, Vasilakis, Papaioannou 2016, section 3.4). The interval is half open, and
// widened on both sides by half of THICKNESS pixel footprints: a surface is kept at the depth of its pixel's centre,
// and a ray that crosses it elsewhere in the pixel would pass before it in one pixel and behind it in the next (of all
// hits, then, a surface that lies askew may be met in both). Skipping tests the widened interval, so that it changes no
// hit. With SINGLE_LAYER only the nearest fragment of a pixel is there.
//
// PLANES: fragments know their triangles' planes over the pixel. The interval only says which fragments are looked at, and
// what is met is the plane, where the ray is in the pixel. The paper has no such thing: section 4.2 names thin and
// grazing surfaces as what a thickness cannot be right for.
//
// Once an invocation has spent BUDGET iterations, whatever rays it traced, the ray is exhausted: it ends there as if it
// had hit something, and is counted with COUNT_EXHAUSTED.
#include "lib/tracer.glsl"
#include "lib/scene.glsl"
#include "lib/iterations.glsl"
#include "abuffer/lists.glsl"
#include "abuffer/march.glsl"
#ifdef REQUESTS_SURFACE
#include "abuffer/nearest.glsl"
#endif

#ifdef COUNT_EXHAUSTED
layout(std430) buffer M(Exhausted) { uint M(exhausted)[]; };
#endif

void M(aim)(inout Ray ray) {}

layout(r32ui) uniform readonly uimageBuffer M(pixels);
layout(r32ui) uniform readonly uimageBuffer M(nodes);
#if defined(REQUESTS_SURFACE) && defined(DECOUPLED)
layout(r32ui) uniform readonly uimageBuffer M(data);
#endif
#if LEVELS > 1
layout(r32ui) uniform readonly uimageBuffer M(block_bounds);
#endif
layout(std140) uniform M(PixelsView) { ViewData M(view); };

// Iterations of this invocation in all, whatever rays it traces.
uint M(spent) = 0u;

float M(depthOf)(uint node) { return uintBitsToFloat(imageLoad(M(nodes), NODE_AT(node, 0)).r); }
uint M(nextOf)(uint node) { return imageLoad(M(nodes), NODE_AT(node, 1)).r; }
#ifdef TWO_WAYS
uint M(previousOf)(uint node) { return imageLoad(M(nodes), NODE_AT(node, 2)).r; }
#endif

uint M(headOf)(int pixel, int bucket) { return imageLoad(M(pixels), pixel * PIXEL_WORDS + HEAD_WORD(bucket)).r; }

#ifdef SINGLE_LAYER
uint M(nearestOf)(int pixel) {
#ifdef SB
    return imageLoad(M(pixels), pixel * PIXEL_WORDS + 1).r > 0u ? imageLoad(M(pixels), pixel * PIXEL_WORDS).r : 0u;
#else
    uint head = 0u;
    for (int bucket = 0; bucket < BUCKETS && head == 0u; ++bucket) {
        ITERATION;
        ++M(spent);
        head = M(headOf)(pixel, bucket);
    }
    return head;
#endif
}
#endif

// Of a plain list the walk's first node says as much as bounds could, and so nothing is looked at before it.
#if defined(SKIPPING) && (LEVELS > 1 || !defined(LL))
#define LOOKS_AHEAD
#endif

// By which part of its depth a pixel's fragments may be nearer or farther elsewhere in the pixel.
float M(spreadOf)(int pixel) {
#ifdef PLANES
    return uintBitsToFloat(imageLoad(M(pixels), pixel * PIXEL_WORDS + SPREAD_WORD).r);
#else
    return 0.0;
#endif
}

#if defined(LOOKS_AHEAD) && LEVELS == 1
// Between which depths a pixel's fragments lie, as its words say.
vec2 M(boundsOf)(int pixel) {
    int words = pixel * PIXEL_WORDS;
    uint a = imageLoad(M(pixels), words).r;
    uint b = imageLoad(M(pixels), words + 1).r;
#if defined(BUCKETED)
    vec2 bounds = uintBitsToFloat(uvec2(a, b));
#elif defined(SB)
    vec2 bounds = b > 0u ? vec2(M(depthOf)(a), M(depthOf)(a + b - 1u)) : vec2(3.0e38, -3.0e38);
#else
    vec2 bounds = a > 0u ? vec2(M(depthOf)(a), M(depthOf)(b)) : vec2(3.0e38, -3.0e38);
#endif
    return bounds.x <= bounds.y ? abufferWiden(bounds, M(spreadOf)(pixel)) : bounds;
}
#endif

// By how much a fragment may be off its depth, either way.
float M(halfThickness)(ABufferMarch march) {
    float depth = march.level > 0 ? max(march.from, march.to) : min(march.from, march.to);
    return 0.5 * THICKNESS * abufferFootprint(M(view), ABUFFER_SHAPE, march.view, depth);
}

// The depths that a fragment must have to be met in the ray's pixel: [x, y).
vec2 M(depthsAhead)(ABufferMarch march) {
    float pad = M(halfThickness)(march);
    return vec2(min(march.from, march.to) - pad, max(march.from, march.to) + pad);
}

#include <part:abuffer/ahead.glsl>
#include <part:abuffer/in_pixel.glsl>

ABufferMarch M(begin)(Ray ray) {
    vec3 fromEye = ray.origin - M(view).position.xyz;
    uint view = abufferViewAt(M(view), ABUFFER_SHAPE, fromEye, ray.direction, ray.tMin);
    // Off the surface by what its fragments may be off their places.
    float depth = abufferSeen(M(view), NEAR_PLANE, view, fromEye, 1.0).w;
    fromEye += ray.normal * (OFFSET * abufferFootprint(M(view), ABUFFER_SHAPE, view, max(depth, 0.0)));
    return abufferMarch(M(view), ABUFFER_SHAPE, view, fromEye, ray.direction, ray.tMin, ray.tMax);
}

#ifdef PROVIDES_TRACER

bool M(traverse)(Ray ray, out M(Found) found) {
    ABufferMarch march = M(begin)(ray);
    found = M(Found)(0u, ray.tMax, 0.0, 0u, false);
    while (march.views > 0) {
        ITERATION;
        ++M(spent);
        abufferEnter(march, M(view), ABUFFER_SHAPE, M(steps));
        while (M(goesOn)(march)) {
            ITERATION;
            found.exhausted = ++M(spent) > uint(BUDGET);
            if (found.exhausted || M(meets)(march, found)) break;
            abufferCross(march, M(steps));
        }
        if (found.exhausted || found.node != 0u) break;
        abufferTurn(march, ABUFFER_SHAPE);
    }
    M(countRay)(found.exhausted);
    if (found.exhausted) found.t = march.t;
    return found.node != 0u || found.exhausted;
}

bool M(anyHit)(Ray ray) {
    M(Found) found;
    return M(traverse)(ray, found);
}

#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    M(Found) found;
    bool met = M(traverse)(ray, found);
    hit = met ? Hit(found.t, found.error, found.view, uvec2(found.node, 0u)) : noHit;
    return met;
}
#endif

#ifdef REQUESTS_SURFACE
// The triangle's surface where it is nearest to the hit; of an exhausted ray one that faces it.
Surface M(surface)(Ray ray, Hit hit) {
    if (hit.id.x == 0u) return facingSurface(ray, hit);
#if defined(DECOUPLED) && defined(SB)
    uint triangle = imageLoad(M(data), int(imageLoad(M(nodes), NODE_AT(hit.id.x, 1)).r) - 1).r;
#elif defined(DECOUPLED)
    uint triangle = imageLoad(M(data), int(hit.id.x) - 1).r;
#else
    uint triangle = imageLoad(M(nodes), NODE_AT(hit.id.x, TRIANGLE_WORD)).r;
#endif
    vec2 barycentrics = abufferNearest(triangle, ray.origin + hit.t * ray.direction);
    return sceneSurface(triangle, barycentrics, ray.direction);
}
#endif

#endif // PROVIDES_TRACER

#ifdef PROVIDES_HITS

void M(all)(Ray ray) {
    ABufferMarch march = M(begin)(ray);
    bool stopped = false;
    bool exhausted = false;
    while (march.views > 0 && !stopped) {
        ITERATION;
        ++M(spent);
        abufferEnter(march, M(view), ABUFFER_SHAPE, M(steps));
        while (M(goesOn)(march)) {
            ITERATION;
            exhausted = ++M(spent) > uint(BUDGET);
            stopped = exhausted || M(handAll)(ray, march) || march.next > ray.tMax;
            if (stopped) break;
            abufferCross(march, M(steps));
        }
        if (!stopped) abufferTurn(march, ABUFFER_SHAPE);
    }
    M(countRay)(exhausted);
}

#endif // PROVIDES_HITS
