// Rays through the pixels of an A-buffer: through fragments (Vardis, Vasilakis, Papaioannou, "A Multiview and
// Multilayer Approach for Interactive Ray Tracing", I3D 2016, section 3.4), or through the primitives that
// each pixel sees, with an exact test at the hit (the same authors, "DIRT: Deferred Image-based Ray Tracing",
// HPG 2016).
#pragma once
#include "graph/registry.h"

namespace kestrel {

enum class ABufferRecord : std::uint8_t { Fragment, Primitive };

class ABuffer final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    ABufferRecord record = ABufferRecord::Fragment;
    bool skipping = true;
    double thickness = 1, offset = 1.5;
    bool countExhausted = false;

private:
    void declareFragments(Declaration& declaration, const Inputs& inputs, const Demand& demand,
                          Module& tracer) const;
};

} // namespace kestrel
