// Triangles that lie on each other corner by corner.
#pragma once
#include "scene/geometry.h"
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace kestrel {

// Groups of triangles with the same three corners, in whatever order. A tracer meets them at one distance and
// names any of them (which one may depend on the processor); by the rule of framework/scene/bvh_trace.h the
// lowest is met.
class CoincidentTriangles {
public:
    explicit CoincidentTriangles(const Geometry& geometry);
    [[nodiscard]] bool none() const { return groupOf_.empty(); }
    // All that lie where this one lies, itself included, in ascending order; empty: no other does.
    [[nodiscard]] std::span<const std::uint32_t> with(std::uint32_t triangle) const;

private:
    std::unordered_map<std::uint32_t, std::uint32_t> groupOf_;
    std::vector<std::vector<std::uint32_t>> groups_;
};

} // namespace kestrel
