// Measures a sweep: renders, holds against the reference, and times the variants in turns.
#pragma once
#include "measure/sweep_results.h"
#include <functional>
#include <span>
#include <vector>

namespace kestrel {

namespace gl {
class Context;
}

struct SweepOptions {
    Shard shard;
    std::vector<bool> chosen; // of each point (choosePoints)
    std::function<void(double fraction, const std::string& what)> progress;
};

// Measures what `folder` does not hold yet of the units of the shard, on the current context. The picture of
// each point first; then round after round, each point once a round, so that a machine that slows down
// slows all alike. Each measurement is in the folder before the next begins. A point that fails is noted
// (SweepPicture::failed) and the others go on. Throws InputError for a scene or a reference that fails.
void runSweep(const Sweep& sweep, const std::vector<SweepPoint>& points, const std::vector<SweepUnit>& units,
              const Registry& registry, gl::Context& context, const SweepMachine& machine,
              const SweepFolder& folder, const SweepOptions& options);

// The distance of each hit of `rays` in a buffer of records (shared/ray.h, HitRecord) or of distances alone:
// infinite where nothing was hit, 0 for the hits of any-hit queries.
std::vector<float> hitDistances(std::span<const std::byte> hits, std::span<const std::byte> rays);

// How hits agree with the reference's on the same rays (shared/ray.h, RayRecord); rays that do not exist do
// not count. Throws InputError if the counts differ.
SweepRayFigures compareHits(std::span<const std::byte> rays, const std::vector<float>& distances,
                            const std::vector<float>& reference);

} // namespace kestrel
