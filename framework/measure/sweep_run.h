// Measures a sweep: renders, holds against the reference, and times the variants in turn.
#pragma once
#include "measure/sweep_results.h"
#include <functional>
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

} // namespace kestrel
