// Every fragment becomes a node in the list of its pixel (section 3.3, store stage), in no order. COUNTER: the node is
// the next of all, by one counter, and goes in front of the list of its bucket. Otherwise the pixel's nodes lie side by
// side from where the prefix sum said, and no list is kept yet: the address alone tells.
#include "abuffer/fragment.glsl"
#include "abuffer/lists.glsl"

#ifdef CUBE
uniform uint face;
#endif
uniform uint capacity;
layout(r32ui) uniform writeonly uimageBuffer nodes;
#ifdef DECOUPLED
layout(r32ui) uniform writeonly uimageBuffer data;
#endif
#ifdef COUNTER
layout(r32ui) uniform uimageBuffer pixels;
layout(std430) buffer Counter { uint counter; };
#else
layout(r32ui) uniform uimageBuffer segments;
#endif

void main() {
    uint triangle = fragmentTriangle();
    float depth;
    if (!abufferFragment(triangle, depth)) discard;
    ivec2 at = ivec2(gl_FragCoord.xy);
#ifdef CUBE
    int pixel = ABUFFER_PIXEL(1u + face, at);
#else
    int pixel = ABUFFER_PIXEL(0u, at);
#endif
    uint next = 0u;
#ifdef COUNTER
    uint node = atomicAdd(counter, 1u) + 1u;
    if (node > capacity) discard;
    uint bucket = 0u;
#ifdef BUCKETED
    float zMin = uintBitsToFloat(imageLoad(pixels, pixel * PIXEL_WORDS).r);
    float zMax = uintBitsToFloat(imageLoad(pixels, pixel * PIXEL_WORDS + 1).r);
    bucket = abufferBucket(depth, zMin, zMax, uint(BUCKETS));
#endif
    next = imageAtomicExchange(pixels, pixel * PIXEL_WORDS + HEAD_WORD(bucket), node);
#else
    uint node = imageAtomicAdd(segments, 2 * pixel + 1, 1u);
    if (node > capacity) discard;
#endif
    imageStore(nodes, NODE_AT(node, 0), uvec4(floatBitsToUint(depth)));
#ifdef SB
#ifdef DECOUPLED
    imageStore(nodes, NODE_AT(node, 1), uvec4(node));
#else
    imageStore(nodes, NODE_AT(node, 1), uvec4(triangle));
#endif
#elif defined(COUNTER)
    imageStore(nodes, NODE_AT(node, 1), uvec4(next));
#endif
#ifdef DECOUPLED
    imageStore(data, int(node) - 1, uvec4(triangle));
#elif !defined(SB)
    imageStore(nodes, NODE_AT(node, NODE_WORDS - 1), uvec4(triangle));
#endif
}
