// The A-buffer's views and the layout of its buffers, for its passes and their tests (Vardis, Vasilakis, Papaioannou, "A
// Multiview and Multilayer Approach for Interactive Ray Tracing", I3D 2016, sections 3.2 and 3.3).
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// The faces of the cube about the eye: 0 to 5 look along +x, -x, +y, -y, +z, -z; up is +y, for face 2 -z and for face 3 +z.
const uint abufferFaces = 6u;

// What lies in direction `q` from the eye, in a face's own axes: rightward, upward, along its axis.
inline vec3 abufferFaceAxes(uint face, vec3 q) {
    if (face == 0u) return vec3(q.z, q.y, q.x);
    if (face == 1u) return vec3(-q.z, q.y, -q.x);
    if (face == 2u) return vec3(-q.x, -q.z, q.y);
    if (face == 3u) return vec3(-q.x, q.z, -q.y);
    if (face == 4u) return vec3(-q.x, q.y, q.z);
    return vec3(q.x, q.y, -q.z);
}

// The face that looks the way of `q`. Of equal components z goes before y before x, as drivers have it for cube maps; of
// nothing at all face 4.
inline uint abufferFaceOf(vec3 q) {
    const vec3 a = abs(q);
    if (a.z >= a.x && a.z >= a.y) return q.z >= 0.0f ? 4u : 5u;
    if (a.y >= a.x) return q.y >= 0.0f ? 2u : 3u;
    return q.x >= 0.0f ? 0u : 1u;
}

// The interval of depths [zMin, zMax] in `buckets` equal parts: which of them a depth lies in. Of an interval without extent
// the first; depths beyond its ends count to the outer ones.
inline uint abufferBucket(float z, float zMin, float zMax, uint buckets) {
    const float extent = zMax - zMin;
    const float at = extent > 0.0f ? (z - zMin) / extent * float(buckets) : 0.0f;
    return uint(clamp(at, 0.0f, float(buckets - 1u))); // clamped before: what is out of a whole number's range has no value
}

// Shifted boundaries: the buckets of `count` fragments, in order of depth, hold equally many but for one; which of them holds
// fragment `index`. Of fewer fragments than buckets each has its own, and the last buckets none.
inline uint abufferShiftedBucket(uint index, uint count, uint buckets) {
    return count <= buckets ? index : index * buckets / count;
}

SHARED_END
