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

// The axes of the map along unit `direction`, z >= 0, as fixed-point half cells.
shared::RomaRotation romaRotation(const glm::vec3& direction);

} // namespace kestrel
