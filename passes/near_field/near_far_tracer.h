// A tracer made of two: the hybrid that the ROMA paper leaves as future work (section 8).
#pragma once
#include "graph/pass.h"
#include "graph/registry.h"

namespace kestrel {

// Asks one tracer up to a distance along the ray and another beyond. The far one aims and may snap; the near
// one must be able to trace the direction that comes of it, so it may not always snap (one that merely can is
// asked not to). What the near tracer misses before `reach` stays missed, also where it ran out of steps.
class NearFarTracer final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    float reach = 0.05f; // the best of a sweep on `blob` with the screen near and ROMA far
    bool relative = true;
};

} // namespace kestrel
