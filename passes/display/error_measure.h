// The error of one image against another, as figures and as a heat map.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class ErrorMeasure final : public Pass {
public:
    enum class Range { Low, High };

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int interval = 1;
    Range range = Range::Low;

private:
    std::uint32_t runs_ = 0;
};

} // namespace kestrel
