// Where an occupancy map's cells lie.
#pragma once
#include "graph/types.h"
#include "scene/bounds.h"
#include "shared/occupancy.h"
#include <optional>

namespace kestrel {

// Cells that stay free on each side between the scene's sphere and the cube's faces, so that neither the
// shift by `jitter` nor rounding takes a surface out of the cube.
inline constexpr int occupancyMargin = 1;

// 32, 64, 128 or 256 cells an edge: the words of a column then fill one or two texels, and indices are
// shifts.
bool isOccupancyResolution(int resolution);

// Bytes of a map of resolution^3 bits.
std::uint64_t occupancyBytes(int resolution);

// The resolution of the map in a buffer; nothing if it is none by its size and texels.
std::optional<int> occupancyResolution(const Desc& buffer);

// A cube around the scene's bounding sphere over its whole timeline, not its box: any rotation of the cube
// about its centre then contains the scene too. `box` are the scene's bounds within the sphere. `jitter`
// shifts the cells, in cells, each component in [-0.5, 0.5]. A sphere without extent gives a valid grid
// around its centre with cells of size 1.
shared::OccupancyGrid occupancyGrid(const Sphere& sphere, const Box& box, int resolution,
                                    const glm::vec3& jitter = glm::vec3(0));

// Sets `low` and `high`, after `centre` and `inverseCellSize`, from the bounds of what is marked in the grid.
void boundOccupied(shared::OccupancyGrid& grid, const Box& box);

// Whether a scene with this sphere has anything that cells could be measured by.
bool hasExtent(const Sphere& sphere, int resolution);

} // namespace kestrel
