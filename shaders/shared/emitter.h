// The layout of a buffer of emitters, as rgba32f texels: what shines from an area, to be chosen from.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

struct EmitterRecord {
    vec3 corner;       // of a parallelogram or triangle; a sphere's centre
    float kind;        // emitter…
    vec3 u;            // first edge; of a sphere: the radius in x
    float upper;       // sum of the probabilities up to this one
    vec3 v;            // second edge; it shines to the side of cross(u, v)
    float probability;
    vec3 radiance;
    float bothSides;   // 1: to the other side too
};
const uint emitterRecordTexels = 4u;

const float emitterParallelogram = 0.0f;
const float emitterTriangle = 1.0f;
const float emitterSphere = 2.0f;

SHARED_END
