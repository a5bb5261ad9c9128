// Part of the module of an A-buffer's fragments: what a ray meets in its pixel.

// When a ray meets a fragment of this depth in its pixel.
float M(timeOf)(ABufferMarch march, float z) {
    float part = march.to != march.from ? clamp((z - march.from) / (march.to - march.from), 0.0, 1.0) : 0.5;
    return march.next < rayInfinity ? mix(march.t, march.next, part)
                                    : march.t + max(z - march.from, 0.0) / abs(march.ray.add.w);
}

#ifdef PLANES
// When a ray meets a fragment's plane in its pixel, or is no farther from it than `pad`: rayInfinity where it does not. How far
// the ray is before the plane, along the view's axis, is an affine function of time once multiplied by the ray's
// depth over the plane's, which lies near 1 where they meet.
float M(crossing)(ABufferMarch march, uint node, float z, float pad) {
    ABufferPlane plane = abufferPlane(imageLoad(M(nodes), NODE_AT(node, PLANE_WORD)).r);
    vec2 toPixels = 0.5 * vec2(march.size);
    vec2 fromCentre = toPixels - (vec2(march.pixel) + 0.5);
    float at = dot(plane.slopes, march.ray.at.xy * toPixels + march.ray.at.z * fromCentre);
    float add = dot(plane.slopes, march.ray.add.xy * toPixels + march.ray.add.z * fromCentre);
    bool parallel = march.view == 0u && M(view).position.w != 0.0;
    float before = parallel ? z + z * at - march.ray.at.w : z - march.ray.at.z - at;
    float grows = parallel ? z * add - march.ray.add.w : -march.ray.add.z - add;
    float enters = before + march.t * grows;
    float leaves = march.next < rayInfinity ? before + march.next * grows : (grows == 0.0 ? enters : sign(grows) * 3.0e38);
    if (min(enters, leaves) > pad || max(enters, leaves) < -pad) return rayInfinity;
    float t = grows != 0.0 ? clamp(-before / grows, march.t, march.next) : march.t;
    // Beyond its triangle the plane is where a surface goes on in its neighbours, or a fin before or behind an edge. Fins
    // stop rays that begin beside them, and of others only as many as pass where the triangle has no fragment: so
    // they count for rays that have come four times as far as the plane goes in half a pixel.
    float depth = march.ray.at.w + t * march.ray.add.w;
    float off = (parallel ? depth - z : z - depth) / (parallel ? z : depth);
    float room = pad / min(z, depth);
    bool within = off >= plane.limits.x - room && off <= plane.limits.y + room;
    return within || t > 2.0 * abs(z) * (abs(plane.slopes.x) + abs(plane.slopes.y)) ? t : rayInfinity;
}
#endif

#ifdef PROVIDES_TRACER

struct M(Found) {
    uint node; // 0: nothing, or the ray was exhausted
    float t;
    float error;
    uint view;
    bool exhausted;
};

// A fragment whose depth lies in the ray's interval. True if none that comes later is met before it: `ordered`, if they come
// as the ray meets them. With PLANES the order at the pixel's centre is not that along the ray, and all are looked at.
bool M(take)(ABufferMarch march, uint node, float z, float pad, bool ordered, inout M(Found) found) {
#ifdef PLANES
    float t = M(crossing)(march, node, z, pad);
    if (t < rayInfinity && (found.node == 0u || t < found.t)) {
        found.node = node;
        found.t = t;
    }
    return false;
#else
    found.node = node;
    return ordered;
#endif
}

// What a ray meets in a list of linked nodes, whose depths in the pixel are [depths.x, depths.y).
void M(inList)(ABufferMarch march, uint head, uint tail, vec2 depths, float pad, inout M(Found) found) {
    bool away = march.ray.add.w > 0.0;
#ifdef TWO_WAYS
    if (!away) {
        for (uint node = tail; node != 0u; node = M(previousOf)(node)) {
            ITERATION;
            ++M(spent);
            float z = M(depthOf)(node);
            if (z < depths.x) break;
            if (z < depths.y && M(take)(march, node, z, pad, true, found)) break;
        }
        return;
    }
#endif
    for (uint node = head; node != 0u; node = M(nextOf)(node)) {
        ITERATION;
        ++M(spent);
        float z = M(depthOf)(node);
        if (z >= depths.y) break;
        // Coming nearer, the last one is met first.
        if (z >= depths.x && M(take)(march, node, z, pad, away, found)) break;
    }
}

#if defined(BUCKETED) && !defined(SINGLE_LAYER)
// Between which buckets, both counted, a pixel's fragments of these depths lie.
ivec2 M(bucketsAhead)(int pixel, vec2 depths) {
    ivec2 buckets = ivec2(0, BUCKETS - 1);
#if defined(SKIPPING) && defined(SHIFTED)
    // Boundaries lie where the buckets begin, one after the other: a bucket ends at the next one's first depth at
    // the latest.
    for (int bucket = 1; bucket <= buckets.y; ++bucket) {
        ITERATION;
        uint head = M(headOf)(pixel, bucket);
        float z = head != 0u ? M(depthOf)(head) : 0.0;
        if (head == 0u || z >= depths.y) {
            buckets.y = bucket - 1;
        } else if (z < depths.x) {
            buckets.x = bucket;
        }
    }
#elif defined(SKIPPING)
    float zMin = uintBitsToFloat(imageLoad(M(pixels), pixel * PIXEL_WORDS).r);
    float zMax = uintBitsToFloat(imageLoad(M(pixels), pixel * PIXEL_WORDS + 1).r);
    buckets.x = int(abufferBucket(depths.x, zMin, zMax, uint(BUCKETS)));
    buckets.y = int(abufferBucket(depths.y, zMin, zMax, uint(BUCKETS)));
#endif
    return buckets;
}
#endif

#ifdef SB
// The first of `count` nodes side by side that is at least `wanted` deep.
int M(firstFrom)(uint first, int count, float wanted) {
    int begin = 0;
    if (count > 16) {
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
            if (M(depthOf)(first + uint(begin)) >= wanted) break;
        }
    }
    return begin;
}
#endif

// What the ray meets first in its pixel.
bool M(meets)(ABufferMarch march, inout M(Found) found) {
    int pixel = ABUFFER_PIXEL(march.view, march.pixel);
    float pad = M(halfThickness)(march);
    vec2 depths = abufferWiden(M(depthsAhead)(march), M(spreadOf)(pixel));
    bool away = march.ray.add.w > 0.0;
#if defined(SINGLE_LAYER)
    uint nearest = M(nearestOf)(pixel);
    float depth = nearest != 0u ? M(depthOf)(nearest) : 3.0e38;
    if (depth >= depths.x && depth < depths.y) M(take)(march, nearest, depth, pad, true, found);
#elif defined(SB)
    uint first = imageLoad(M(pixels), pixel * PIXEL_WORDS).r;
    int count = int(imageLoad(M(pixels), pixel * PIXEL_WORDS + 1).r);
#ifdef PLANES
    for (int at = M(firstFrom)(first, count, depths.x); at < count; ++at) {
        ITERATION;
        float z = M(depthOf)(first + uint(at));
        if (z >= depths.y) break;
        M(take)(march, first + uint(at), z, pad, true, found);
    }
#else
    // Coming nearer the last that is before the interval's end.
    int at = away ? M(firstFrom)(first, count, depths.x) : M(firstFrom)(first, count, depths.y) - 1;
    float z = at >= 0 && at < count ? M(depthOf)(first + uint(at)) : 3.0e38;
    if (z >= depths.x && z < depths.y) M(take)(march, first + uint(at), z, pad, true, found);
#endif
#elif defined(BUCKETED)
    ivec2 range = M(bucketsAhead)(pixel, depths);
    int buckets = range.y - range.x + 1;
    for (int i = 0; i < buckets; ++i) {
        ITERATION;
        ++M(spent);
        int bucket = away ? range.x + i : range.y - i;
#ifdef TWO_WAYS
        uint tail = imageLoad(M(pixels), pixel * PIXEL_WORDS + TAIL_WORD(bucket)).r;
#else
        uint tail = 0u;
#endif
        M(inList)(march, M(headOf)(pixel, bucket), tail, depths, pad, found);
#ifndef PLANES
        if (found.node != 0u) break;
#endif
    }
#else
#ifdef TWO_WAYS
    uint tail = imageLoad(M(pixels), pixel * PIXEL_WORDS + TAIL_WORD(0)).r;
#else
    uint tail = 0u;
#endif
    M(inList)(march, M(headOf)(pixel, 0), tail, depths, pad, found);
#endif
    if (found.node == 0u) return false;
    float met = M(depthOf)(found.node);
#ifndef PLANES
    found.t = M(timeOf)(march, met);
#endif
    found.error = 0.5 * abufferFootprint(M(view), ABUFFER_SHAPE, march.view, met) + pad;
    found.view = march.view;
    return true;
}

#endif // PROVIDES_TRACER

#ifdef PROVIDES_HITS

// Hands on one fragment, if the ray meets it; true stops.
bool M(hand)(inout Ray ray, ABufferMarch march, uint node, float z, float pad) {
#ifdef PLANES
    float t = M(crossing)(march, node, z, pad);
#else
    float t = M(timeOf)(march, z);
#endif
    if (t == rayInfinity || t < ray.tMin || t > ray.tMax) return false;
    float error = 0.5 * abufferFootprint(M(view), ABUFFER_SHAPE, march.view, z) + pad;
    return M(visit)(ray, Hit(t, error, march.view, uvec2(node, 0u)));
}

// Hands on all fragments of the ray's pixel that it meets there.
bool M(handAll)(inout Ray ray, ABufferMarch march) {
    int pixel = ABUFFER_PIXEL(march.view, march.pixel);
    float pad = M(halfThickness)(march);
    vec2 depths = abufferWiden(M(depthsAhead)(march), M(spreadOf)(pixel));
#if defined(SINGLE_LAYER)
    uint nearest = M(nearestOf)(pixel);
    float depth = nearest != 0u ? M(depthOf)(nearest) : 3.0e38;
    return depth >= depths.x && depth < depths.y && M(hand)(ray, march, nearest, depth, pad);
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

#endif // PROVIDES_HITS
