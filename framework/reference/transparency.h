// Blended surfaces over an opaque picture, by all that the reference tracer meets along each pixel's ray:
// what the passes of passes/transparency are measured against.
#pragma once
#include "image/image.h"
#include "reference/gather.h"

namespace kestrel {

struct TransparencySettings {
    bool shadows = true;     // false: light passes through everything
    bool emission = true;    // surfaces send out their emission too
    bool highlights = false; // and what point, spot and directional lights reflect specularly
    glm::vec3 ambient{0};    // radiance that arrives from all sides besides
    int samples = 64;        // points on area lights for each surface
    std::uint32_t seed = 0;
    int threads = 2; // the result does not depend on it
    Progress progress;
};

struct TransparencyResult {
    Image picture;  // 4 channels: radiance, and how much of the pixel is covered
    Image surfaces; // 1 channel: blended surfaces that lie before what is opaque
};

// `seen` is a tracer of the same geometry with blended materials wherever their alpha is above 0; that of
// `scene` answers shadow rays. `opaque` has 3 or 4 channels (without a fourth all is covered) and rows from
// the top; rays go through the middles of its pixels. Surfaces are met in the order of their depths, equal
// ones in that of their triangles; back sides of single-sided materials are not there. A surface of colour c
// and alpha a leaves a c + (1 - a) b of what is behind it, b. It shines
// as for one bounce: diffusely, with its emission, and with highlights; an unlit one in its base colour.
TransparencyResult compositeBlended(const GatherScene& scene, const ReferenceTracer& seen,
                                    const CameraState& camera, const Image& opaque,
                                    const TransparencySettings& settings);

} // namespace kestrel
