// Cells: bits of columns, the grid around a scene, and triangles against cubes, held against clipping in
// double precision.
#include "passes/occupancy/grid.h"
#include "shared/triangle_cell.h"
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace kestrel::test {
namespace {

TEST(OccupancyCells, ColumnMaskHoldsTheCellsFromFirstToLast) {
    for (int first = -1; first <= 256; ++first) {
        for (int last = -1; last <= 256; ++last) {
            for (int w = 0; w < 8; ++w) {
                std::uint32_t expected = 0;
                for (int bit = 0; bit < 32; ++bit)
                    if (32 * w + bit >= first && 32 * w + bit <= last) expected |= 1u << bit;
                ASSERT_EQ(shared::columnMask(first, last, w), expected)
                    << first << " to " << last << ", word " << w;
            }
        }
    }
}

TEST(OccupancyCells, EveryCellHasItsOwnBit) {
    std::vector<std::uint32_t> seen(32 * 32);
    for (int z = 0; z < 32; ++z)
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) {
                std::uint32_t& word = seen.at(static_cast<size_t>(shared::occupancyWord(x, y, z, 32)));
                ASSERT_EQ(word >> z & 1u, 0u);
                word |= 1u << z;
            }
    for (const std::uint32_t word : seen) EXPECT_EQ(word, 0xffffffffu);
}

TEST(OccupancyCells, TheGridHoldsTheSphereWithItsMargin) {
    for (const float radius : {1e-4f, 1.0f, 1e4f}) {
        for (const int n : {32, 64, 128, 256}) {
            const Sphere sphere{{radius, -2 * radius, 3 * radius}, radius};
            for (const glm::vec3 jitter : {glm::vec3(0), glm::vec3(0.5f), glm::vec3(-0.5f)}) {
                const Box box{sphere.centre - 0.5f * radius, sphere.centre + 0.25f * radius};
                const shared::OccupancyGrid grid = occupancyGrid(sphere, box, n, jitter);
                for (int k = 0; k < 3; ++k) {
                    glm::vec3 end = sphere.centre;
                    end[k] += radius;
                    EXPECT_LT(shared::cellsOf(grid, end)[k], float(n) - 0.49f);
                    end[k] -= 2 * radius;
                    EXPECT_GT(shared::cellsOf(grid, end)[k], 0.49f);
                }
                // The box, and a cell beyond: what a cell that touches it may reach.
                const glm::vec3 low = shared::centredCells(grid, box.min) - 1.0f;
                const glm::vec3 high = shared::centredCells(grid, box.max) + 1.0f;
                EXPECT_TRUE(glm::all(glm::lessThan(grid.low, low)) &&
                            glm::all(glm::greaterThan(grid.high, high)));
                EXPECT_TRUE(glm::all(glm::greaterThan(grid.low, low - 1.0f)) &&
                            glm::all(glm::lessThan(grid.high, high + 1.0f)));
                const glm::vec3 cells(1, 2, 3);
                EXPECT_LT(glm::length(shared::cellsOf(grid, shared::fromCells(grid, cells)) - cells), 1e-3f);
            }
        }
    }
}

TEST(OccupancyCells, ASphereWithoutExtentHasAUsableGrid) {
    for (const float radius : {0.0f, 1e-42f, std::numeric_limits<float>::infinity()}) {
        EXPECT_FALSE(hasExtent({glm::vec3(0), radius}, 64));
        EXPECT_EQ(occupancyGrid({glm::vec3(0), radius}, Box{}, 64).cellSize, 1.0f);
    }
}

TEST(OccupancyCells, ResolutionOfABuffer) {
    for (const int n : {32, 64, 128, 256})
        EXPECT_EQ(occupancyResolution(Desc::buffer(occupancyBytes(n), Format::R32UI)), n);
    EXPECT_FALSE(occupancyResolution(Desc::buffer(occupancyBytes(64), Format::R32F)));
    EXPECT_FALSE(occupancyResolution(Desc::buffer(100, Format::R32UI)));
    EXPECT_FALSE(occupancyResolution(Desc::texture2D(Format::R32UI, {64, 64, 1})));
}

// Does the triangle meet the cube of half width `half` around 0? By clipping the triangle to its six sides.
bool meetsByClipping(std::vector<glm::dvec3> polygon, double half) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {1.0, -1.0}) {
            std::vector<glm::dvec3> kept;
            for (size_t i = 0; i < polygon.size(); ++i) {
                const glm::dvec3 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
                const double dp = half - side * p[axis], dq = half - side * q[axis];
                if (dp >= 0) kept.push_back(p);
                if ((dp >= 0) != (dq >= 0)) kept.push_back(p + (q - p) * (dp / (dp - dq)));
            }
            polygon = kept;
        }
    }
    return !polygon.empty();
}

// Triangles in a grid of n cells: of all sizes and shapes, many on the cells' borders.
std::vector<glm::vec3> triangleOf(std::mt19937& random, float n, int kind) {
    std::uniform_real_distribution<float> unit(0, 1);
    const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)) * n; };
    const float size = n * std::pow(10.0f, -3 * unit(random));
    const glm::vec3 a = point();
    glm::vec3 b = a + size * (point() / n - 0.5f), c = a + size * (point() / n - 0.5f);
    switch (kind) {
    case 1: // on the borders
        return {glm::round(a), glm::round(b), glm::round(c)};
    case 2: // in a plane between cells
        return {{a.x, a.y, std::round(a.z)}, {b.x, b.y, std::round(a.z)}, {c.x, c.y, std::round(a.z)}};
    case 3: // a sliver
        return {a, b, b + 1e-5f * (c - a)};
    case 4: // a segment
        return {a, b, 0.5f * (a + b)};
    case 5: // a point
        return {a, a, a};
    case 6: // a point on a corner of cells
        return {glm::round(a), glm::round(a), glm::round(a)};
    default:
        return {a, b, c};
    }
}

TEST(OccupancyCells, TrianglesMeetTheCubesThatClippingSays) {
    std::mt19937 random(1);
    int met = 0, tests = 0;
    for (int i = 0; i < 30'000; ++i) {
        const std::vector<glm::vec3> p = triangleOf(random, 8, i % 7);
        const glm::vec3 cell(random() % 8, random() % 8, random() % 8);
        const glm::vec3 centre = cell + 0.5f;
        const bool meets = shared::triangleMeetsCube(p[0] - centre, p[1] - centre, p[2] - centre);
        std::vector<glm::dvec3> polygon;
        for (const glm::vec3& corner : p) polygon.push_back(glm::dvec3(corner) - glm::dvec3(centre));
        // Rounding decides within a hundred thousandth of a cell of a border, and nowhere else.
        if (meetsByClipping(polygon, 0.5 - 1e-5)) {
            ASSERT_TRUE(meets) << i;
        }
        if (!meetsByClipping(polygon, 0.5 + 1e-5)) {
            ASSERT_FALSE(meets) << i;
        }
        met += meets;
        ++tests;
    }
    EXPECT_GT(met, tests / 300);
}

TEST(OccupancyCells, TouchingCounts) {
    const glm::vec3 corner(0.5f);
    EXPECT_TRUE(shared::triangleMeetsCube(corner, corner, corner));
    EXPECT_TRUE(shared::triangleMeetsCube({-2, -2, 0.5f}, {2, -2, 0.5f}, {0, 2, 0.5f}));
    EXPECT_FALSE(shared::triangleMeetsCube({-2, -2, 0.5001f}, {2, -2, 0.5001f}, {0, 2, 0.5001f}));
}

// The walk by columns leaves out no cell that the triangle meets, and its nests stay short.
TEST(OccupancyCells, TheWalkPassesEveryCellThatIsMet) {
    std::mt19937 random(2);
    constexpr int n = 24;
    for (int i = 0; i < 2100; ++i) {
        const std::vector<glm::vec3> p = triangleOf(random, n, i % 7);
        const shared::TriangleWalk walk = shared::triangleWalk(p[0], p[1], p[2], n);
        std::vector<bool> passed(n * n * n);
        for (int y = walk.first.y; y <= walk.last.y; ++y) {
            for (int x = walk.first.x; x <= walk.last.x; ++x) {
                const glm::ivec2 range = shared::walkColumn(walk, x, y);
                for (int z = range.x; z <= range.y; ++z) {
                    const glm::ivec3 cell = shared::axisBack({x, y, z}, walk.axis);
                    for (int k = 0; k < 3; ++k) ASSERT_TRUE(cell[k] >= 0 && cell[k] < n);
                    passed[static_cast<size_t>((cell.z * n + cell.y) * n + cell.x)] = true;
                }
            }
        }
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const glm::vec3 centre = glm::vec3(x, y, z) + 0.5f;
                    if (!shared::triangleMeetsCube(p[0] - centre, p[1] - centre, p[2] - centre)) continue;
                    ASSERT_TRUE(passed[static_cast<size_t>((z * n + y) * n + x)])
                        << "kind " << i % 7 << ": " << x << " " << y << " " << z;
                }
    }
}

// Marked by columns, a plane of two triangles stops every step from cell to cell, across a face, an edge or a
// corner, from one of its sides to the other; marked where it meets the middle lines of cells alone, it does
// not.
TEST(OccupancyCells, APlaneMarkedByColumnsLetsNoStepThrough) {
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(-0.5, 0.5);
    constexpr int n = 24;
    int through = 0, throughCentreLines = 0;
    for (int i = 0; i < 60; ++i) {
        const glm::dvec3 axis = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        const glm::dvec3 right = glm::normalize(
            glm::cross(axis, std::abs(axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        const glm::dvec3 up = glm::cross(axis, right);
        const glm::dvec3 middle = 0.5 * n + glm::dvec3(unit(random), unit(random), unit(random));
        const auto corner = [&](double x, double y) {
            return glm::vec3(middle + 100.0 * (x * right + y * up));
        };
        const glm::vec3 quad[4] = {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
        std::vector<bool> byColumns(n * n * n), byCentreLines(n * n * n);
        const auto at = [&](const glm::ivec3& c) { return static_cast<size_t>((c.z * n + c.y) * n + c.x); };
        for (const int second : {1, 2}) {
            const glm::vec3 &a = quad[0], &b = quad[second], &c = quad[second + 1];
            const shared::TriangleWalk walk = shared::triangleWalk(a, b, c, n);
            for (int y = walk.first.y; y <= walk.last.y; ++y)
                for (int x = walk.first.x; x <= walk.last.x; ++x) {
                    if (!shared::columnMeets(walk, a, b, c, x, y)) continue;
                    const glm::ivec2 range = shared::throughColumn(walk, x, y);
                    for (int z = std::max(range.x, 0); z <= std::min(range.y, n - 1); ++z)
                        byColumns[at(shared::axisBack({x, y, z}, walk.axis))] = true;
                }
        }
        const auto side = [&](const glm::ivec3& c) { return glm::dot(glm::dvec3(c) + 0.5 - middle, axis); };
        // A plane meets a middle line of a cell where it is within half a cell of its centre along that line.
        const double steepest = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    byCentreLines[at({x, y, z})] = std::abs(side({x, y, z})) <= 0.5 * steepest;
        for (int z = 1; z + 1 < n; ++z)
            for (int y = 1; y + 1 < n; ++y)
                for (int x = 1; x + 1 < n; ++x)
                    for (int step = 0; step < 27; ++step) {
                        const glm::ivec3 from(x, y, z),
                            to = from + glm::ivec3(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
                        if (side(from) >= 0 || side(to) < 0) continue;
                        through += !byColumns[at(from)] && !byColumns[at(to)];
                        throughCentreLines += !byCentreLines[at(from)] && !byCentreLines[at(to)];
                    }
    }
    EXPECT_EQ(through, 0);
    EXPECT_GT(throughCentreLines, 1000);
}

// Of a well-shaped triangle few cells stand over each other along the chosen axis.
TEST(OccupancyCells, TheWalkIsThin) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 256);
    for (int i = 0; i < 200; ++i) {
        const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
        const glm::vec3 a = point(), b = point(), c = point();
        if (glm::length(glm::cross(b - a, c - a)) < 2000) continue;
        const shared::TriangleWalk walk = shared::triangleWalk(a, b, c, 256);
        EXPECT_LT(walk.slack, 1.2f);
    }
}

} // namespace
} // namespace kestrel::test
