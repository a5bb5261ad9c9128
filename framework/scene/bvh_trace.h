// Tracing through a Bvh on the CPU: what the GLSL traversal is held against, by the same formulas
// (shaders/shared/triangle.h).
#pragma once
#include "scene/bvh.h"
#include "scene/trace.h"
#include "scene/wide_bvh.h"
#include <functional>
#include <optional>

namespace kestrel {

// Triangles count from both sides; no alpha test. Among hits at one distance the lowest triangle is the
// closest.
std::optional<TraceHit> closestHit(const Bvh& bvh, const TraceRay& ray);
bool anyHit(const Bvh& bvh, const TraceRay& ray);
// Hands every hit to `visit`, in no particular order, until that returns true.
void allHits(const Bvh& bvh, const TraceRay& ray, const std::function<bool(const TraceHit&)>& visit);

// The same through a wide hierarchy, for rays with 0 <= tMin: equal to the bit.
std::optional<TraceHit> closestHit(const WideBvh& bvh, const TraceRay& ray);
bool anyHit(const WideBvh& bvh, const TraceRay& ray);
void allHits(const WideBvh& bvh, const TraceRay& ray, const std::function<bool(const TraceHit&)>& visit);

} // namespace kestrel
