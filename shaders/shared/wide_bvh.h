// How a wide bounding volume hierarchy lies in memory, and the test of its boxes, for C++ and GLSL alike.
//
// Inner nodes and triangles are items of one buffer, three texels of 16 bytes each, so that one loop walks both. The
// children of a node lie together. A node (bit 31 of the first w):
//     (origin, exponents of the three steps in its low 24 bits and bit 31)
//     (low planes of x, y, z, first texel of the first child)
//     (high planes of x, y, z, which children there are: bits 0 to 3)
// Planes are a byte for each of four children, in steps of a power of two from the origin (Ylitie, Karras and Laine,
// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017). A triangle:
//     (p0, index in the geometry) (p1, material) (p2, triangle class)
// Bind the buffer as rgba32ui: what is no float might be flushed as a denormal. Item 0 is the root, always a node.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

#ifdef __cplusplus
using glm::floatBitsToInt, glm::intBitsToFloat, glm::uintBitsToFloat;
#endif

// Words of children that wait; a walk keeps at most one a level.
const uint wideStackSize = 32u;
const uint wideNode = 0x80000000u;

const uint wideTexels = 3u; // an item
const uint wideMostTexels = 1u << 28u;

// Children that are left of a node's: the first texel of all, and a bit for each that is left.
inline uint wideChildren(uint first, uint left) { return (first << 4u) | left; }

// How many texels a child, told by its bit, lies behind the first: 0, 3, 6, 9. (Multiplying words takes a CPU ten cycles, in
// the longest chain of a walk.)
inline uint wideTexelOf(uint bit) { return (bit & 6u) | ((bit & 6u) >> 1u) | (bit & 8u) | (bit >> 3u); }

// What a ray's tests of boxes have in common.
struct WideRay {
    vec3 inverse;   // inverseDirection()
    uvec3 backward; // all ones for an axis that the ray runs down
};

inline WideRay wideRay(vec3 inverse) {
    WideRay ray;
    ray.inverse = inverse;
    ray.backward = uvec3(inverse.x < 0.0f ? 0xffffffffu : 0u, inverse.y < 0.0f ? 0xffffffffu : 0u,
                         inverse.z < 0.0f ? 0xffffffffu : 0u);
    return ray;
}

// Where a box's interval begins, and whether it ends later. Floats of one sign are ordered as their bits are: with tMin at 0
// or above, a plane behind the start loses against it, and an end behind the start lies below every beginning. The end is
// widened as in intersectBox().
inline bool wideMeets(vec3 near, vec3 far, int tMin, int tMax, OUT(int) entry) {
    entry = max(max(floatBitsToInt(near.x), floatBitsToInt(near.y)), max(floatBitsToInt(near.z), tMin));
    const int leave = min(min(floatBitsToInt(far.x), floatBitsToInt(far.y)), min(floatBitsToInt(far.z), tMax));
    return entry <= floatBitsToInt(intBitsToFloat(leave) * 1.000001f);
}

// Which children of a node the ray's interval meets (0 <= tMin), a bit each, and where it enters them (as bits).
//
// Nothing is missed that the exact box of the triangles would meet: planes lie outside the box by 1/256 of a step at least,
// which is more than rounding takes where the node is near (the products then have up to 2^14 steps), and far off, where
// rounding is a share of the distance, the end is widened.
inline uint wideMet(WideRay ray, vec3 origin, float tMin, float tMax, uvec4 a, uvec4 b, uvec4 c, OUT(ivec4) entries) {
    const vec3 unit = vec3(uintBitsToFloat((a.w << 23u) & 0x7f800000u), uintBitsToFloat((a.w << 15u) & 0x7f800000u),
                           uintBitsToFloat((a.w << 7u) & 0x7f800000u));
    const vec3 start = (vec3(uintBitsToFloat(a.x), uintBitsToFloat(a.y), uintBitsToFloat(a.z)) - origin) * ray.inverse;
    const vec3 step = unit * ray.inverse;
    const uvec3 low = uvec3(b.x, b.y, b.z);
    const uvec3 high = uvec3(c.x, c.y, c.z);
    const uvec3 change = (low ^ high) & ray.backward;
    const uvec3 near = low ^ change;
    const uvec3 far = high ^ change;
    const int first = floatBitsToInt(tMin);
    const int last = floatBitsToInt(tMax);
    uint met = wideMeets(vec3(near & 255u) * step + start, vec3(far & 255u) * step + start, first, last, entries.x)
                   ? 1u
                   : 0u;
    met |= wideMeets(vec3((near >> 8u) & 255u) * step + start, vec3((far >> 8u) & 255u) * step + start, first, last,
                     entries.y)
               ? 2u
               : 0u;
    met |= wideMeets(vec3((near >> 16u) & 255u) * step + start, vec3((far >> 16u) & 255u) * step + start, first, last,
                     entries.z)
               ? 4u
               : 0u;
    met |= wideMeets(vec3(near >> 24u) * step + start, vec3(far >> 24u) * step + start, first, last, entries.w) ? 8u : 0u;
    return met & c.w;
}

SHARED_END
