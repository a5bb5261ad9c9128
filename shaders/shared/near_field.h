// Settings of the tracers for what is near (ScreenTrace, NearFarTracer): uniform blocks `Settings` (std140).
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

struct ScreenTraceSettings {
    float stride;    // pixels from one sample to the next
    float thickness; // of what the depth buffer shows, along the viewing axis, in heights of the view at its distance
    float offset;    // of a ray's origin along its normal, in widths of a pixel there
    float pad;
};

struct NearFarSettings {
    float reach; // scene units along the ray: where the far tracer takes over
    float pad0;
    float pad1;
    float pad2;
};

SHARED_END
