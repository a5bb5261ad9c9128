// A bounding volume hierarchy of four children a node with quantized boxes, for traversal in GLSL.
#pragma once
#include "scene/bvh.h"
#include "shared/wide_bvh.h"
#include <vector>

namespace kestrel {

// An inner node or a triangle: three texels of 16 bytes; see shaders/shared/wide_bvh.h.
struct WideItem {
    glm::uvec4 texels[3];
};
static_assert(sizeof(WideItem) == 48);

struct WideBvh {
    std::vector<WideItem> items; // at least one; children behind their parent
    int depth = 0;               // inner nodes on the longest way down, at most shared::wideStackSize
};

// The most items that any build of so many triangles can need.
std::uint64_t mostWideItems(std::uint64_t triangles);

// Fits the boxes to geometry that has moved since the tree was built or fitted last: the same triangles (as
// many, of the same materials and classes), whose places alone may differ. Hits are those of a tree built
// anew, but for the order of `all`; how good the tree still is, expectedVisits() tells.
void refit(WideBvh& wide, const Geometry& geometry);

// Items that a ray through the root's box is expected to visit, by the surface area heuristic.
double expectedVisits(const WideBvh& wide);

// Merges the levels of a binary tree with leaves of one triangle (BvhSettings::maxLeaf) so that the surface
// area heuristic expects the fewest visits.
WideBvh widened(const Bvh& binary);

} // namespace kestrel
