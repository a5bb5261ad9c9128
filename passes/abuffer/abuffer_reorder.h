// The third stage of the A-buffer: lists in order of depth, with the links, heads and tails of their
// structure (Vardis, Vasilakis, Papaioannou 2016, section 3.3).
#pragma once
#include "graph/registry.h"

namespace kestrel {

class ABufferReorder final : public Pass {
public:
    // Fragments of a list that are sorted within an invocation by insertion, and by merging (without links:
    // by Shell's method); and the most that a list may have.
    static constexpr int shortList = 24, mediumList = 1'000, longestList = 16'000;

    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;
};

} // namespace kestrel
