// What the store stage begins with, from how many fragments each pixel of all views has, and between which depths. SUM:
// the fragments of a run of pixels; SCAN: the fragments before each run (one invocation); PLACE: where the nodes of
// each pixel lie, which is the prefix sum, and an empty list for it; with RANGES the empty lists alone.
#include "abuffer/lists.glsl"

layout(local_size_x = LOCAL_SIZE) in;

#ifndef RANGES
layout(r32ui) uniform uimageBuffer runs;
#endif
#ifdef SCAN
layout(std430) buffer Counter { uint counter; };
#else
#if MAIN_PIXELS > 0
layout(rgba32f) uniform readonly image2D bounds;
#endif
#if SIDE > 0
layout(rgba32f) uniform readonly image2DArray cube_bounds;
#endif
#ifdef PLACE
layout(r32ui) uniform writeonly uimageBuffer segments;
#endif
#ifndef SUM
layout(r32ui) uniform writeonly uimageBuffer pixels;
#endif

// Of a pixel by its number: least depth negated, largest depth, nothing, fragments.
vec4 seen(int pixel) {
#if MAIN_PIXELS > 0
    if (pixel < MAIN_PIXELS) return imageLoad(bounds, ivec2(pixel % MAIN_WIDTH, pixel / MAIN_WIDTH));
#endif
#if SIDE > 0
    int onCube = pixel - MAIN_PIXELS;
    return imageLoad(cube_bounds, ivec3(onCube % SIDE, onCube / SIDE % SIDE, onCube / (SIDE * SIDE)));
#else
    return vec4(0.0);
#endif
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
#else
#ifdef PLACE
    uint first = begin < end ? imageLoad(runs, run).r + 1u : 1u;
#endif
    for (int pixel = begin; pixel < end; ++pixel) {
        vec4 range = seen(pixel);
#ifdef PLACE
        imageStore(segments, 2 * pixel, uvec4(first));
        imageStore(segments, 2 * pixel + 1, uvec4(first));
        first += uint(range.a);
#endif
        for (int i = 0; i < PIXEL_WORDS; ++i) {
            uint word = 0u;
#ifdef BUCKETED
            if (i == 0) word = floatBitsToUint(-range.x);
            if (i == 1) word = floatBitsToUint(range.y);
#endif
            imageStore(pixels, pixel * PIXEL_WORDS + i, uvec4(word));
        }
    }
#endif
}
