// Rays that leave surfaces, and the layout (std430) of ray and hit buffers.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// Whether a ray of this direction leaves the face with this normal (both unit) that it starts on. A direction below the
// horizon, or along it as far as float can tell, does not: it is not traced, and nothing arrives along it.
inline bool leavesFace(vec3 direction, vec3 face) { return dot(direction, face) > 1e-6f; }

// How far along the normal of its face a ray has to start so that rounding does not take it back onto the face. Each part
// is what one error depends on: the depth of the pixel (`distance` of the point from the eye), the coordinates of the point
// (`largest` of their magnitudes), and the test against the face, whose corners may lie far away (`reach`, faceReach()).
// Nothing else counts: not the size of the scene.
inline float rayStart(float distance, float largest, float reach) {
    return max(3.0517578e-5f * distance, max(4.7683716e-7f * largest, 9.5367432e-7f * reach)); // 2^-15, 2^-21, 2^-20
}

// Where a ray starts whose origin is already off its face (with this normal, zero if there is none) by what the point's own
// place is uncertain by: off it by the rounding of that too.
inline vec3 offFace(vec3 origin, vec3 normal) {
    const vec3 extent = abs(origin);
    return origin + normal * rayStart(0.0f, max(extent.x, max(extent.y, extent.z)), 0.0f);
}

// How far the corners lie off a point of their plane, each component counted by the normal's: 0 along an axis that the
// normal is perpendicular to, where no rounding moves the plane.
inline float faceReach(vec3 normal, vec3 point, vec3 p0, vec3 p1, vec3 p2) {
    const vec3 n = abs(normal);
    return max(dot(n, abs(p0 - point)), max(dot(n, abs(p1 - point)), dot(n, abs(p2 - point))));
}

struct RayRecord {
    vec3 origin;
    float tMin;
    vec3 direction;
    float tMax;      // infinite: unbounded
    vec3 normal;     // of the face at the origin; zero: the ray does not start on a surface
    uint flags;      // bit 0: the ray exists (a pixel without geometry has none)
};

struct HitRecord {
    float t;       // infinite: nothing was hit; for any-hit queries 0 stands for "something"
    float weight;  // of the direction really traced (lib/tracer.glsl)
    uint idX;      // the tracer's own, as in Hit::id
    uint idY;
    vec3 direction; // really traced
    uint source;
};

SHARED_END
