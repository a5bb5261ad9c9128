// Rays through the pixels of an A-buffer (Vardis, Vasilakis, Papaioannou 2016, section 3.4).
#pragma once
#include "graph/registry.h"

namespace kestrel {

class ABuffer final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    bool skipping = true;
    double thickness = 1, offset = 1.5;
    bool countExhausted = false;
};

} // namespace kestrel
