#include "scene/bvh_trace.h"
#include "shared/triangle.h"
#include <array>
#include <bit>
#include <utility>

namespace kestrel {
namespace {

// Walks down to every leaf whose box the ray meets before `tMax` (which `leaf` may lower), the nearer child
// first. `leaf` gets one triangle at a time and returns true to stop.
template<class Leaf>
void traverse(const Bvh& bvh, const TraceRay& ray, const float& tMax, Leaf&& leaf) {
    struct Entry {
        std::uint32_t reference;
        float entry;
    };
    std::array<Entry, shared::bvhStackSize> stack;
    std::size_t size = 0;
    const glm::vec3 inverse = shared::inverseDirection(ray.direction);
    std::uint32_t reference = 0;
    for (;;) {
        bool descend = false;
        if (shared::bvhIsLeaf(reference)) {
            const std::uint32_t first = shared::bvhLeafFirst(reference);
            for (std::uint32_t i = 0; i < shared::bvhLeafCount(reference); ++i)
                if (leaf(bvh.triangles[first + i])) return;
        } else {
            const auto& children = bvh.nodes[reference].children;
            Entry hit[2];
            bool met[2];
            for (int k = 0; k < 2; ++k) {
                hit[k].reference = children[k].reference;
                met[k] = shared::intersectBox(ray.origin, inverse, ray.tMin, tMax, children[k].min,
                                              children[k].max, hit[k].entry);
            }
            const int nearer = met[0] && (!met[1] || hit[0].entry <= hit[1].entry) ? 0 : 1;
            if (met[0] && met[1]) stack[size++] = hit[1 - nearer];
            descend = met[0] || met[1];
            reference = hit[nearer].reference;
        }
        while (!descend) {
            if (size == 0) return;
            --size;
            reference = stack[size].reference;
            descend = stack[size].entry <= tMax;
        }
    }
}

BvhTriangle triangleOf(const WideItem& item) {
    const auto corner = [&](std::size_t i) { return glm::uintBitsToFloat(glm::uvec3(item.texels[i])); };
    return {corner(0), item.texels[0].w, corner(1), item.texels[1].w, corner(2), item.texels[2].w};
}

// The nearest child first, the others of a node in any order.
template<class Leaf>
void traverse(const WideBvh& bvh, const TraceRay& ray, const float& tMax, Leaf&& leaf) {
    std::array<std::uint32_t, shared::wideStackSize> stack;
    std::size_t size = 0;
    const shared::WideRay boxes = shared::wideRay(shared::inverseDirection(ray.direction));
    std::uint32_t at = 0, waiting = 0;
    for (;;) {
        const WideItem& item = bvh.items[at];
        std::uint32_t met = 0;
        glm::ivec4 entries;
        if ((item.texels[0].w & shared::wideNode) == 0) {
            if (leaf(triangleOf(item))) return;
        } else {
            met = shared::wideMet(boxes, ray.origin, ray.tMin, tMax, item.texels[0], item.texels[1],
                                  item.texels[2], entries);
        }
        std::uint32_t next = std::countr_zero(waiting);
        if (met != 0) {
            if ((waiting & 15u) != 0) stack[size++] = waiting;
            waiting = shared::wideChildren(item.texels[1].w, met);
            for (std::uint32_t k = next = std::countr_zero(met); k < 4; ++k)
                if ((met >> k & 1u) != 0 && entries[static_cast<int>(k)] < entries[static_cast<int>(next)])
                    next = k;
        } else if ((waiting & 15u) == 0) {
            if (size == 0) return;
            waiting = stack[--size];
            next = std::countr_zero(waiting);
        }
        at = ((waiting >> 4) + shared::wideTexelOf(1u << next)) / shared::wideTexels;
        waiting &= ~(1u << next);
    }
}

std::optional<TraceHit> intersect(const shared::TriangleRay& ray, float tMin, float tMax,
                                  const BvhTriangle& triangle) {
    shared::TriangleHit hit{};
    if (!shared::intersectTriangle(ray, tMin, tMax, triangle.p0, triangle.p1, triangle.p2, hit))
        return std::nullopt;
    return TraceHit{hit.t, hit.u, hit.v, triangle.triangle};
}

template<class Tree>
std::optional<TraceHit> nearest(const Tree& bvh, const TraceRay& ray) {
    const shared::TriangleRay sheared = shared::triangleRay(ray.origin, ray.direction);
    std::optional<TraceHit> best;
    float tMax = ray.tMax;
    traverse(bvh, ray, tMax, [&](const BvhTriangle& triangle) {
        const auto hit = intersect(sheared, ray.tMin, tMax, triangle);
        if (hit && (!best || hit->t < best->t || hit->triangle < best->triangle)) {
            best = hit;
            tMax = hit->t;
        }
        return false;
    });
    return best;
}

template<class Tree>
bool any(const Tree& bvh, const TraceRay& ray) {
    const shared::TriangleRay sheared = shared::triangleRay(ray.origin, ray.direction);
    bool found = false;
    traverse(bvh, ray, ray.tMax, [&](const BvhTriangle& triangle) {
        found = intersect(sheared, ray.tMin, ray.tMax, triangle).has_value();
        return found;
    });
    return found;
}

template<class Tree>
void all(const Tree& bvh, const TraceRay& ray, const std::function<bool(const TraceHit&)>& visit) {
    const shared::TriangleRay sheared = shared::triangleRay(ray.origin, ray.direction);
    traverse(bvh, ray, ray.tMax, [&](const BvhTriangle& triangle) {
        const auto hit = intersect(sheared, ray.tMin, ray.tMax, triangle);
        return hit && visit(*hit);
    });
}

} // namespace

std::optional<TraceHit> closestHit(const Bvh& bvh, const TraceRay& ray) { return nearest(bvh, ray); }
bool anyHit(const Bvh& bvh, const TraceRay& ray) { return any(bvh, ray); }
void allHits(const Bvh& bvh, const TraceRay& ray, const std::function<bool(const TraceHit&)>& visit) {
    all(bvh, ray, visit);
}
std::optional<TraceHit> closestHit(const WideBvh& bvh, const TraceRay& ray) { return nearest(bvh, ray); }
bool anyHit(const WideBvh& bvh, const TraceRay& ray) { return any(bvh, ray); }
void allHits(const WideBvh& bvh, const TraceRay& ray, const std::function<bool(const TraceHit&)>& visit) {
    all(bvh, ray, visit);
}

} // namespace kestrel
