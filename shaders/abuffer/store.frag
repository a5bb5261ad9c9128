// Every fragment becomes a node in the list of its pixel (section 3.3, store stage), in no order. COUNTER: the node is
// the next of all, by one counter or (PAGES) several, and goes in front of the list of its bucket. Otherwise the
// pixel's nodes lie side by side from where the prefix sum said, and no list is kept yet: the address alone tells.
// Which one is next the pixel's fragments count up, atomically, or with NEXT in an attachment that each reads and
// writes in its turn.
#ifdef NEXT
#extension GL_EXT_shader_framebuffer_fetch : require
#endif
#include "abuffer/fragment.glsl"
#include "abuffer/lists.glsl"

#ifdef CUBE
uniform uint face;
#endif
#ifdef PLANES
#include "shared/view.h"

layout(std140) uniform VIEW_BLOCK { ViewData frameView; };
flat in vec2 seen_range;
#endif
uniform uint capacity;
layout(r32ui) uniform writeonly uimageBuffer nodes;
#ifdef KEEPS_DATA
layout(r32ui) uniform writeonly uimageBuffer data;
#endif
#ifdef COUNTER
layout(r32ui) uniform uimageBuffer pixels;
#ifdef PAGES
layout(std430) buffer Counter { uint counters[]; }; // the first: nodes up to the end of the last page; then one each
#else
layout(std430) buffer Counter { uint counter; };
#endif
#elif defined(NEXT)
inout uvec4 OUTPUT;
#else
layout(r32ui) uniform uimageBuffer segments;
#endif

void main() {
    float depth;
    bool there = abufferFragment(depth);
#ifdef PLANES
    // On a plane the inverse of depth is affine on the screen, of parallel rays depth itself.
    bool parallel = SEEN_BY == 0u && frameView.position.w != 0.0;
    float height = parallel ? depth : 1.0 / depth;
    vec2 heights = parallel ? seen_range : (seen_range.x > 0.0 ? 1.0 / seen_range.yx : vec2(0.0, 3.0e38));
    uint plane = abufferPlane(vec2(dFdx(height), dFdy(height)) / height, heights / height - 1.0);
#endif
    if (!there) discard;
    ivec2 at = ivec2(gl_FragCoord.xy);
    int pixel = ABUFFER_PIXEL(SEEN_BY, at);
    uint next = 0u;
#ifdef COUNTER
#ifdef PAGES
    // Tiles of a row take the counters in turn, and the rows above begin elsewhere.
    ivec2 tile = at / TILE_SIDE;
    uint own = (uint(tile.x + 11 * tile.y) + 5u * uint(SEEN_BY)) % PAGE_COUNTERS;
    uint count = atomicAdd(counters[COUNTER_WORDS * (1u + own)], 1u);
    uint page = count / PAGE_NODES * PAGE_COUNTERS + own;
    uint node = page * PAGE_NODES + count % PAGE_NODES + 1u;
    if (count % PAGE_NODES == 0u) atomicMax(counters[0], (page + 1u) * PAGE_NODES);
#else
    uint node = atomicAdd(counter, 1u) + 1u;
#endif
    if (node > capacity) discard;
    uint bucket = 0u; // with SHIFTED all are in one list until their order is known
#if defined(BUCKETED) && !defined(SHIFTED)
    float zMin = uintBitsToFloat(imageLoad(pixels, pixel * PIXEL_WORDS).r);
    float zMax = uintBitsToFloat(imageLoad(pixels, pixel * PIXEL_WORDS + 1).r);
    bucket = abufferBucket(depth, zMin, zMax, uint(BUCKETS));
#endif
    next = imageAtomicExchange(pixels, pixel * PIXEL_WORDS + HEAD_WORD(bucket), node);
#else
#ifdef NEXT
    uint node = OUTPUT.r;
    OUTPUT = uvec4(node + 1u);
#else
    uint node = imageAtomicAdd(segments, 2 * pixel + 1, 1u);
#endif
    if (node > capacity) discard;
#endif
    imageStore(nodes, NODE_AT(node, 0), uvec4(floatBitsToUint(depth)));
#ifdef PLANES
    imageStore(nodes, NODE_AT(node, PLANE_WORD), uvec4(plane));
#endif
#ifdef SB
#ifdef DECOUPLED
    imageStore(nodes, NODE_AT(node, 1), uvec4(node));
#else
    imageStore(nodes, NODE_AT(node, 1), uvec4(seen_triangle));
#endif
#elif defined(COUNTER)
    imageStore(nodes, NODE_AT(node, 1), uvec4(next));
#endif
#ifdef KEEPS_DATA
    imageStore(data, int(node) - 1, uvec4(seen_triangle));
#elif !defined(SB) && !defined(DECOUPLED)
    imageStore(nodes, NODE_AT(node, TRIANGLE_WORD), uvec4(seen_triangle));
#endif
}
