// Bounds over the whole timeline, in world space.
#pragma once
#include "scene/scene.h"

namespace kestrel {

// A box and a sphere around its centre that contain every vertex at every time; `empty` if there is none.
struct TimelineBounds {
    glm::dvec3 min{0}, max{0};
    double radius = 0;
    bool empty = true;
    [[nodiscard]] glm::dvec3 centre() const { return 0.5 * (min + max); }
};

// The bounds of the scene's instances under `rootTransform` (in the place of the scene's own). What stands
// still is exact. What moves is taken at all keys and at three or seven times between two keys, for each
// vertex, and widened by half the second difference of its path (four times what a parabola bulges between
// samples), so that linear motion stays exact. Where that would cost too much, the corners of boxes (one a
// joint for skins) take the place of the vertices: looser, still containing all of them.
TimelineBounds timelineBounds(const Scene& scene, const glm::dmat4& rootTransform);

} // namespace kestrel
