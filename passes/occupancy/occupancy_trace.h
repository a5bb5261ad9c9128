// Tracing by walking through an occupancy map: what a ray-aligned occupancy map array is measured against.
#pragma once
#include "graph/pass.h"
#include "graph/registry.h"

namespace kestrel {

enum class TraceMethod : std::uint8_t {
    Dda3d, // from cell to cell (Amanatides and Woo 1987)
    Dda2d, // from column to column, testing many cells of one at once (Thiedemann et al. 2011)
    Bricks // from brick of 2 x 2 x 2 cells to brick, over empty cubes of them at once
};

// Provides `tracer`: any and closest hits of exact directions, each up to a cell off (Hit::error). All
// methods find the same cells to the bit. See shaders/occupancy/occupancy_trace.glsl.
class OccupancyTrace final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    TraceMethod method = TraceMethod::Bricks;
    bool mips = true;
    int iterations = 1024;
    // Within 0.003 of the least error of visibility (0.068 of 1 at 64 cells, 0.060 at 128, `blob`) in a sweep
    // of both, offset 0 to 1.5 and skip 0 to 3; the same as Roma's, so that the two differ in the tracing
    // alone.
    float offset = 0.5f;
    float skip = 2;
    bool countExhausted = false;

private:
    void uploadSettings(Commands& commands) const;
    void declareColumns(const World& world, int resolution, Declaration& declaration, Module& tracer) const;
    static void declareBricks(const World& world, const Desc& map, int resolution, Declaration& declaration,
                              Module& tracer);
};

} // namespace kestrel
