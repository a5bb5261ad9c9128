// The tracer that traces nothing: what remains of an effect's time is what it does besides.
#pragma once
#include "graph/pass.h"
#include "graph/registry.h"

namespace kestrel {

// Answers every ray alike, whatever the scene: it meets a surface after a set distance, or nothing. An
// effect's time with a tracer less its time with this one is what tracing takes in it.
class ConstantTracer final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    // Nothing is made, so there is no step.

    float distance = 0.25f;
};

} // namespace kestrel
