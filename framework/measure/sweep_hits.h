// How the hits of a tracer agree with the reference's, ray by ray.
#pragma once
#include "measure/sweep_results.h"
#include <cstddef>
#include <span>
#include <vector>

namespace kestrel {

// The distance of each hit of `rays` in a buffer of records (shared/ray.h, HitRecord) or of distances alone:
// infinite where nothing was hit, 0 for the hits of any-hit queries.
std::vector<float> hitDistances(std::span<const std::byte> hits, std::span<const std::byte> rays);

// How hits agree with the reference's on the same rays (shared/ray.h, RayRecord); rays that do not exist do
// not count. Throws InputError if the counts differ.
SweepRayFigures compareHits(std::span<const std::byte> rays, const std::vector<float>& distances,
                            const std::vector<float>& reference);

} // namespace kestrel
