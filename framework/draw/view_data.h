// The view of an image as shaders know it (shared/view.h). Needs no GL.
#pragma once
#include "graph/types.h"
#include "scene/geometry.h"
#include "shared/view.h"

namespace kestrel {

using shared::FrameData;
using shared::ViewData;

// A frame as far as views depend on it.
struct ViewFrame {
    Extent size; // of the frame, pixels
    std::uint32_t index = 0;
    CameraState camera, previousCamera; // previous: of the last frame; equal if there is none
};

// The view of an image of `extent` pixels made with `view`.
//
// A pixel of the image covers exactly divisor x divisor pixels of the frame, whatever the frame's size, and
// lies floor(guard / divisor) pixels further in than without a guard band: the inner part of a guarded image
// is the unguarded image. The last column and row may reach past the frame where the divisor does not divide
// it.
ViewData viewData(const View& view, const Extent& extent, const ViewFrame& frame);

// As above from the executor's FrameInfo, or anything with these members.
template<class Frame>
ViewData viewData(const View& view, const Extent& extent, const Frame& frame) requires requires {
    frame.cameraState;
    frame.previousCameraState;
}
{
    return viewData(view, extent,
                    ViewFrame{frame.size, frame.index, frame.cameraState, frame.previousCameraState});
}

// Offset of the samples of frame `index`, in pixels, each in (-0.5, 0.5): Halton points of bases 2 and 3
// around their mean. They repeat after jitterPeriod frames, so that an exponential history sees all of them.
inline constexpr std::uint32_t jitterPeriod = 64;
glm::vec2 jitterOf(std::uint32_t index);

} // namespace kestrel
