// Rays through a depth buffer: McGuire and Mara, "Efficient GPU Screen-Space Ray Tracing", 2014.
#pragma once
#include "graph/pass.h"
#include "graph/registry.h"

namespace kestrel {

// Marches over the pixels between a ray's ends. It knows only what the image shows, so it serves best near
// the ray's origin, as the near half of a NearFarTracer: leaving the image or running out of steps is a miss.
class ScreenTrace final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int steps = 64;
    float stride = 1;
    bool jitter = false;
    // The best on `blob` that keeps an open plane open.
    float thickness = 0.1f;
    float offset = 0.5f;
};

} // namespace kestrel
