// The sum of up to four modules `radiance`, itself one: direct light and its reflections, say, or both and a
// sky.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class RadianceSum : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
};

} // namespace kestrel
