// The candidate directions of Roma and what is known of their strata. See shaders/shared/roma.h.
#pragma once
#include "shared/roma.h"
#include <vector>

namespace kestrel {

// The unit direction, z >= 0, that a point of the unit square is mapped to: concentric map to the disk, then
// to the hemisphere, preserving fractional areas.
glm::dvec3 hemisphereFromSquare(const glm::dvec2& point);

// n x n strata with the moments of their directions filled in and their centres as directions. Integrates
// numerically (32 x 32 midpoints a stratum): make it once a resolution. n from 2 to 16.
std::vector<shared::RomaDirection> romaStrata(int n);

// Draws a candidate in each stratum for a frame. Over frames the samples of one stratum form a scrambled
// (0,2)-sequence, so that any power of two of frames in a row covers it evenly.
void drawCandidates(std::vector<shared::RomaDirection>& strata, int n, std::uint32_t frame,
                    std::uint32_t seed);

// Which maps are made anew: those at `count` places from `first` on, counted round, of an order in which
// neighbours lie far apart on the hemisphere. The map at place p is p * stride modulo the number of maps.
struct Renewal {
    int first = 0, count = 0;
};
int renewalStride(int maps);

// The candidates of all strata from frame to frame. A frame draws those of all maps (drawCandidates), or of
// `refresh` maps in turn: the maps then have places, and which are drawn and what depends on the frame's
// index alone. Here too the samples of one stratum form a (0,2)-sequence, over the times that it is drawn.
class Candidates {
public:
    // `all`: what the maps show has changed. All are drawn too if `refresh` is 0 or no less than the number
    // of maps, and in the first call and after one with another n.
    Renewal draw(int n, int refresh, bool all, std::uint32_t frame, std::uint32_t seed);
    [[nodiscard]] const std::vector<shared::RomaDirection>& strata() const { return strata_; }

private:
    std::vector<shared::RomaDirection> strata_; // of n_^2
    int n_ = 0;
};

// The axes of the map along unit `direction`, z >= 0, as fixed-point half cells.
shared::RomaRotation romaRotation(const glm::vec3& direction);

} // namespace kestrel
