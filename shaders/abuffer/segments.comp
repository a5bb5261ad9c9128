// What the store stage begins with. RANGES: empty lists, and between which depths each pixel's fragments lie. Or, from
// how many fragments each pixel of all views has, where its nodes lie, by a prefix sum. SUM: the fragments of a run of
// pixels; SCAN: the fragments before each run (one invocation); PLACE: each pixel's first node and the one after its
// last, or with COUNT_UP the first twice, since fragments count the other up; with NEXT the first once more, in images
// that fragments count up.
#include "abuffer/lists.glsl"

layout(local_size_x = LOCAL_SIZE) in;

#ifndef RANGES
layout(r32ui) uniform uimageBuffer runs;
#endif
#ifdef SCAN
layout(std430) buffer Counter { uint counter; };
#else
// COUNTS: the numbers of fragments stand by themselves.
#if MAIN_PIXELS > 0
#ifdef COUNTS
layout(r32f) uniform readonly image2D counts;
#else
layout(rgba32f) uniform readonly image2D bounds;
#endif
#ifdef NEXT
layout(r32ui) uniform writeonly uimage2D next;
#endif
#endif
#if SIDE > 0
#ifdef COUNTS
layout(r32f) uniform readonly image2DArray cube_counts;
#else
layout(rgba32f) uniform readonly image2DArray cube_bounds;
#endif
#ifdef NEXT
layout(r32ui) uniform writeonly uimage2DArray cube_next;
#endif
#endif
#ifdef PLACE
layout(r32ui) uniform writeonly uimageBuffer segments;
#endif
#ifdef RANGES
layout(r32ui) uniform writeonly uimageBuffer pixels;
#endif

#if MAIN_PIXELS > 0
ivec2 onFrame(int pixel) { return ivec2(pixel % MAIN_WIDTH, pixel / MAIN_WIDTH); }
#endif
#if SIDE > 0
ivec3 onFaces(int pixel) {
    int at = pixel - MAIN_PIXELS;
    return ivec3(at % SIDE, at / SIDE % SIDE, at / (SIDE * SIDE));
}
#endif

// Of a pixel by its number: least depth negated, largest depth, nothing, fragments; with COUNTS the last alone.
vec4 seen(int pixel) {
    vec4 result = vec4(0.0);
#if MAIN_PIXELS > 0
    if (pixel < MAIN_PIXELS) {
#ifdef COUNTS
        return vec4(0.0, 0.0, 0.0, imageLoad(counts, onFrame(pixel)).r);
#else
        return imageLoad(bounds, onFrame(pixel));
#endif
    }
#endif
#if SIDE > 0
#ifdef COUNTS
    result.a = imageLoad(cube_counts, onFaces(pixel)).r;
#else
    result = imageLoad(cube_bounds, onFaces(pixel));
#endif
#endif
    return result;
}
#endif

void main() {
    int run = int(gl_GlobalInvocationID.x);
    int begin = run * RUN;
    int end = min(begin + RUN, PIXELS_IN_ALL);
#if defined(SCAN)
    uint sum = 0u;
    for (int i = 0; i < RUNS; ++i) {
        uint count = imageLoad(runs, i).r;
        imageStore(runs, i, uvec4(sum));
        sum += count;
    }
    counter = sum;
#elif defined(SUM)
    uint sum = 0u;
    for (int pixel = begin; pixel < end; ++pixel) sum += uint(seen(pixel).a);
    if (begin < end) imageStore(runs, run, uvec4(sum));
#elif defined(PLACE)
    uint first = begin < end ? imageLoad(runs, run).r + 1u : 1u;
    for (int pixel = begin; pixel < end; ++pixel) {
        uint after = first + uint(seen(pixel).a);
        imageStore(segments, 2 * pixel, uvec4(first));
#ifdef COUNT_UP
        imageStore(segments, 2 * pixel + 1, uvec4(first));
#else
        imageStore(segments, 2 * pixel + 1, uvec4(after));
#endif
#ifdef NEXT
#if MAIN_PIXELS > 0
        if (pixel < MAIN_PIXELS) imageStore(next, onFrame(pixel), uvec4(first));
#endif
#if SIDE > 0
        if (pixel >= MAIN_PIXELS) imageStore(cube_next, onFaces(pixel), uvec4(first));
#endif
#endif
        first = after;
    }
#else
    for (int pixel = begin; pixel < end; ++pixel) {
        vec4 range = seen(pixel);
#ifdef WIDEN
        // The fragments to come are rounded otherwise: their depths, and which pixels have any.
        bool any = -range.x <= range.y;
        range.xy = any ? range.xy + 1e-4 * abs(range.xy) : vec2(3e38);
#endif
        for (int i = 2; i < PIXEL_WORDS; ++i) imageStore(pixels, pixel * PIXEL_WORDS + i, uvec4(0u));
        imageStore(pixels, pixel * PIXEL_WORDS, uvec4(floatBitsToUint(-range.x)));
        imageStore(pixels, pixel * PIXEL_WORDS + 1, uvec4(floatBitsToUint(range.y)));
    }
#endif
}
