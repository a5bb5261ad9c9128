// A bounding volume hierarchy built on the CPU and traversed in GLSL: exact triangles, the rival of every
// proxy.
#pragma once
#include "graph/registry.h"
#include "scene/wide_bvh.h"
#include <cstdint>

namespace kestrel {

class BvhPass final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void build(Commands& commands, bool mayRefit);

    enum class Layout : std::uint8_t { Wide, Binary };

    Layout layout = Layout::Wide;
    int leaf = 4;
    int bins = 16;

private:
    bool refits(Commands& commands);

    // The hierarchy of a scene that moves, and what it was worth when it was built.
    WideBvh moving_;
    static constexpr std::uint32_t noTriangles = 0xffffffffu;
    std::uint32_t triangles_ = noTriangles; // that it has
    double builtVisits_ = 0;
    int refits_ = 0; // since
};

} // namespace kestrel
