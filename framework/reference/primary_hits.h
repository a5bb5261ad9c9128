// What a camera sees, traced: a G-buffer to hold the rasterized one against.
#pragma once
#include "image/image.h"
#include "reference/rows.h"
#include "reference/tracer.h"
#include <vector>

namespace kestrel {

// Rows top to bottom, rays through the middles of the pixels. Pixels without geometry hold zeros.
struct PrimaryHits {
    Image depth; // 1 channel: reversed z, 1 at the near plane, 0 at the far plane and where nothing was hit
    Image viewDepth;                      // 1: distance along the camera's axis
    Image position;                       // 3: render space
    Image normal;                         // 3: interpolated, unit, on the side of the camera
    Image faceNormal;                     // 3: of the triangle, unit, on the side of the camera
    std::vector<std::uint32_t> triangles; // TraceHit::none where nothing was hit
};

// `geometry` is what the tracer was built from. Both sides of triangles are seen; hits before the near and
// behind the far plane are not.
PrimaryHits primaryHits(const ReferenceTracer& tracer, const Geometry& geometry, const CameraState& camera,
                        int width, int height, int threads = 2);

// The rays of one row of pixels, `y` from the top; t is the distance along the camera's axis.
std::vector<TraceRay> cameraRays(const CameraState& camera, int width, int height, int y);

} // namespace kestrel
