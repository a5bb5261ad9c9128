// Ambient occlusion over a G-buffer by the reference tracer.
#pragma once
#include "image/image.h"
#include "reference/rows.h"
#include "reference/tracer.h"
#include <cstdint>
#include <limits>

namespace kestrel {

// Images of one size, rows in any order (the result has the same).
struct OcclusionInputs {
    Image position;   // 3 or 4 channels: render space
    Image normal;     // 3 or 4: the axis of the hemisphere, unit; zero where there is no geometry
    Image faceNormal; // 3: the surface itself, unit, on the same side; 4: and how far along it rays start
                      // (rayStart() of shared/ray.h). Empty: the same as `normal`
};

struct OcclusionSettings {
    int samples = 256;                                              // a pixel, rounded up to an even number
    float maximumDistance = std::numeric_limits<float>::infinity(); // occluders farther away do not count
    std::uint32_t seed = 0;
    int threads = 2; // the result does not depend on it
    // How far a ray starts off the surface along the face normal where the input does not tell it, relative
    // to the largest of the position's components and the radius of the geometry's bounds: above the rounding
    // of a position that went through a depth buffer.
    float relativeOffset = 0x1p-15f;
    Progress progress;
};

struct OcclusionResult {
    // One channel: the share of the cosine-weighted hemisphere that sees out, 0 to 1; exactly 1 without
    // geometry.
    Image visibility;
    // Standard error of `visibility`: half the root mean square difference, over pixels with geometry, of the
    // means of two independent halves of the samples. 0 without geometry.
    double noise = 0;
    std::uint64_t rays = 0;
};

// Directions are cosine-distributed around `normal` (scrambled Sobol points, a scramble for each pixel and
// half); one that points below `faceNormal` starts inside the surface, is not traced and counts as occluded.
// The result is a function of the inputs, the geometry and the settings but threads. Throws InputError if the
// images do not fit.
OcclusionResult ambientOcclusion(const ReferenceTracer& tracer, const OcclusionInputs& inputs,
                                 const OcclusionSettings& settings);

} // namespace kestrel
