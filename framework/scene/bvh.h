// A bounding volume hierarchy over the triangles of a Geometry, built on the CPU, laid out for traversal in
// GLSL.
#pragma once
#include "scene/geometry.h"
#include "shared/bvh.h"
#include <cstdint>
#include <vector>

namespace kestrel {

// Four texels of 16 bytes; see shaders/shared/bvh.h.
struct BvhNode {
    struct Child {
        glm::vec3 min{0};
        std::uint32_t reference = shared::bvhLeaf(0, 0);
        glm::vec3 max{0};
        std::uint32_t unused = 0;
    };
    Child children[2];
};
static_assert(sizeof(BvhNode) == 64);

// Three texels of 16 bytes.
struct BvhTriangle {
    glm::vec3 p0;
    std::uint32_t triangle; // index in Geometry: indices[3 * triangle], materials[triangle]
    glm::vec3 p1;
    std::uint32_t material;
    glm::vec3 p2;
    std::uint32_t triangleClass; // TriangleClass
};
static_assert(sizeof(BvhTriangle) == 48);

struct Bvh {
    std::vector<BvhNode> nodes;         // at least one; children behind their parent
    std::vector<BvhTriangle> triangles; // in the order of the leaves
    int depth = 0;                      // inner nodes on the longest way down, at most shared::bvhStackSize
};

struct BvhSettings {
    int maxLeaf = 4; // triangles a leaf, 1 to shared::bvhMaxLeaf
    int bins = 16;   // an axis, 2 to 32
    int threads = 2; // the result does not depend on it
};

// Builds by the binned surface area heuristic (Wald, "On fast Construction of SAH-based Bounding Volume
// Hierarchies", 2007). Where that would grow deeper than the stack, where all centroids coincide, or where no
// split is worth its cost, it halves at the median. Degenerate triangles are kept (nothing hits them). The
// result is a function of the geometry and the settings alone.
Bvh buildBvh(const Geometry& geometry, const BvhSettings& settings = {});

} // namespace kestrel
