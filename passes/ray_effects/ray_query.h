// A buffer of rays through a tracer into a buffer of hits: the one place where tracing alone is timed and
// compared ray by ray, since tracers are compiled into their consumers.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class RayQuery final : public Pass {
public:
    enum class Query { Any, Closest };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    Query query = Query::Any;
    bool snap = false;

private:
    [[nodiscard]] static std::uint64_t rayCount(const Desc& rays);
};

} // namespace kestrel
