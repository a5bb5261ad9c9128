// The layout (std430) of ray and hit buffers.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

struct RayRecord {
    vec3 origin;
    float tMin;
    vec3 direction;
    float tMax;      // infinite: unbounded
    vec3 normal;     // at the origin; zero: the ray does not start on a surface
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
