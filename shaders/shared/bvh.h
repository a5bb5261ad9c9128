// How a bounding volume hierarchy lies in memory, for C++ and GLSL alike.
//
// An inner node is four texels of 16 bytes; each of its two children takes two:
//     (min.x, min.y, min.z, reference) (max.x, max.y, max.z, 0)
// A triangle is three texels, its corners, with what belongs to it in the fourth components:
//     (p0, index in the geometry) (p1, material) (p2, triangle class)
// Bind both buffers as rgba32ui and read coordinates with uintBitsToFloat: references are not floats, and a driver may
// flush what looks like a denormal. Node 0 is the root and always there; an absent child is a leaf of 0 triangles.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// A traversal that descends into one child and keeps the other never holds more entries than this.
const uint bvhStackSize = 32u;
const uint bvhMaxLeaf = 15u;

// A reference to a child: an inner node's index, or a leaf (bit 31) with its count (bits 27 to 30) and first triangle.
inline uint bvhLeaf(uint first, uint count) { return 0x80000000u | (count << 27u) | first; }
inline bool bvhIsLeaf(uint reference) { return (reference & 0x80000000u) != 0u; }
inline uint bvhLeafFirst(uint reference) { return reference & 0x07ffffffu; }
inline uint bvhLeafCount(uint reference) { return (reference >> 27u) & 15u; }

SHARED_END
