// Tunes what is free of a sweep's points on its training scenes, then judges default and tuned on all of
// them.
#pragma once
#include "measure/sweep_run.h"

namespace kestrel {

// Does what `folder` does not hold yet, of the points of the shard: point I - 1 modulo N is shard I's, with
// its tuning and its judging. Each measurement is in the folder before the next begins. Errors are the same
// however often they are measured; a time near the limit may fall to either side of it, but once it is
// measured it stays. A setting that fails is no good and is noted; a default that fails ends its point's
// tuning. Throws InputError for a scene or a reference that fails.
void runTuning(const Sweep& sweep, const std::vector<SweepPoint>& points, const Registry& registry,
               gl::Context& context, const SweepMachine& machine, const SweepFolder& folder,
               const SweepOptions& options);

} // namespace kestrel
