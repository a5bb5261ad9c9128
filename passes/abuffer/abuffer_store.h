// The second stage of the A-buffer: every fragment of every view becomes a node of its pixel (Vardis,
// Vasilakis, Papaioannou 2016, section 3.3; the structures are those of section 4.3). The paper takes each
// address from one counter, which all fragments contend for; with `Counted` the fragments of each pixel,
// which ABufferBounds has counted, give it an address range by a prefix sum, and a fragment meets only those
// of its own pixel.
#pragma once
#include "graph/registry.h"
#include "views.h"

namespace kestrel {

enum class ABufferAllocation : std::uint8_t { Counter, Pages, Counted };

class ABufferStore final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    FragmentLists::Structure structure = FragmentLists::Structure::DLLB;
    int buckets = 4;
    enum class Boundaries : std::uint8_t { Uniform, Shifted };
    Boundaries boundaries = Boundaries::Uniform;
    bool decoupled = true;
    bool planes = true;
    ABufferAllocation allocation = ABufferAllocation::Counted;
    ABufferDrawing drawing = ABufferDrawing::ByView;
    bool fetch = true;

private:
    [[nodiscard]] bool isCounted() const {
        return allocation == ABufferAllocation::Counted || structure == FragmentLists::Structure::SB;
    }
    // Whether the numbers of fragments that a prefix sum is made of are not those of the bounds, which a
    // geometry shader's fragments, rounded otherwise, need not have.
    [[nodiscard]] bool countsItself(const FragmentLists& lists) const {
        return isCounted() &&
               (!lists.counted || abufferDrawing(drawing, lists) == ABufferDrawing::GeometryShader);
    }
    [[nodiscard]] bool isPaged() const { return !isCounted() && allocation == ABufferAllocation::Pages; }
    void declareCounts(const World& world, const FragmentLists& lists, Declaration& declaration) const;
    [[nodiscard]] std::vector<Step> beginSteps(const Defines& defines, const FragmentLists& lists,
                                               std::uint64_t pixels, bool fetches) const;
    [[nodiscard]] Step drawStep(const World& world, const FragmentLists& lists, ABufferViews views,
                                bool keepsData, bool fetches) const;
};

} // namespace kestrel
