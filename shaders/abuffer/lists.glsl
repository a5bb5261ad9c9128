// The lists of an A-buffer: where a pixel's words lie, and what a node holds. The structures' words are said in
// passes/abuffer/views.h. Addresses of nodes start at 1; 0 ends a list. All three buffers are r32ui.
#include "shared/abuffer.h"

// Macros, so that a module's own defines hold in them, whoever included this file first.
#define HEAD_WORD(bucket) (HEAD_FIRST + int(bucket))
#define TAIL_WORD(bucket) (TAIL_FIRST + int(bucket))

// A pixel's number among those of all views: the frame's view is view 0, a face 1 + face.
#define ABUFFER_PIXEL(view, pixel)                                                                                             \
    ((view) == 0u ? (pixel).y * MAIN_WIDTH + (pixel).x : MAIN_PIXELS + (int((view) - 1u) * SIDE + (pixel).y) * SIDE + (pixel).x)

#define NODE_AT(node, word) ((int(node) - 1) * NODE_WORDS + (word))

// A fragment's plane over its pixel. Its height (the inverse of depth, of parallel rays depth) changes for each pixel to the
// right and up by `slopes`, and lies between `limits` on the whole triangle, all as parts of what it is at the pixel's
// centre, from which limits count. Steeper slopes than 1 together are seen by their edge, and kept as 1. One word: an
// exponent and two signed numbers of eight bits, and limits in 31 parts of what half a pixel makes, rounded outwards.
struct ABufferPlane {
    vec2 slopes;
    vec2 limits;
};

uint abufferPlane(vec2 slopes, vec2 limits) {
    float sum = abs(slopes.x) + abs(slopes.y);
    if (!(sum > 0.0) || sum > 3.0e38) return 0u;
    slopes /= max(sum, 1.0);
    sum = min(sum, 1.0);
    int exponent = clamp(126 - (floatBitsToInt(max(abs(slopes.x), abs(slopes.y))) >> 23), 0, 31);
    float scale = intBitsToFloat((127 + exponent) << 23); // 2 to the exponent
    uvec2 parts = uvec2(ivec2(round(clamp(slopes * scale, -1.0, 1.0) * 127.0)) + 127);
    uvec2 limited = uvec2(clamp(ceil(31.0 * abs(limits) / (0.5 * sum)), 0.0, 31.0));
    return uint(exponent) | parts.x << 5u | parts.y << 13u | limited.x << 21u | limited.y << 26u;
}

ABufferPlane abufferPlane(uint word) {
    if (word == 0u) return ABufferPlane(vec2(0.0), vec2(0.0));
    vec2 parts = vec2(ivec2((uvec2(word) >> uvec2(5u, 13u)) & 255u) - 127) / 127.0;
    vec2 slopes = parts * uintBitsToFloat((127u - (word & 31u)) << 23u);
    vec2 limits = vec2((uvec2(word) >> uvec2(21u, 26u)) & 31u) / 31.0;
    return ABufferPlane(slopes, 0.5 * (abs(slopes.x) + abs(slopes.y)) * limits * vec2(-1.0, 1.0));
}

// By which part of its height at the pixel's centre, at most, it is another elsewhere in the pixel; below 1/2 and a little.
float abufferSpread(uint word) {
    vec2 slopes = abs(abufferPlane(word).slopes);
    return 0.5 * (slopes.x + slopes.y);
}

// The interval of depths at pixels' centres in which those lie that have a depth of the interval somewhere in the pixel.
vec2 abufferWiden(vec2 depths, float spread) { return depths * vec2(1.0 - spread, 1.0 / (1.0 - spread)); }
