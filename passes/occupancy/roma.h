// Ray-aligned occupancy map array: Zeng et al., "Ray-aligned Occupancy Map Array for Fast Approximate Ray
// Tracing".
#pragma once
#include "aligned_maps.h"
#include "candidates.h"
#include "graph/pass.h"
#include "graph/registry.h"

namespace kestrel {

// Rotates an occupancy map towards angular^2 candidate directions (section 4.1) and traces through them
// (4.2).
class Roma final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int angular = 4;
    int iterations = 8;
    // The best of a sweep of both on `blob` (FLIP against Embree at 64 frames); the paper's 1.5 and 0 lose
    // more of the close occluders.
    float offset = 0.5f;
    float skip = 2;
    bool resample = true;
    int refresh = 0;
    RotationMethod rotation = RotationMethod::Automatic;
    bool countExhausted = false;

private:
    [[nodiscard]] std::vector<Step> rotationSteps(const AlignedMaps& maps, const Desc& base, bool inTurn,
                                                  const Capabilities& capabilities) const;
    void upload(Commands& commands);
    void rotate(Commands& commands, const AlignedMaps& maps, bool inTurn) const;
    void list(Commands& commands, int resolution) const;
    void choose(Commands& commands) const;
    void rotateChosen(Commands& commands, RotationPart part, const AlignedMaps& maps, bool inTurn) const;

    Candidates candidates_;
    Renewal renewal_;      // of this frame
    int countBefore_ = 0;  // of the last frame's
    bool changed_ = false; // the base map, since the last frame
};

} // namespace kestrel
