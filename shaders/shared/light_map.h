// Maps made from lights (shadow maps, reflective shadow maps): how their faces lie, the same for C++, drawing and lookup.
//
// A map has faces in consecutive layers of an array. In the map's axes face 0 looks along +z, then 1 +x, 2 -x, 3 +y, 4 -y,
// 5 -z: one face serves a spot light, five the half space before a rectangle, six all directions; 0 faces stands for one
// layer of parallel rays along z. Of a directional light there may be further such maps, smaller and smaller, about what a
// camera sees from near.
#pragma once
#include "shared/scene.h"

SHARED_BEGIN

struct LightMap {
    vec3 axisX; // unit, orthogonal
    uint faces;
    vec3 axisY;
    uint firstLayer;
    vec3 axisZ;
    float nearPlane;    // of perspective faces: nothing nearer is in the map
    vec3 origin;        // where the rays meet, or a point on the middle one of parallel rays
    float halfWidth;    // tangent of half a face's angle, or half a parallel map's width in scene units
    vec2 jitter;        // added to the position on the face in [-1, 1]^2
    float inverseRange; // of parallel rays: one over the distance from depth 1 to depth 0
    float farEnd;       // of parallel rays: where depth is 0, along them from the origin
};

// How many lights of each kind a block holds, and what lookups need besides.
struct LightMapCounts {
    uint points;
    uint spots;
    uint directionals;
    uint rectangles;
    uint spheres;
    float bias; // in texels, or as a factor: the pass's own
    uint pad0;
    uint pad1;
};

// What the map's axes make of a render-space position.
inline vec3 lightMapLocal(vec3 axisX, vec3 axisY, vec3 axisZ, vec3 offset) {
    return vec3(dot(axisX, offset), dot(axisY, offset), dot(axisZ, offset));
}

// The face of six that sees a local position.
inline uint lightMapFace(vec3 local) {
    vec3 size = abs(local);
    if (size.z >= size.x && size.z >= size.y) return local.z < 0.0f ? 5u : 0u;
    if (size.x >= size.y) return local.x < 0.0f ? 2u : 1u;
    return local.y < 0.0f ? 4u : 3u;
}

// A local position or direction as a face sees it: to its right, up, and forward.
inline vec3 lightMapTurned(vec3 local, uint face) {
    float ahead = face == 2u || face == 4u || face == 5u ? -1.0f : 1.0f;
    if (face == 1u || face == 2u) return vec3(local.y, local.z, ahead * local.x);
    if (face == 3u || face == 4u) return vec3(local.z, local.x, ahead * local.y);
    return vec3(local.x, local.y, ahead * local.z);
}

SHARED_END
