// The nearest blended surfaces at each pixel, one by one (Everitt, "Interactive Order-Independent
// Transparency", 2001): each layer draws the scene once more, without what the layers before have. What lies
// behind the last layer is lost, and so are all but one of surfaces at one depth.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class DepthPeeling final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int layers = 4;
};

} // namespace kestrel
