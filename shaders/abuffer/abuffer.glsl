// The module `tracer` through the fragments of an A-buffer: a ray goes from pixel to pixel and from view to view
// (abuffer/march.glsl) and meets the fragments whose depth lies in the interval of depths that it has in the pixel (Vardis,
// Vasilakis, Papaioannou 2016, section 3.4). The interval is half open, and widened on both sides by half of THICKNESS pixel
// footprints: a surface is kept at the depth of its pixel's centre, and a ray that crosses it elsewhere in the pixel would pass
// before it in one pixel and behind it in the next. Skipping tests the widened interval, so that it changes no hit.
//
// Once an invocation has spent BUDGET iterations, whatever rays it traced, the ray is exhausted: it ends there as if it had hit
// something, and is counted with COUNT_EXHAUSTED.
#include "lib/tracer.glsl"
#include "lib/scene.glsl"
#include "lib/iterations.glsl"
#include "abuffer/lists.glsl"
#include "abuffer/march.glsl"

#ifdef COUNT_EXHAUSTED
layout(std430) buffer M(Exhausted) { uint M(exhausted)[]; };
#endif

void M(aim)(inout Ray ray) {}

#ifdef EMPTY
bool M(anyHit)(Ray ray) { return false; }
#if defined(REQUESTS_CLOSEST) || defined(REQUESTS_SURFACE)
bool M(closestHit)(Ray ray, out Hit hit) {
    hit = noHit;
    return false;
}
#endif
#ifdef REQUESTS_SURFACE
Surface M(surface)(Ray ray, Hit hit) { return facingSurface(ray, hit); }
#endif
#else

layout(r32ui) uniform readonly uimageBuffer M(pixels);
layout(r32ui) uniform readonly uimageBuffer M(nodes);
#if defined(REQUESTS_SURFACE) && defined(DECOUPLED)
layout(r32ui) uniform readonly uimageBuffer M(data);
#endif
layout(std140) uniform M(PixelsView) { ViewData M(view); };

// Iterations of this invocation in all, whatever rays it traces.
uint M(spent) = 0u;

float M(depthOf)(uint node) { return uintBitsToFloat(imageLoad(M(nodes), NODE_AT(node, 0)).r); }
uint M(nextOf)(uint node) { return imageLoad(M(nodes), NODE_AT(node, 1)).r; }
#ifdef TWO_WAYS
uint M(previousOf)(uint node) { return imageLoad(M(nodes), NODE_AT(node, 2)).r; }
#endif

// The fragment of a list of linked nodes that a ray meets first, whose depths in the pixel are [low, high): 0 if there is none.
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
#if defined(SB)
    uint first = imageLoad(M(pixels), words).r;
    int count = int(imageLoad(M(pixels), words + 1).r);
#ifdef SKIPPING
    if (count == 0 || M(depthOf)(first) >= high || M(depthOf)(first + uint(count - 1)) < low) return 0u;
#endif
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
    if (zMax < low || zMin >= high) return 0u;
    int from = int(abufferBucket(low, zMin, zMax, uint(BUCKETS)));
    int to = int(abufferBucket(high, zMin, zMax, uint(BUCKETS)));
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
        uint head = imageLoad(M(pixels), words + HEAD_WORD(bucket)).r;
#ifdef TWO_WAYS
        uint tail = imageLoad(M(pixels), words + TAIL_WORD(bucket)).r;
#else
        uint tail = 0u;
#endif
        found = M(inList)(head, tail, low, high, away);
    }
    return found;
#else
    uint head = imageLoad(M(pixels), words).r;
#ifdef TWO_WAYS
    uint tail = imageLoad(M(pixels), words + TAIL_WORD(0)).r;
#ifdef SKIPPING
    if (head == 0u || M(depthOf)(head) >= high || M(depthOf)(tail) < low) return 0u;
#endif
#else
    uint tail = 0u;
#endif
    return M(inList)(head, tail, low, high, away);
#endif
}

// ---- rays

struct M(Found) {
    uint node; // 0: nothing, or the ray was exhausted
    float t;
    float error;
    uint view;
    bool exhausted;
};

// What the ray meets first in its pixel.
bool M(meets)(ABufferMarch march, inout M(Found) found) {
    float low = min(march.from, march.to);
    float high = max(march.from, march.to);
    float pad = 0.5 * THICKNESS * abufferFootprint(M(view), ABUFFER_SHAPE, march.view, low);
    found.node = M(inPixel)(ABUFFER_PIXEL(march.view, march.pixel), low - pad, high + pad, march.ray.add.w > 0.0);
    if (found.node == 0u) return false;
    float z = M(depthOf)(found.node);
    float part = march.to != march.from ? clamp((z - march.from) / (march.to - march.from), 0.0, 1.0) : 0.5;
    found.t = march.next < rayInfinity ? mix(march.t, march.next, part)
                                       : march.t + max(z - march.from, 0.0) / abs(march.ray.add.w);
    found.error = 0.5 * abufferFootprint(M(view), ABUFFER_SHAPE, march.view, z) + pad;
    found.view = march.view;
    return true;
}

bool M(traverse)(Ray ray, out M(Found) found) {
    vec3 fromEye = ray.origin - M(view).position.xyz;
    uint view = abufferViewAt(M(view), ABUFFER_SHAPE, fromEye, ray.direction, ray.tMin);
    // Off the surface by what its fragments may be off their places.
    float depth = abufferSeen(M(view), NEAR_PLANE, view, fromEye, 1.0).w;
    fromEye += ray.normal * (OFFSET * abufferFootprint(M(view), ABUFFER_SHAPE, view, max(depth, 0.0)));
    ABufferMarch march = abufferMarch(M(view), ABUFFER_SHAPE, view, fromEye, ray.direction, ray.tMin, ray.tMax);
    found = M(Found)(0u, ray.tMax, 0.0, 0u, false);
    while (march.views > 0) {
        ITERATION;
        ++M(spent);
        abufferEnter(march, M(view), ABUFFER_SHAPE);
        while (march.inside) {
            ITERATION;
            found.exhausted = ++M(spent) > uint(BUDGET);
            if (found.exhausted) break;
            abufferAhead(march, 0);
            if (M(meets)(march, found)) break;
            abufferCross(march);
        }
        if (found.exhausted || found.node != 0u) break;
        abufferTurn(march, ABUFFER_SHAPE);
    }
#ifdef COUNT_EXHAUSTED
    atomicAdd(M(exhausted)[0], 1u);
    if (found.exhausted) atomicAdd(M(exhausted)[1], 1u);
#endif
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
    uvec4 corners = sceneTriangle(triangle);
    vec3 p0 = scenePosition(corners.x);
    vec3 a = scenePosition(corners.y) - p0;
    vec3 b = scenePosition(corners.z) - p0;
    vec3 p = ray.origin + hit.t * ray.direction - p0;
    float aa = dot(a, a);
    float ab = dot(a, b);
    float bb = dot(b, b);
    float area = aa * bb - ab * ab;
    vec2 barycentrics = area > 0.0 ? vec2(bb * dot(p, a) - ab * dot(p, b), aa * dot(p, b) - ab * dot(p, a)) / area : vec2(0.0);
    barycentrics = max(barycentrics, vec2(0.0));
    barycentrics /= max(barycentrics.x + barycentrics.y, 1.0);
    return sceneSurface(triangle, barycentrics, ray.direction);
}
#endif

#endif // EMPTY
