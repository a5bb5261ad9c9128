// What an exact occupancy map must be: every cell of every triangle's bounding box tested one by one.
#pragma once
#include "scene/geometry.h"
#include "shared/occupancy.h"
#include "shared/triangle_cell.h"
#include <algorithm>
#include <array>
#include <vector>

namespace kestrel::test {

// The cells from floor(low) - 1 to floor(high) + 1 within the grid: rounding never reaches farther.
inline std::pair<glm::ivec3, glm::ivec3> cellsAround(const glm::vec3& a, const glm::vec3& b,
                                                     const glm::vec3& c, int n) {
    const glm::ivec3 low(glm::floor(glm::min(a, glm::min(b, c))));
    const glm::ivec3 high(glm::floor(glm::max(a, glm::max(b, c))));
    return {glm::clamp(low - 1, 0, n - 1), glm::clamp(high + 1, 0, n - 1)};
}

// The corners of the triangle whose indices begin there, in cells.
inline std::array<glm::vec3, 3> cornersAt(const Geometry& geometry, const shared::OccupancyGrid& grid,
                                          size_t index) {
    std::array<glm::vec3, 3> corners;
    for (size_t k = 0; k < 3; ++k)
        corners[k] = shared::cellsOf(grid, geometry.positions[geometry.indices[index + k]]);
    return corners;
}

inline std::vector<std::uint32_t> oracleMap(const Geometry& geometry, const shared::OccupancyGrid& grid) {
    const int n = static_cast<int>(grid.resolution);
    std::vector<std::uint32_t> map(static_cast<size_t>(n) * n * n / 32);
    for (size_t i = 0; i < geometry.indices.size(); i += 3) {
        const auto p = cornersAt(geometry, grid, i);
        const auto [first, last] = cellsAround(p[0], p[1], p[2], n);
        for (int z = first.z; z <= last.z; ++z)
            for (int y = first.y; y <= last.y; ++y)
                for (int x = first.x; x <= last.x; ++x) {
                    const glm::vec3 centre = glm::vec3(x, y, z) + 0.5f;
                    if (shared::triangleMeetsCube(p[0] - centre, p[1] - centre, p[2] - centre))
                        map[static_cast<size_t>(shared::occupancyWord(x, y, z, n))] |= 1u << (z & 31);
                }
    }
    return map;
}

// What a map made by columns must be: every column of every triangle's bounding box one by one.
inline std::vector<std::uint32_t> separatingOracle(const Geometry& geometry,
                                                   const shared::OccupancyGrid& grid, float inset) {
    const int n = static_cast<int>(grid.resolution);
    std::vector<std::uint32_t> map(static_cast<size_t>(n) * n * n / 32);
    for (size_t i = 0; i < geometry.indices.size(); i += 3) {
        auto p = cornersAt(geometry, grid, i);
        const glm::vec3 back = shared::behindFace(p[0], p[1], p[2], inset);
        for (glm::vec3& corner : p) corner += back;
        const shared::TriangleWalk walk = shared::triangleWalk(p[0], p[1], p[2], n);
        for (int y = walk.first.y; y <= walk.last.y; ++y)
            for (int x = walk.first.x; x <= walk.last.x; ++x) {
                if (!shared::columnMeets(walk, p[0], p[1], p[2], x, y)) continue;
                const glm::ivec2 range = shared::throughColumn(walk, x, y);
                for (int z = range.x; z <= range.y; ++z) {
                    const glm::ivec3 cell = shared::axisBack({x, y, z}, walk.axis);
                    map[static_cast<size_t>(shared::occupancyWord(cell.x, cell.y, cell.z, n))] |=
                        1u << (cell.z & 31);
                }
            }
    }
    return map;
}

} // namespace kestrel::test
