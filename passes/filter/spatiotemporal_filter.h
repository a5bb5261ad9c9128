// Follows a noisy signal over frames and smooths it in space, stopping at edges: spatiotemporal
// variance-guided filtering (Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017).
#pragma once
#include "graph/registry.h"

namespace kestrel {

class SpatiotemporalFilter final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int history = 10;
    // The paper has 5 iterations of 5 x 5 taps and an exponent of 128, for full HD; these are better and
    // cheaper where a picture has 320 x 180 pixels.
    int iterations = 3;
    int radius = 1;
    float sigmaDepth = 0.01f;
    float sigmaNormal = 32;
    float sigmaLuminance = 4;
    float depthTolerance = 0.02f;
    float normalTolerance = 25;
    bool gradient = false;
    float clampDeviations = 0;
    bool filteredHistory = false;

private:
    // What a declaration decides once and its steps share.
    struct Choices;
    [[nodiscard]] Step temporalStep(const Inputs& inputs, const Choices& choices) const;
    [[nodiscard]] Step gradientStep(const Inputs& inputs, const Choices& choices) const;
    [[nodiscard]] Step varianceStep(const Choices& choices) const;
    [[nodiscard]] Step iterationStep(int iteration, const Choices& choices) const;
    void setTolerances(Commands& commands) const;
    void findChanges(Commands& commands) const;
    void accumulate(Commands& commands) const;
    void estimateVariance(Commands& commands) const;
    void smooth(Commands& commands, int iteration) const;
    static void leaveOut(Declaration& declaration, const Inputs& inputs, const Choices& choices);
};

} // namespace kestrel
