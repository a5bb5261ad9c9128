// The first stage of the A-buffer: depth bounds of every pixel of the frame's view and of a cube about the
// eye (Vardis, Vasilakis, Papaioannou, "A Multiview and Multilayer Approach for Interactive Ray Tracing", I3D
// 2016, sections 3.2 and 3.3). The paper's atomic minimum and maximum are blending here, which also counts
// the fragments, so that the store stage knows where each list begins.
// The bounding boxes of the scene's instances may stand in for what is in them: bounds are wider then, and of
// fragments they tell nothing.
#pragma once
#include "graph/registry.h"
#include "views.h"

namespace kestrel {

class ABufferBounds final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    bool mainView = true;
    bool cube = true;
    Blended blended = Blended::Tested;
    int side = 0;
    double nearPlane = 0.01;
    enum class Source : std::uint8_t { Geometry, Proxy };
    Source source = Source::Geometry;
    ABufferDrawing drawing = ABufferDrawing::ByView;
    bool countLayers = false;

private:
    [[nodiscard]] Step proxyStep(const World& world, const FragmentLists& lists, bool ofCube,
                                 std::uint32_t face) const;
    void makeBoxes(Commands& commands) const;
    void reportLayers(Commands& commands) const;
};

} // namespace kestrel
