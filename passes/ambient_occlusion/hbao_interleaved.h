// Horizon-based ambient occlusion on a deinterleaved depth: Bavoil and Jansen, "Particle Shadows &
// Cache-Efficient Post-Processing", 2013.
#pragma once
#include "graph/registry.h"

namespace kestrel {

// Each pixel marches along directions of its own, in steps of four pixels, so that it meets only pixels of
// its own place in the 4 x 4 pattern. These are the neighbours of a layer of a quarter of the resolution: 16
// layers, each with one jitter for all of its pixels. What is found does not depend on `deinterleaved`:
// without it the same pixels are read where they lie.
class HbaoInterleaved final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int directions = 8;
    int steps = 4;
    float radius = 0.75f;
    float bias = 0.1f;
    float exponent = 2;
    float maximumRadius = 512;
    bool deinterleaved = true;

private:
    void split(Commands& commands) const;
    void occlude(Commands& commands) const;
};

} // namespace kestrel
