// The occupancy map: one bit a cell of a cube around the scene, set where there is a surface.
#pragma once
#include "graph/pass.h"
#include "graph/registry.h"
#include <vector>

namespace kestrel {

struct DrawState;

// How the map is made. The first four rasterize along x, y and z and take the union (ROMA, section 6; Forest
// et al. 2009) and give the same bits: they differ in how fragments of one column come together. Rasterizing
// tests cells' centre lines and so misses cells that a surface only grazes; `Exact` misses none, and
// `Separating` none that a turned map would look through.
enum class OccupancyMethod : std::uint8_t {
    ThreeAxis,        // atomics on the map
    LogicOp,          // integer attachments with the logic operation OR
    Interlock,        // images in a critical section (rasterizer-ordered views)
    FramebufferFetch, // attachments read back in order (rasterizer-ordered views)
    DominantAxis,     // one pass: each triangle along the axis where it covers most
    Exact,            // triangles against cells in compute
    Separating        // triangles in columns of cells in compute
};

class OccupancyMap final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int resolution = 128;
    OccupancyMethod method = OccupancyMethod::Separating;
    bool jitter = false;
    // A marked cell reaches over the surface on both sides. Along the axis that it is marked along, what is w
    // cells thick comes out w + 1 thick on the mean over its place; with its faces `inset` behind, 1 + |w - 2
    // inset|: less for all that is thicker than `inset`. Of 0.15, 0.25, 0.35 and 0.5 the one of least FLIP of
    // ambient occlusion on `tower`, which is thin, and within a hundredth of the least (0.35) on `blob`,
    // `tower`, `hall` and `grove` together; where cells are rasterized that was 0.15 on `blob` and `tower`.
    float inset = 0.25f;

private:
    [[nodiscard]] std::vector<Step> rasterSteps(const World& world) const;
    [[nodiscard]] std::vector<Step> columnSteps(const World& world) const;
    void declareInternals(const Step& step, const World& world, Declaration& declaration) const;
    void uploadGrid(Commands& commands) const;
    void rasterizeAlong(Commands& commands, int firstAxis, int lastAxis) const;
    void rasterize(Commands& commands) const;
};

} // namespace kestrel
