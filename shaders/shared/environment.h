// Light from the surroundings by direction.
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

// std140. The intensity is multiplied in but for a picture.
struct EnvironmentSettings {
    vec3 zenith;
    float rotation; // of a picture about +y, radians
    vec3 horizon;   // or the one colour
    float intensity;
    vec3 ground;
    float pad0;
};

// A gradient from the horizon to the zenith by height, and one colour below, at unit `direction`; +y is up. Just below the
// horizon both meet within 1/50, so that no ray sees a step.
inline vec3 gradientEnvironment(vec3 zenith, vec3 horizon, vec3 ground, vec3 direction) {
    float up = clamp(direction.y, 0.0f, 1.0f);
    float below = clamp(-50.0f * direction.y, 0.0f, 1.0f);
    vec3 sky = horizon + (zenith - horizon) * sqrt(up);
    return sky + (ground - sky) * below;
}

SHARED_END
