// The nearest blended surfaces at each pixel by drawing twice, however many they are: the depths sink through
// slots by atomic minima, and then find their triangles (Bavoil et al., "Multi-Fragment Effects on the GPU
// using the k-Buffer", 2007, has the idea; slots by atomics are Liu et al.'s). What is behind the last slot
// is dropped, not merged: what it would have let through is let through.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class KBuffer final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int slots = 8;
};

} // namespace kestrel
