// Tracing through a Bvh on the CPU: what the GLSL traversal is held against, by the same formulas
// (shaders/shared/triangle.h).
#pragma once
#include "scene/bvh.h"
#include <functional>
#include <limits>
#include <optional>

namespace kestrel {

struct BvhRay {
    glm::vec3 origin{0}, direction{0, 0, -1};                      // t counts in lengths of the direction
    float tMin = 0, tMax = std::numeric_limits<float>::infinity(); // both included
};

struct BvhHit {
    float t = 0;
    float u = 0, v = 0;         // barycentric weights of the second and third corner
    std::uint32_t triangle = 0; // index in the Geometry
    friend bool operator==(const BvhHit&, const BvhHit&) = default;
};

// Triangles count from both sides; no alpha test. Among hits at one distance the lowest triangle is the
// closest.
std::optional<BvhHit> closestHit(const Bvh& bvh, const BvhRay& ray);
bool anyHit(const Bvh& bvh, const BvhRay& ray);
// Hands every hit to `visit`, in no particular order, until that returns true.
void allHits(const Bvh& bvh, const BvhRay& ray, const std::function<bool(const BvhHit&)>& visit);

} // namespace kestrel
