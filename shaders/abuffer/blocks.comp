// Between which depths lies what blocks of pixels have: level 0 is the pixels themselves, a block of a level 4 x 4 of
// the level before. An invocation makes one. What is empty has its least depth beyond its largest.
#include "lib/iterations.glsl"
#include "abuffer/lists.glsl"
#include "abuffer/primitive_lists.glsl"
#include "abuffer/march.glsl"

layout(local_size_x = 64) in;

layout(r32ui) uniform uimageBuffer block_bounds;
#if LEVEL == 0
#ifdef PRIMITIVES
layout(r32ui) uniform readonly uimageBuffer cells;
#else
layout(r32ui) uniform readonly uimageBuffer pixels;
layout(r32ui) uniform readonly uimageBuffer nodes;

uint depthBits(uint node) { return imageLoad(nodes, NODE_AT(node, 0)).r; }
#endif
#endif

const vec2 nothing = vec2(3.0e38, -3.0e38);

#if LEVEL == 0
vec2 boundsOf(int pixel) {
#ifdef PRIMITIVES
    return uintBitsToFloat(uvec2(imageLoad(cells, pixel * PRIMITIVE_WORDS).r, imageLoad(cells, pixel * PRIMITIVE_WORDS + 1).r));
#else
    uint a = imageLoad(pixels, pixel * PIXEL_WORDS).r;
#if defined(BUCKETED)
    return uintBitsToFloat(uvec2(a, imageLoad(pixels, pixel * PIXEL_WORDS + 1).r));
#elif defined(SB)
    uint count = imageLoad(pixels, pixel * PIXEL_WORDS + 1).r;
    return count > 0u ? uintBitsToFloat(uvec2(depthBits(a), depthBits(a + count - 1u))) : nothing;
#elif defined(TWO_WAYS)
    return a > 0u ? uintBitsToFloat(uvec2(depthBits(a), depthBits(imageLoad(pixels, pixel * PIXEL_WORDS + 1).r))) : nothing;
#else
    // Nothing but walking there tells how far it reaches.
    uint last = a;
    for (uint node = a; node != 0u; node = imageLoad(nodes, NODE_AT(node, 1)).r) {
        ITERATION;
        last = node;
    }
    return a > 0u ? uintBitsToFloat(uvec2(depthBits(a), depthBits(last))) : nothing;
#endif
#endif
}
#endif

void main() {
    int index = int(gl_GlobalInvocationID.y) * ROW + int(gl_GlobalInvocationID.x);
    ABufferShape shape = ABUFFER_SHAPE;
    if (int(gl_GlobalInvocationID.x) >= ROW || index >= abufferBlocks(shape, MAIN_SIZE, LEVEL)) return;
#if LEVEL == 0
    vec2 bounds = boundsOf(index);
#if defined(PLANES) && !defined(PRIMITIVES)
    if (bounds.x <= bounds.y)
        bounds = abufferWiden(bounds, uintBitsToFloat(imageLoad(pixels, index * PIXEL_WORDS + SPREAD_WORD).r));
#endif
    int at = index;
#else
    int first = 0;
    for (int level = 0; level < LEVEL - 1; ++level) {
        ITERATION;
        first += abufferBlocks(shape, MAIN_SIZE, level);
    }
    int at = first + abufferBlocks(shape, MAIN_SIZE, LEVEL - 1) + index;
    // The block in its view, and where the blocks of the view begin in the level before.
    ivec2 below = (MAIN_SIZE + (1 << (2 * LEVEL - 2)) - 1) >> (2 * LEVEL - 2);
    ivec2 own = (below + 3) >> 2;
    if (index >= own.x * own.y) {
        index -= own.x * own.y;
        first += below.x * below.y;
        below = (ivec2(SIDE) + (1 << (2 * LEVEL - 2)) - 1) >> (2 * LEVEL - 2);
        own = (below + 3) >> 2;
        first += index / (own.x * own.y) * below.x * below.y;
        index %= own.x * own.y;
    }
    ivec2 corner = 4 * ivec2(index % own.x, index / own.x);
    vec2 bounds = nothing;
    for (int i = 0; i < 16; ++i) {
        ITERATION;
        ivec2 child = min(corner + ivec2(i & 3, i >> 2), below - 1);
        int block = 2 * (first + child.y * below.x + child.x);
        vec2 other = uintBitsToFloat(uvec2(imageLoad(block_bounds, block).r, imageLoad(block_bounds, block + 1).r));
        bounds = vec2(min(bounds.x, other.x), max(bounds.y, other.y));
    }
#endif
    imageStore(block_bounds, 2 * at, uvec4(floatBitsToUint(bounds.x)));
    imageStore(block_bounds, 2 * at + 1, uvec4(floatBitsToUint(bounds.y)));
    ITERATIONS_END;
}
