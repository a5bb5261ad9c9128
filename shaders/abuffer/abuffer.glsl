// Module: `tracer` (PROVIDES_TRACER) or `hits` (PROVIDES_HITS) through the fragments of an A-buffer: a ray goes from
// pixel to pixel and from view to view (abuffer/march.glsl) and meets the fragments whose depth lies in the interval of
// depths that it has in the pixel (Vardis, Vasilakis, Papaioannou 2016, section 3.4). The interval is half open, and
// widened on both sides by half of THICKNESS pixel footprints: a surface is kept at the depth of its pixel's centre,
// and a ray that crosses it elsewhere in the pixel would pass before it in one pixel and behind it in the next (of all
// hits, then, a surface that lies askew may be met in both). Skipping tests the widened interval, so that it changes no
// hit. With SINGLE_LAYER only the nearest fragment of a pixel is there.
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

#if defined(LOOKS_AHEAD) && LEVELS == 1
// Between which depths a pixel's fragments lie, as its words say.
vec2 M(boundsOf)(int pixel) {
    int words = pixel * PIXEL_WORDS;
    uint a = imageLoad(M(pixels), words).r;
    uint b = imageLoad(M(pixels), words + 1).r;
#if defined(BUCKETED)
    return uintBitsToFloat(uvec2(a, b));
#elif defined(SB)
    return b > 0u ? vec2(M(depthOf)(a), M(depthOf)(a + b - 1u)) : vec2(3.0e38, -3.0e38);
#else
    return a > 0u ? vec2(M(depthOf)(a), M(depthOf)(b)) : vec2(3.0e38, -3.0e38);
#endif
}
#endif

#ifdef PROVIDES_TRACER

// The fragment of a list of linked nodes that a ray meets first, whose depths in the pixel are [low, high): 0 if there
// is none.
uint M(inList)(uint head, uint tail, float low, float high, bool away) {
    uint found = 0u;
#ifdef TWO_WAYS
    if (!away) {
        for (uint node = tail; node != 0u; node = M(previousOf)(node)) {
            ITERATION;
            ++M(spent);
            float z = M(depthOf)(node);
            if (z < low) break;
            if (z < high) {
                found = node;
                break;
            }
        }
        return found;
    }
#endif
    for (uint node = head; node != 0u; node = M(nextOf)(node)) {
        ITERATION;
        ++M(spent);
        float z = M(depthOf)(node);
        if (z >= high) break;
        if (z >= low) {
            found = node;
            if (away) break; // coming nearer, the last one is met first
        }
    }
    return found;
}

// The same of a pixel.
uint M(inPixel)(int pixel, float low, float high, bool away) {
    int words = pixel * PIXEL_WORDS;
#if defined(SINGLE_LAYER)
    uint nearest = M(nearestOf)(pixel);
    float depth = nearest != 0u ? M(depthOf)(nearest) : 0.0;
    return nearest != 0u && depth >= low && depth < high ? nearest : 0u;
#elif defined(SB)
    uint first = imageLoad(M(pixels), words).r;
    int count = int(imageLoad(M(pixels), words + 1).r);
    // The first of them that is at least `low`, or coming nearer the last that is below `high`.
    int begin = 0;
    if (count > 16) {
        float wanted = away ? low : high;
        int end = count;
        while (begin < end) {
            ITERATION;
            int middle = (begin + end) / 2;
            if (M(depthOf)(first + uint(middle)) < wanted) {
                begin = middle + 1;
            } else {
                end = middle;
            }
        }
    } else {
        for (; begin < count; ++begin) {
            ITERATION;
            if (M(depthOf)(first + uint(begin)) >= (away ? low : high)) break;
        }
    }
    if (!away) --begin;
    if (begin < 0 || begin >= count) return 0u;
    float z = M(depthOf)(first + uint(begin));
    return z >= low && z < high ? first + uint(begin) : 0u;
#elif defined(BUCKETED)
    float zMin = uintBitsToFloat(imageLoad(M(pixels), words).r);
    float zMax = uintBitsToFloat(imageLoad(M(pixels), words + 1).r);
#ifdef SKIPPING
#ifdef SHIFTED
    // Boundaries lie where the buckets begin, one after the other: a bucket ends at the next one's first depth at
    // the latest.
    int from = 0;
    int to = BUCKETS - 1;
    for (int bucket = 1; bucket <= to; ++bucket) {
        ITERATION;
        uint head = imageLoad(M(pixels), words + HEAD_WORD(bucket)).r;
        float z = head != 0u ? M(depthOf)(head) : 0.0;
        if (head == 0u || z >= high) {
            to = bucket - 1;
        } else if (z < low) {
            from = bucket;
        }
    }
#else
    int from = int(abufferBucket(low, zMin, zMax, uint(BUCKETS)));
    int to = int(abufferBucket(high, zMin, zMax, uint(BUCKETS)));
#endif
#else
    int from = 0;
    int to = BUCKETS - 1;
#endif
    uint found = 0u;
    int buckets = to - from + 1;
    for (int i = 0; i < buckets && found == 0u; ++i) {
        ITERATION;
        ++M(spent);
        int bucket = away ? from + i : to - i;
        uint head = M(headOf)(pixel, bucket);
#ifdef TWO_WAYS
        uint tail = imageLoad(M(pixels), words + TAIL_WORD(bucket)).r;
#else
        uint tail = 0u;
#endif
        found = M(inList)(head, tail, low, high, away);
    }
    return found;
#else
    uint head = M(headOf)(pixel, 0);
#ifdef TWO_WAYS
    uint tail = imageLoad(M(pixels), words + TAIL_WORD(0)).r;
#else
    uint tail = 0u;
#endif
    return M(inList)(head, tail, low, high, away);
#endif
}

#endif

// ---- rays

const ABufferSteps M(steps) = ABufferSteps(LEVELS, SAMPLES);

void M(countRay)(bool exhausted) {
#ifdef COUNT_EXHAUSTED
    atomicAdd(M(exhausted)[0], 1u);
    if (exhausted) atomicAdd(M(exhausted)[1], 1u);
#endif
}

// The depths that a fragment must have to be met in the ray's pixel: [x, y), widened by `pad` on both sides.
vec2 M(depthsAhead)(ABufferMarch march, out float pad) {
    vec2 depths = vec2(min(march.from, march.to), max(march.from, march.to));
    pad = 0.5 * THICKNESS * abufferFootprint(M(view), ABUFFER_SHAPE, march.view, march.level > 0 ? depths.y : depths.x);
    return depths + vec2(-pad, pad);
}

// When a ray meets a fragment of this depth in its pixel.
float M(timeOf)(ABufferMarch march, float z) {
    float part = march.to != march.from ? clamp((z - march.from) / (march.to - march.from), 0.0, 1.0) : 0.5;
    return march.next < rayInfinity ? mix(march.t, march.next, part)
                                    : march.t + max(z - march.from, 0.0) / abs(march.ray.add.w);
}

ABufferMarch M(begin)(Ray ray) {
    vec3 fromEye = ray.origin - M(view).position.xyz;
    uint view = abufferViewAt(M(view), ABUFFER_SHAPE, fromEye, ray.direction, ray.tMin);
    // Off the surface by what its fragments may be off their places.
    float depth = abufferSeen(M(view), NEAR_PLANE, view, fromEye, 1.0).w;
    fromEye += ray.normal * (OFFSET * abufferFootprint(M(view), ABUFFER_SHAPE, view, max(depth, 0.0)));
    return abufferMarch(M(view), ABUFFER_SHAPE, view, fromEye, ray.direction, ray.tMin, ray.tMax);
}

// To the next pixel that has fragments where the ray is; false if the view is left before. A loop of its own, and
// nothing but the bounds in it: on a driver that runs both sides of every branch a loop is all that can be left early.
bool M(goesOn)(inout ABufferMarch march) {
    while (march.inside) {
        ITERATION;
        ++M(spent);
        abufferAhead(march, M(steps));
#ifdef LOOKS_AHEAD
        float pad;
        vec2 depths = M(depthsAhead)(march, pad);
#if LEVELS > 1
        int block = 2 * abufferBlock(march, ABUFFER_SHAPE, MAIN_SIZE);
        vec2 bounds = uintBitsToFloat(
            uvec2(imageLoad(M(block_bounds), block).r, imageLoad(M(block_bounds), block + 1).r));
#else
        vec2 bounds = M(boundsOf)(ABUFFER_PIXEL(march.view, march.pixel));
#endif
        bool skips = bounds.y < depths.x || bounds.x >= depths.y;
        if (!skips && march.level == 0) break;
        if (M(spent) > uint(BUDGET)) break;
        if (skips) {
            abufferCross(march, M(steps));
        } else {
            --march.level;
        }
#else
        break;
#endif
    }
    return march.inside;
}

#ifdef PROVIDES_TRACER

struct M(Found) {
    uint node; // 0: nothing, or the ray was exhausted
    float t;
    float error;
    uint view;
    bool exhausted;
};

// What the ray meets first in its pixel.
bool M(meets)(ABufferMarch march, inout M(Found) found) {
    float pad;
    vec2 depths = M(depthsAhead)(march, pad);
    found.node = M(inPixel)(ABUFFER_PIXEL(march.view, march.pixel), depths.x, depths.y, march.ray.add.w > 0.0);
    if (found.node == 0u) return false;
    float z = M(depthOf)(found.node);
    found.t = M(timeOf)(march, z);
    found.error = 0.5 * abufferFootprint(M(view), ABUFFER_SHAPE, march.view, z) + pad;
    found.view = march.view;
    return true;
}

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
    uint triangle = imageLoad(M(nodes), NODE_AT(hit.id.x, NODE_WORDS - 1)).r;
#endif
    vec2 barycentrics = abufferNearest(triangle, ray.origin + hit.t * ray.direction);
    return sceneSurface(triangle, barycentrics, ray.direction);
}
#endif

#endif // PROVIDES_TRACER

#ifdef PROVIDES_HITS

// Hands on one fragment; true stops.
bool M(hand)(inout Ray ray, ABufferMarch march, uint node, float z, float pad) {
    float t = M(timeOf)(march, z);
    if (t < ray.tMin || t > ray.tMax) return false;
    float error = 0.5 * abufferFootprint(M(view), ABUFFER_SHAPE, march.view, z) + pad;
    return M(visit)(ray, Hit(t, error, march.view, uvec2(node, 0u)));
}

// Hands on all fragments of the ray's pixel whose depths it has there.
bool M(handAll)(inout Ray ray, ABufferMarch march) {
    float pad;
    vec2 depths = M(depthsAhead)(march, pad);
    int pixel = ABUFFER_PIXEL(march.view, march.pixel);
#if defined(SINGLE_LAYER)
    uint nearest = M(nearestOf)(pixel);
    float depth = nearest != 0u ? M(depthOf)(nearest) : 3.0e38;
    return nearest != 0u && depth >= depths.x && depth < depths.y && M(hand)(ray, march, nearest, depth, pad);
#elif defined(SB)
    uint first = imageLoad(M(pixels), pixel * PIXEL_WORDS).r;
    uint end = first + imageLoad(M(pixels), pixel * PIXEL_WORDS + 1).r;
    for (uint node = first; node < end; ++node) {
        ITERATION;
        ++M(spent);
        float z = M(depthOf)(node);
        if (z >= depths.y) break;
        if (z >= depths.x && M(hand)(ray, march, node, z, pad)) return true;
    }
#else
    for (int bucket = 0; bucket < BUCKETS; ++bucket) {
        ITERATION;
        ++M(spent);
        for (uint node = M(headOf)(pixel, bucket); node != 0u; node = M(nextOf)(node)) {
            ITERATION;
            ++M(spent);
            float z = M(depthOf)(node);
            if (z >= depths.y) break;
            if (z >= depths.x && M(hand)(ray, march, node, z, pad)) return true;
        }
    }
#endif
    return false;
}

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
