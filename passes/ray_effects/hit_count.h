// Counts every hit along each pixel's ray: the depth complexity of a view, and the plainest consumer of
// `hits`.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class HitCount final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int divisor = 1;
};

} // namespace kestrel
