// A bounding volume hierarchy built on the CPU and traversed in GLSL: exact triangles, the rival of every
// proxy.
#pragma once
#include "graph/registry.h"
#include <cstdint>

namespace kestrel {

class BvhPass final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    enum class Layout : std::uint8_t { Wide, Binary };

    Layout layout = Layout::Wide;
    int leaf = 4;
    int bins = 16;
};

} // namespace kestrel
