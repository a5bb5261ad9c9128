// How rays are marched through a distance field (DistanceField). All lengths are in cells of the map.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// The uniform block `Settings` (std140).
struct DistanceFieldSettings {
    float threshold;    // at this distance from the centre of an occupied cell a ray hits it
    float originOffset; // along the ray's normal
    float skip;         // along the ray: how far rays from a surface go before anything counts
    float scale;        // of steps
    float leastStep;
    float margin;       // in cells of a level: how far away an occupied cell must be for that level to be sampled
    float widening;     // of a ray that coarsens with the distance travelled: its width over that distance
    float pad;
};

SHARED_END
