// Roma against brute force: the rotated maps to the bit, queries against every occupied cell of the same
// maps.
#include "gl/occupancy_fixture.h"
#include "passes/occupancy/candidates.h"

namespace kestrel::test {
namespace {

using OccupancyRoma = GlTest;

constexpr double infinity = std::numeric_limits<double>::infinity();

// What the passes made, read back.
struct Maps {
    int n = 0;
    shared::OccupancyGrid grid{};
    float offset = 0;
    std::vector<shared::RomaDirection> directions;
    std::vector<shared::RomaRotation> rotations;
    std::vector<std::uint32_t> base, rotated;

    [[nodiscard]] bool occupied(int map, const glm::ivec3& cell) const {
        const int words = n / 32;
        const auto at = static_cast<size_t>(((map * n + cell.y) * n + cell.x) * words + (cell.z >> 5));
        return (rotated.at(at) >> (cell.z & 31) & 1u) != 0;
    }
};

Maps mapsOf(Renderer& renderer) {
    Maps maps;
    maps.grid = gridOf(renderer);
    maps.n = static_cast<int>(maps.grid.resolution);
    maps.base = wordsOf(renderer, {"map", "occupancy"});
    maps.rotated = wordsOf(renderer, {"roma", "maps"});
    maps.rotations = as<shared::RomaRotation>(renderer.readBytes({"roma", "rotations"}));
    std::vector<std::byte> block = renderer.readBytes({"roma", "directions"});
    maps.offset = as<shared::RomaSettings>(block).at(0).originOffset;
    block.erase(block.begin(), block.begin() + sizeof(shared::RomaSettings));
    maps.directions = as<shared::RomaDirection>(block);
    return maps;
}

// Algorithm 1 in the same integers.
bool rotatedBit(const Maps& maps, int map, const glm::ivec3& cell) {
    const shared::RomaRotation& axes = maps.rotations.at(static_cast<size_t>(map));
    const glm::ivec3 odd = 2 * cell + 1 - maps.n;
    const glm::ivec3 at = glm::ivec3(maps.n / 2 << shared::romaFractionBits) +
                          odd.x * glm::ivec3(axes.halfX) + odd.y * glm::ivec3(axes.halfY) +
                          odd.z * glm::ivec3(axes.halfZ);
    const glm::ivec3 base(at.x >> shared::romaFractionBits, at.y >> shared::romaFractionBits,
                          at.z >> shared::romaFractionBits);
    for (int k = 0; k < 3; ++k)
        if (base[k] < 0 || base[k] >= maps.n) return false;
    return isSet(maps.base, maps.n, base);
}

// A ray in the cells of one rotated map, in double precision.
struct AlignedRay {
    int map = 0;
    glm::dvec3 origin{0}, direction{0};
    double from = 0, to = 0;
};

AlignedRay aligned(const Maps& maps, int map, const shared::RayRecord& ray, const glm::vec3& direction) {
    const glm::vec3 w = maps.directions.at(static_cast<size_t>(map)).direction;
    const glm::dvec3 x(shared::romaAxisX(w)), y(shared::romaAxisY(w)), z(w);
    const auto align = [&](const glm::dvec3& v) {
        return glm::dvec3(glm::dot(v, x), glm::dot(v, y), glm::dot(v, z));
    };
    const double cell = maps.grid.cellSize;
    const glm::dvec3 centred = (glm::dvec3(ray.origin) - glm::dvec3(maps.grid.centre)) / cell +
                               double(maps.offset) * glm::dvec3(ray.normal);
    return {map, align(centred) + 0.5 * maps.n, align(direction), ray.tMin / cell, ray.tMax / cell};
}

// The ray's way through those of `cells` that it meets for more than `least` cells of its length: entry and
// exit, sorted.
std::vector<std::pair<double, double>> ways(const std::vector<glm::ivec3>& cells, const AlignedRay& ray,
                                            double least) {
    std::vector<std::pair<double, double>> found;
    for (const glm::ivec3& corner : cells) {
        double enter = ray.from, leave = ray.to;
        const glm::dvec3 cell(corner);
        for (int k = 0; k < 3; ++k) {
            const double a = (cell[k] - ray.origin[k]) / ray.direction[k];
            const double b = (cell[k] + 1 - ray.origin[k]) / ray.direction[k];
            const bool along = std::abs(ray.direction[k]) < 1e-9;
            const bool within = ray.origin[k] >= cell[k] && ray.origin[k] <= cell[k] + 1;
            enter = std::max(enter, along ? (within ? -infinity : infinity) : std::min(a, b));
            leave = std::min(leave, along ? (within ? infinity : -infinity) : std::max(a, b));
        }
        if (leave - enter > least) found.emplace_back(enter, leave);
    }
    std::sort(found.begin(), found.end());
    return found;
}

std::vector<glm::ivec3> occupiedCells(const Maps& maps, int map) {
    std::vector<glm::ivec3> cells;
    for (int z = 0; z < maps.n; ++z)
        for (int y = 0; y < maps.n; ++y)
            for (int x = 0; x < maps.n; ++x)
                if (maps.occupied(map, {x, y, z})) cells.emplace_back(x, y, z);
    return cells;
}

// The occupied cells of the column that a snapped ray goes along.
std::vector<glm::ivec3> columnCells(const Maps& maps, const AlignedRay& ray) {
    std::vector<glm::ivec3> cells;
    const glm::ivec2 at(glm::floor(ray.origin));
    if (at.x < 0 || at.y < 0 || at.x >= maps.n || at.y >= maps.n) return cells;
    for (int z = 0; z < maps.n; ++z)
        if (maps.occupied(ray.map, {at, z})) cells.emplace_back(at, z);
    return cells;
}

// Rays of all kinds through a map around the unit ball: from inside and outside, along axes, bounded and not.
std::vector<shared::RayRecord> raysAround(int count, float scale, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto any = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
    std::vector<shared::RayRecord> rays;
    for (int i = 0; i < count; ++i) {
        glm::vec3 direction = any();
        if (i % 8 == 0)
            direction = glm::vec3(i % 3 == 0, i % 3 == 1, i % 3 == 2) * (i % 16 == 0 ? 1.0f : -1.0f);
        const float reach = i % 5 == 0 ? 3.0f : 1.0f; // some begin outside
        float tMin = 0, tMax = std::numeric_limits<float>::infinity();
        if (i % 3 == 1) tMax = 0.5f * (unit(random) + 1);
        if (i % 7 == 2) tMax = 0.002f; // within a cell
        if (i % 4 == 3) tMin = 0.2f * (unit(random) + 1);
        const glm::vec3 normal = i % 2 == 0 ? glm::normalize(any()) : glm::vec3(0);
        rays.push_back(rayRecord(reach * scale * any(), direction, scale * tMin, scale * tMax, normal));
    }
    return rays;
}

int mapOf(const Maps& maps, const glm::vec3& direction) {
    for (size_t k = 0; k < maps.directions.size(); ++k)
        if (std::abs(glm::dot(maps.directions[k].direction, direction)) > 1 - 1e-6f)
            return static_cast<int>(k);
    return -1;
}

std::string resolution(int n) { return R"("resolution": )" + std::to_string(n); }

TEST_F(OccupancyRoma, RotatesEveryMapToTheBit) {
    RaySource::rays = raysAround(1, 1, 1);
    for (const int n : {32, 64, 128, 256}) {
        Renderer renderer =
            romaRenderer(sceneOf(randomTriangles(300, 1)), resolution(n), R"("angular": 3)", "");
        renderer.frame();
        const Maps maps = mapsOf(renderer);
        ASSERT_GT(setBits(maps.base), 100u);
        std::mt19937 random(7);
        size_t set = 0;
        for (int i = 0; i < 200'000; ++i) {
            const glm::ivec3 cell(random() % maps.n, random() % maps.n, random() % maps.n);
            const int map = static_cast<int>(random() % 9);
            ASSERT_EQ(maps.occupied(map, cell), rotatedBit(maps, map, cell)) << n << " map " << map;
            set += maps.occupied(map, cell);
        }
        EXPECT_GT(set, 100u);
        // Nothing is lost on the way: rotating samples the same solid, so the counts agree to a few percent.
        const double mean = double(setBits(maps.rotated)) / 9;
        EXPECT_NEAR(mean / double(setBits(maps.base)), 1.0, 0.05);
    }
}

// Snapped queries against every cell of the column, for each number of words.
TEST_F(OccupancyRoma, SnappedQueriesAgreeWithBruteForce) {
    for (const float scale : {1.0f, 1e-4f, 1e4f}) {
        for (const int n : {32, 64, 128, 256}) {
            RaySource::rays = raysAround(n <= 64 ? 3000 : 400, scale, 3);
            const std::string roma = R"("angular": 4, "offset": 1.5)";
            Renderer any = romaRenderer(sceneOf(randomTriangles(120, 2, scale)), resolution(n), roma,
                                        R"("query": "any", "snap": true)");
            Renderer closest = romaRenderer(sceneOf(randomTriangles(120, 2, scale)), resolution(n), roma,
                                            R"("query": "closest", "snap": true)");
            any.frame();
            closest.frame();
            const Maps maps = mapsOf(closest);
            const auto anyHits = as<shared::HitRecord>(any.readBytes({"query", "hits"}));
            const auto hits = as<shared::HitRecord>(closest.readBytes({"query", "hits"}));
            int compared = 0, hitCount = 0;
            for (size_t i = 0; i < hits.size(); ++i) {
                const shared::RayRecord& ray = RaySource::rays[i];
                const int map = mapOf(maps, hits[i].direction);
                ASSERT_GE(map, 0);
                ASSERT_GT(glm::dot(hits[i].direction, ray.direction), 0.3f);
                ASSERT_EQ(std::isinf(anyHits[i].t), std::isinf(hits[i].t)) << "any and closest differ";
                const AlignedRay line = aligned(maps, map, ray, hits[i].direction);
                const std::vector<glm::ivec3> cells = columnCells(maps, line);
                const auto sure = ways(cells, line, 1e-3), maybe = ways(cells, line, -1e-3);
                if (sure.size() != maybe.size())
                    continue; // a cell's border decides: rounding may go either way
                const glm::dvec2 inColumn = glm::fract(glm::dvec2(line.origin));
                if (glm::any(glm::lessThan(glm::min(inColumn, 1.0 - inColumn), glm::dvec2(1e-3)))) continue;
                ++compared;
                ASSERT_EQ(sure.empty(), std::isinf(hits[i].t)) << "n " << n << " ray " << i;
                if (sure.empty()) continue;
                ++hitCount;
                // The middle of the cell that is met first, kept within the ray.
                const double cell = maps.grid.cellSize;
                const glm::dvec3 entered = line.origin + line.direction * (sure.front().first + 1e-3);
                const double middle = (std::floor(entered.z) + 0.5 - line.origin.z) / line.direction.z;
                EXPECT_NEAR(hits[i].t / cell, std::clamp(middle, line.from, line.to), 2e-3);
            }
            EXPECT_GT(compared, static_cast<int>(hits.size()) * 9 / 10);
            EXPECT_GT(hitCount, static_cast<int>(hits.size()) / 20);
        }
    }
}

// Unsnapped rays meet cells in many columns: against all occupied cells.
TEST_F(OccupancyRoma, UnsnappedQueriesAgreeWithBruteForce) {
    for (const int n : {32, 64}) {
        RaySource::rays = raysAround(600, 1, 5);
        const std::string roma = R"("angular": 4, "iterations": 256)";
        Renderer any =
            romaRenderer(sceneOf(randomTriangles(400, 4)), resolution(n), roma, R"("query": "any")");
        Renderer closest =
            romaRenderer(sceneOf(randomTriangles(400, 4)), resolution(n), roma, R"("query": "closest")");
        any.frame();
        closest.frame();
        const Maps maps = mapsOf(closest);
        std::vector<std::vector<glm::ivec3>> occupied;
        for (int map = 0; map < 16; ++map) occupied.push_back(occupiedCells(maps, map));
        const auto anyHits = as<shared::HitRecord>(any.readBytes({"query", "hits"}));
        const auto hits = as<shared::HitRecord>(closest.readBytes({"query", "hits"}));
        int compared = 0, hitCount = 0;
        for (size_t i = 0; i < hits.size(); ++i) {
            const shared::RayRecord& ray = RaySource::rays[i];
            EXPECT_EQ(hits[i].direction, ray.direction);
            EXPECT_EQ(hits[i].weight, 1.0f);
            ASSERT_EQ(std::isinf(anyHits[i].t), std::isinf(hits[i].t)) << "any and closest differ";
            const int map = shared::stratumOf(ray.direction.z < 0 ? -ray.direction : ray.direction, 4);
            const AlignedRay line = aligned(maps, map, ray, ray.direction);
            const auto cells = static_cast<size_t>(map);
            const auto sure = ways(occupied[cells], line, 1e-2), maybe = ways(occupied[cells], line, -1e-2);
            ++compared;
            if (std::isinf(hits[i].t)) {
                EXPECT_TRUE(sure.empty()) << "n " << n << " ray " << i << " missed what it meets";
                continue;
            }
            ++hitCount;
            ASSERT_FALSE(maybe.empty()) << "n " << n << " ray " << i << " hit nothing";
            const double t = hits[i].t / maps.grid.cellSize;
            EXPECT_LE(t, sure.empty() ? infinity : sure.front().second + 1e-2) << i;
            EXPECT_TRUE(
                std::any_of(maybe.begin(), maybe.end(),
                            [&](const auto& way) { return t >= way.first - 1e-2 && t <= way.second + 1e-2; }))
                << "n " << n << " ray " << i << " t " << t << " lies in no occupied cell";
        }
        EXPECT_EQ(compared, 600);
        EXPECT_GT(hitCount, 60);
    }
}

} // namespace
} // namespace kestrel::test
