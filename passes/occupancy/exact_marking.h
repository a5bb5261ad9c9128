// Marking cells by what triangles meet (shaders/occupancy/exact.comp): the steps, shared by the passes that
// make maps like this.
#pragma once
#include "graph/pass.h"
#include <vector>

namespace kestrel {

class Commands;

// Defines of the shaders that mark cells. Materials matter to a map only where an alpha test makes holes.
Defines markingDefines(const World& world, int resolution);

// The steps "triangles" and "large_triangles": they mark cells of "grid" in "occupancy", which was cleared,
// by way of the list "large", whose first 16 bytes were cleared.
std::vector<Step> exactSteps(const World& world, int resolution);
// The same by columns (shared/triangle_cell.h: columnMeets()): fewer cells, one-sided surfaces `inset` cells
// behind.
std::vector<Step> separatingSteps(const World& world, int resolution, float inset);
Desc largeTrianglesDesc(const World& world);

// In the step "triangles".
void markTriangles(Commands& commands);

} // namespace kestrel
