#include "grid.h"
#include <cmath>
#include <cstddef>

namespace kestrel {

static_assert(sizeof(shared::OccupancyGrid) == 64);
static_assert(offsetof(shared::OccupancyGrid, inverseCellSize) == 16);
static_assert(sizeof(shared::OccupancySettings) == 16);

bool isOccupancyResolution(int resolution) {
    return resolution == 32 || resolution == 64 || resolution == 128 || resolution == 256;
}

std::uint64_t occupancyBytes(int resolution) {
    const auto n = static_cast<std::uint64_t>(resolution);
    return n * n * n / 8;
}

std::optional<int> occupancyResolution(const Desc& buffer) {
    if (buffer.kind != ResourceKind::Buffer || buffer.format != Format::R32UI) return std::nullopt;
    for (const int resolution : {32, 64, 128, 256})
        if (buffer.bytes == occupancyBytes(resolution)) return resolution;
    return std::nullopt;
}

static float cellSize(const Sphere& sphere, int resolution) {
    return 2 * sphere.radius / static_cast<float>(resolution - 2 * occupancyMargin);
}

bool hasExtent(const Sphere& sphere, int resolution) {
    const float cell = cellSize(sphere, resolution);
    return std::isnormal(cell) && std::isnormal(1 / cell);
}

void boundOccupied(shared::OccupancyGrid& grid, const Box& box) {
    // From a surface to the far side of a cell that it touches, or of one half a cell behind it
    // (OccupancyMap::inset), and some rounding.
    constexpr float beyond = 1.75f;
    const glm::vec3 corner(grid.halfResolution);
    grid.low = glm::clamp(centredCells(grid, box.min) - beyond, -corner, corner);
    grid.high = glm::clamp(centredCells(grid, box.max) + beyond, -corner, corner);
}

shared::OccupancyGrid occupancyGrid(const Sphere& sphere, const Box& box, int resolution,
                                    const glm::vec3& jitter) {
    const float cell = hasExtent(sphere, resolution) ? cellSize(sphere, resolution) : 1.0f;
    shared::OccupancyGrid grid{};
    grid.centre = sphere.centre + jitter * cell;
    grid.cellSize = cell;
    grid.inverseCellSize = 1 / cell;
    grid.halfResolution = static_cast<float>(resolution) / 2;
    grid.resolution = static_cast<std::uint32_t>(resolution);
    boundOccupied(grid, box);
    return grid;
}

} // namespace kestrel
