// Ambient occlusion from samples on a disc around a surface point that faces the eye: volumetric (Loos and Sloan, "Volumetric
// Obscuration", 2010) and horizon-based (Bavoil, Sainz, Dimitrov, "Image-Space Horizon-Based Ambient Occlusion", 2008).
#pragma once
#include "shared/glsl_types.h"

SHARED_BEGIN

const uint kernelVao = 0u;
const uint kernelHbao = 1u;
const uint maxDiscSamples = 32u;

// The uniform block `Settings` (std140).
struct OcclusionKernel {
    float radius;        // scene units
    float exponent;      // of the result
    float thickness;     // in radii: how far before the sphere occluders still count whole
    float cutoff;        // pixels of the frame: samples nearer than that on screen are not refined
    float maximumRadius; // pixels of the frame
    uint kernel;         // kernel…
    uint samples;
    float pad0;
    // On the unit disc: x, y; half the sphere's chord there; one over the sample's density.
    vec4 disc[32];
};

SHARED_END
