// A distance field made from an occupancy map, and a tracer through it: what the ROMA paper compares with
// (section 7).
#pragma once
#include "graph/pass.h"
#include "graph/registry.h"

namespace kestrel {

// How the field is made from the map's occupied cells. JumpFlooding is what the paper does, near but not
// exact; Exact is a separable Euclidean distance transform that begins with the map's columns of bits.
enum class DistanceMethod : std::uint8_t { JumpFlooding, Exact };

// Which level of the field a ray samples: the coarsest that its last step allows, or one that coarsens with
// the distance travelled.
enum class LevelChoice : std::uint8_t { Step, Travelled };

// A cube of distances in cells, from each cell's centre to that of the nearest occupied one (16-bit floats),
// with coarser levels, sphere-traced.
class DistanceField final : public Pass {
public:
    static PassType type();
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand& demand) const override;

    DistanceMethod method = DistanceMethod::Exact;
    int mips = 3;
    int iterations = 64;
    // The best compromise of sweeps of all of these on `blob` (FLIP and MSE against the exact tracer); offset
    // and skip matter most, lengths and levels of steps hardly.
    float threshold = 0.5f;
    float offset = 0.75f;
    float skip = 2;
    float scale = 1;
    float leastStep = 0.5f;
    LevelChoice level = LevelChoice::Step;
    float margin = 2;
    float widening = 0.05f;

private:
    [[nodiscard]] std::vector<Step> floodSteps(int resolution, Access base) const;
    [[nodiscard]] std::vector<Step> exactSteps(int resolution, Access base) const;
    void uploadSettings(Commands& commands) const;
};

} // namespace kestrel
