// Nested ray-aligned occupancy map arrays around the camera (ROMA, section 7.2, "scalability").
#pragma once
#include "aligned_maps.h"
#include "candidates.h"
#include "graph/pass.h"
#include "graph/registry.h"
#include "shared/occupancy.h"
#include <vector>

namespace kestrel {

// Provides `tracer` through `levels` maps of one resolution. The coarsest lies around the scene; each finer
// one has `ratio` of the extent and lies around the camera, moved in steps of its own cells so that what
// stands still keeps its cells. Cells are marked exactly (OccupancyMap's method `exact`), a level only where
// the scene or its place has changed. See shaders/occupancy/roma_cascade.glsl.
class RomaCascade final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    int levels = 3;
    float ratio = 0.5f;
    int resolution = 128;
    int angular = 4;
    int iterations = 8;
    float offset = 0.5f;
    float skip = 2;
    bool resample = true;
    int refresh = 0;
    RotationMethod rotation = RotationMethod::Automatic;
    bool countExhausted = false;

private:
    void declareMaps(const World& world, Declaration& declaration, Module& tracer, Step& begin) const;
    [[nodiscard]] bool isStale(int level) const { return stale_.at(static_cast<size_t>(level)); }
    void begin(Commands& commands);
    void clearLevel(Commands& commands, int level) const;
    void markLevel(Commands& commands, int level, const StepRun& marking);
    // Of a level, which maps this frame makes anew.
    [[nodiscard]] Renewal renewalOf(int level) const;
    void rotateLevel(Commands& commands, int level, const AlignedMaps& maps, bool inTurn) const;
    void listLevel(Commands& commands, int level) const;
    void chooseLevel(Commands& commands, int level) const;
    void rotateChosen(Commands& commands, int level, RotationPart part, const AlignedMaps& maps,
                      bool inTurn) const;

    std::vector<shared::OccupancyGrid> grids_; // of the last frame, finest first
    std::vector<bool> stale_;                  // by level: is marked anew in this frame
    std::vector<int> countBefore_;             // by level: maps made anew in the last frame
    Candidates candidates_;
    Renewal renewal_; // of this frame
};

} // namespace kestrel
