// Rays that leave surfaces, and the layout (std430) of ray and hit buffers.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// Whether a ray of this direction leaves the face with this normal (both unit) that it starts on. A direction below the
// horizon, or along it as far as float can tell, does not: it is not traced, and nothing arrives along it.
inline bool leavesFace(vec3 direction, vec3 face) { return dot(direction, face) > 1e-6f; }

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
