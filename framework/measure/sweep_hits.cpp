#include "measure/sweep_hits.h"
#include "shared/ray.h"
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace kestrel {

std::vector<float> hitDistances(std::span<const std::byte> hits, std::span<const std::byte> rays) {
    const size_t count = rays.size() / sizeof(shared::RayRecord);
    if (hits.size() == count * sizeof(float)) { // distances alone
        std::vector<float> distances(count);
        std::memcpy(distances.data(), hits.data(), hits.size());
        return distances;
    }
    std::vector<float> distances(hits.size() / sizeof(shared::HitRecord));
    for (size_t i = 0; i < distances.size(); ++i) {
        shared::HitRecord record;
        std::memcpy(&record, hits.data() + i * sizeof(record), sizeof(record));
        distances[i] = record.t;
    }
    return distances;
}

SweepRayFigures compareHits(std::span<const std::byte> rays, const std::vector<float>& distances,
                            const std::vector<float>& reference) {
    const size_t count = rays.size() / sizeof(shared::RayRecord);
    if (distances.size() != count || reference.size() != count)
        throw InputError(
            fmt::format("{} rays, {} hits and {} hits of the reference cannot be held against each "
                        "other",
                        count, distances.size(), reference.size()));
    double exist = 0, hit = 0, agree = 0, both = 0, error = 0;
    for (size_t i = 0; i < count; ++i) {
        shared::RayRecord ray;
        std::memcpy(&ray, rays.data() + i * sizeof(ray), sizeof(ray));
        if ((ray.flags & 1U) == 0) continue;
        const bool here = std::isfinite(distances[i]), there = std::isfinite(reference[i]);
        exist += 1;
        hit += here ? 1 : 0;
        agree += here == there ? 1 : 0;
        if (!here || !there || !(reference[i] > 0) || !(distances[i] > 0)) continue;
        both += 1;
        error += std::abs(static_cast<double>(distances[i]) - reference[i]) / reference[i];
    }
    SweepRayFigures figures;
    figures.rays = exist;
    figures.hitShare = exist > 0 ? hit / exist : 0;
    figures.agreement = exist > 0 ? agree / exist : 1;
    if (both > 0) figures.distanceError = error / both;
    return figures;
}

} // namespace kestrel
