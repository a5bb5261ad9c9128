// The view of an image as shaders know it (shared/view.h). Needs no GL.
#pragma once
#include "graph/types.h"
#include "scene/geometry.h"
#include "shared/view.h"

namespace kestrel {

using shared::FrameData;
using shared::ViewData;

// A moment of the scene as far as where views look from depends on it.
struct ViewMoment {
    const Scene* scene = nullptr; // null: views of its cameras cannot be asked for
    double time = 0;
    const std::vector<LightState>* lights = nullptr; // null: there are none
    Sphere bounds;                                   // of the scene over its timeline
    CameraState camera;                              // the frame's
};
// Where a view looks from at that moment. Throws InputError if the scene has no such camera (with the near
// name), light or face.
CameraState cameraOf(const View& view, const ViewMoment& moment);

// A frame as far as a view depends on it.
struct ViewFrame {
    Extent size; // of the frame, pixels
    std::uint32_t index = 0;
    CameraState camera, previousCamera; // cameraOf() the view; previous: in the last frame, or equal
};

// The view of an image of `extent` pixels made with `view`. What `size` means for square views: sizeOf().
//
// A pixel of the image covers exactly divisor x divisor pixels of the frame, whatever the frame's size, and
// lies floor(guard / divisor) pixels further in than without a guard band: the inner part of a guarded image
// is the unguarded image. The last column and row may reach past the frame where the divisor does not divide
// it.
ViewData viewData(const View& view, const Extent& extent, const ViewFrame& frame);

// Offset of the samples of frame `index`, in pixels, each in (-0.5, 0.5): Halton points of bases 2 and 3
// around their mean. They repeat after jitterPeriod frames, so that an exponential history sees all of them.
inline constexpr std::uint32_t jitterPeriod = 64;
glm::vec2 jitterOf(std::uint32_t index);

} // namespace kestrel
