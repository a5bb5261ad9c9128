// The G-buffer: what the camera sees first, one texture a quantity; only what somebody reads is made.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class GBuffer final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int divisor = 1;
    int guard = 0;
    bool jitter = false;
    enum class BlendedSurfaces { Masked, LeftOut };
    BlendedSurfaces blended = BlendedSurfaces::Masked;

private:
    [[nodiscard]] View view() const {
        return {.source = {}, .divisor = divisor, .guard = guard, .jitter = jitter};
    }
};

} // namespace kestrel
