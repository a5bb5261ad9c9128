// The running mean of a signal over frames, started anew by any change but that of the frame index.
#pragma once
#include "graph/registry.h"

namespace kestrel {

class Accumulate final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
    void execute(const Step& step, Commands& commands) override;

    int maximum = 0;

private:
    std::uint32_t frames_ = 0; // in the present mean
};

} // namespace kestrel
