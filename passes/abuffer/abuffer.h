// Rays through the pixels of an A-buffer: through fragments (Vardis, Vasilakis, Papaioannou, "A Multiview and
// Multilayer Approach for Interactive Ray Tracing", I3D 2016, section 3.4), or through the primitives that
// each pixel sees, with an exact test at the hit (the same authors, "DIRT: Deferred Image-based Ray Tracing",
// HPG 2016).
#pragma once
#include "graph/registry.h"

namespace kestrel {

enum class ABufferRecord : std::uint8_t { Fragment, Primitive };
enum class ABufferMarching : std::uint8_t { Exhaustive, Fixed, Hierarchical };
enum class ABufferLayering : std::uint8_t { Multi, Single };

class ABuffer final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    ABufferRecord record = ABufferRecord::Fragment;
    ABufferMarching march = ABufferMarching::Hierarchical;
    ABufferLayering layering = ABufferLayering::Multi;
    int steps = 100;
    bool skipping = true;
    double thickness = 0.5, offset = 1.5;
    bool countExhausted = false;

private:
    // What both modules have in common, by what is asked of them.
    [[nodiscard]] Module moduleOf(const char* port, const World& world, const FragmentLists& lists) const;
    [[nodiscard]] bool hierarchical() const { return march == ABufferMarching::Hierarchical && skipping; }
    static void declareEmpty(Declaration& declaration, const Demand& demand, const char* why);
};

} // namespace kestrel
