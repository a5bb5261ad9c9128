// Roma against brute force: the rotated maps to the bit, queries against every occupied cell of the same
// maps.
#include "gl/occupancy_fixture.h"
#include "passes/occupancy/candidates.h"
#include "shared/occupied_cells.h"
#include <cstring>
#include <fmt/format.h>

namespace kestrel::test {
namespace {

using OccupancyRoma = GlTest;

// What the passes made, read back.
struct Maps {
    int n = 0;
    shared::OccupancyGrid grid{};
    float offset = 0, skip = 0;
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
    maps.offset = as<shared::OccupancySettings>(block).at(0).originOffset;
    maps.skip = as<shared::OccupancySettings>(block).at(0).skip;
    block.erase(block.begin(), block.begin() + sizeof(shared::OccupancySettings));
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

AlignedRay aligned(const Maps& maps, int map, const shared::RayRecord& ray, const glm::vec3& direction) {
    const glm::vec3 w = maps.directions.at(static_cast<size_t>(map)).direction;
    const glm::dvec3 x(shared::romaAxisX(w)), y(shared::romaAxisY(w)), z(w);
    const auto align = [&](const glm::dvec3& v) {
        return glm::dvec3(glm::dot(v, x), glm::dot(v, y), glm::dot(v, z));
    };
    const double cell = maps.grid.cellSize;
    const glm::dvec3 centred = (glm::dvec3(ray.origin) - glm::dvec3(maps.grid.centre)) / cell +
                               double(maps.offset) * glm::dvec3(ray.normal);
    const double skip = ray.normal == glm::vec3(0) ? 0.0 : maps.skip;
    return {map, align(centred) + 0.5 * maps.n, align(direction), std::max(ray.tMin / cell, skip),
            ray.tMax / cell};
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
            const std::string roma = R"("angular": 4, "offset": 1.5, "skip": 0.7)";
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
                EXPECT_NEAR(hits[i].t / cell, std::clamp(middle, ray.tMin / cell, line.to), 2e-3);
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

// A flat plate across the ball, thin along z.
std::vector<glm::vec3> plate(float z) {
    return {{-0.9f, -0.3f, z}, {0.9f, -0.3f, z}, {0, 0.9f, z}, {0, 0, -1}, {0, 1e-3f, -1}, {1e-3f, 0, -1}};
}

std::vector<shared::HitRecord> queried(const std::vector<glm::vec3>& corners, const std::string& roma,
                                       const std::string& query, RenderOptions options = {}) {
    Renderer renderer =
        romaRenderer(sceneOf(corners), R"("resolution": 64, "method": "exact")", roma, query, options);
    renderer.frame();
    return as<shared::HitRecord>(renderer.readBytes({"query", "hits"}));
}

TEST_F(OccupancyRoma, BoundsOfARayCountInAnyDirection) {
    const Scene scene = sceneOf(plate(0.5f));
    const glm::vec3 shift(scene.origin);
    const float cell = 2.0f / 62;
    const glm::vec3 at = glm::vec3(0, 0.1f, 0) - shift;
    const glm::vec3 up(0, 0, 1);
    RaySource::rays = {
        rayRecord(at, up),                             // meets the plate
        rayRecord(at, -up),                            // goes away from it
        rayRecord(at, up, 0, 0.5f - 3 * cell),         // ends before it
        rayRecord(at, up, 0, 0.5f + 3 * cell),         // ends behind it
        rayRecord(at, up, 0.5f + 3 * cell),            // begins behind it
        rayRecord(at + 3.0f * up, -up),                // comes from outside the map
        rayRecord(at + 3.0f * up, up),                 // never comes in
        rayRecord(at + glm::vec3(5, 0, 0), up),        // passes beside it
        rayRecord(at + 0.5f * up, up, 0, 0.1f * cell), // within the plate's cells
        rayRecord(at, up, 2, 1),                       // is empty
    };
    const bool expected[] = {true, false, false, true, false, true, false, false, true, false};
    for (const char* query : {R"("query": "any")", R"("query": "closest")"}) {
        const auto hits = queried(plate(0.5f), R"("angular": 2, "iterations": 256)", query);
        for (size_t i = 0; i < hits.size(); ++i)
            EXPECT_EQ(!std::isinf(hits[i].t), expected[i]) << query << " ray " << i;
    }
    const auto closest = queried(plate(0.5f), R"("angular": 2, "iterations": 256)", R"("query": "closest")");
    EXPECT_NEAR(closest[0].t, 0.5f, 2 * cell);
    EXPECT_NEAR(closest[5].t, 2.5f, 2 * cell);
}

TEST_F(OccupancyRoma, NothingIsHitInAnEmptyScene) {
    RaySource::rays = raysAround(50, 1, 9);
    for (const char* query : {R"("query": "any", "snap": true)", R"("query": "closest")"}) {
        Renderer renderer = romaRenderer(emptyScene(), "", "", query);
        renderer.frame();
        for (const shared::HitRecord& hit : as<shared::HitRecord>(renderer.readBytes({"query", "hits"})))
            EXPECT_TRUE(std::isinf(hit.t));
        const auto& reasons = renderer.plan().leftOut;
        EXPECT_TRUE(std::any_of(reasons.begin(), reasons.end(), [](const LeftOut& left) {
            return left.why == "the occupancy map is empty";
        }));
    }
}

// aim says what will be traced: the candidate of the ray's stratum, with the weight that C++ works out too.
TEST_F(OccupancyRoma, AimReplacesTheDirectionAndWeighsIt) {
    RaySource::rays.clear();
    std::mt19937 random(8);
    std::normal_distribution<float> normal;
    const auto direction = [&] {
        return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    };
    for (int i = 0; i < 2000; ++i)
        RaySource::rays.push_back(
            rayRecord(glm::vec3(0), direction(), 0, 1, i % 5 == 0 ? glm::vec3(0) : direction()));
    Renderer renderer = romaRenderer(sceneOf(randomTriangles(20, 2)), R"("resolution": 32)",
                                     R"("angular": 5)", R"("query": "any", "snap": true)");
    std::vector<glm::vec3> last;
    for (int frame = 0; frame < 3; ++frame) {
        renderer.frame();
        const Maps maps = mapsOf(renderer);
        const auto hits = as<shared::HitRecord>(renderer.readBytes({"query", "hits"}));
        int atBorder = 0;
        for (size_t i = 0; i < hits.size(); ++i) {
            const shared::RayRecord& ray = RaySource::rays[i];
            const float flip = ray.direction.z < 0 ? -1.0f : 1.0f;
            const auto k = static_cast<size_t>(shared::stratumOf(flip * ray.direction, 5));
            if (hits[i].direction != flip * maps.directions[k].direction) {
                ++atBorder;
                continue;
            }
            const bool surface = ray.normal != glm::vec3(0);
            const float weight =
                surface ? shared::romaWeight(maps.directions[k], flip, hits[i].direction, ray.normal) : 1.0f;
            EXPECT_NEAR(hits[i].weight, weight, 1e-4f * std::max(1.0f, weight));
        }
        EXPECT_LT(atBorder, 3);
        for (const glm::vec3& before : last) EXPECT_NE(before, maps.directions[last.size() - 1].direction);
        last.assign(1, maps.directions[0].direction);
    }
}

TEST_F(OccupancyRoma, WithoutResamplingTheMapsAreMadeOnce) {
    RaySource::rays = raysAround(10, 1, 9);
    RenderOptions options;
    options.timing = true;
    Renderer renderer = romaRenderer(sceneOf(randomTriangles(20, 2)), R"("resolution": 32)",
                                     R"("resample": false)", R"("query": "any", "snap": true)", options);
    const auto rotated = [](const FrameRecord& record) {
        return std::any_of(record.samples.begin(), record.samples.end(),
                           [](const StepSample& sample) { return sample.step == "rotate"; });
    };
    EXPECT_TRUE(rotated(renderer.frame()));
    EXPECT_FALSE(rotated(renderer.frame()));
    renderer.set("roma.resample=true");
    renderer.frame();
    EXPECT_TRUE(rotated(renderer.frame()));
}

// Which of the two ways made the maps: by the work groups of their steps.
bool wereScattered(Renderer& renderer) {
    const std::vector<std::uint32_t> words = wordsOf(renderer, {"roma", "cells"});
    shared::OccupiedCellsHeader header{};
    std::memcpy(&header, words.data(), sizeof(header));
    EXPECT_EQ(header.scatter.x == 0, header.rotate.x > 0);
    return header.scatter.x > 0;
}

TEST_F(OccupancyRoma, ScatteredAndGatheredMapsHaveTheSameBits) {
    RaySource::rays = raysAround(10, 1, 9);
    // Few cells are scattered; where most of the box is full, the list is too short for them.
    for (const auto& [resolution, triangles, scattered] :
         {std::tuple(32, 20, true), std::tuple(64, 300, true), std::tuple(128, 40, true),
          std::tuple(256, 10, true), std::tuple(32, 4000, false)}) {
        const auto mapsBy = [&, n = resolution, count = triangles](const char* rotation, bool& scatter) {
            Renderer renderer =
                romaRenderer(sceneOf(randomTriangles(count, 4)), fmt::format(R"("resolution": {})", n),
                             fmt::format(R"("angular": 3, "rotation": "{}")", rotation),
                             R"("query": "any", "snap": true)");
            renderer.frame();
            renderer.frame(); // where nothing is listed anew
            scatter = std::string_view(rotation) == "automatic" && wereScattered(renderer);
            return mapsOf(renderer).rotated;
        };
        bool scatter = false, gather = false;
        const std::vector<std::uint32_t> made = mapsBy("automatic", scatter);
        EXPECT_EQ(scatter, scattered) << resolution;
        EXPECT_GT(setBits(made), 0u);
        EXPECT_EQ(made, mapsBy("gather", gather)) << resolution;
    }
}

std::vector<glm::vec3> candidatesOf(const Maps& maps) {
    std::vector<glm::vec3> candidates;
    for (const shared::RomaDirection& stratum : maps.directions) candidates.push_back(stratum.direction);
    return candidates;
}

int changes(const std::vector<glm::vec3>& before, const std::vector<glm::vec3>& after) {
    int count = 0;
    for (size_t k = 0; k < before.size(); ++k) count += before[k] != after[k];
    return count;
}

// Each map, renewed in this frame or not, is the base map turned towards its candidate.
void expectMapsOfTheirCandidates(const Maps& maps) {
    std::mt19937 random(7);
    for (int i = 0; i < 20'000; ++i) {
        const glm::ivec3 cell(random() % maps.n, random() % maps.n, random() % maps.n);
        const int map = static_cast<int>(random() % maps.directions.size());
        ASSERT_EQ(maps.occupied(map, cell), rotatedBit(maps, map, cell)) << "map " << map;
    }
    for (size_t k = 0; k < maps.directions.size(); ++k)
        EXPECT_EQ(maps.rotations[k].halfZ, romaRotation(maps.directions[k].direction).halfZ);
}

TEST_F(OccupancyRoma, MapsAreRenewedInTurn) {
    RaySource::rays = raysAround(10, 1, 9);
    for (const auto& [angular, refresh] : {std::pair(4, 4), std::pair(4, 5), std::pair(3, 2)}) {
        const int maps = angular * angular, period = (maps + refresh - 1) / refresh;
        Renderer renderer = romaRenderer(sceneOf(randomTriangles(300, 1)), R"("resolution": 32)",
                                         fmt::format(R"("angular": {}, "refresh": {})", angular, refresh),
                                         R"("query": "any", "snap": true)");
        renderer.frame();
        expectMapsOfTheirCandidates(mapsOf(renderer));
        std::vector<glm::vec3> before = candidatesOf(mapsOf(renderer));
        const std::vector<std::uint32_t> first = mapsOf(renderer).rotated;
        for (int round = 0; round < 3; ++round) {
            const std::vector<glm::vec3> begin = before;
            for (int frame = 0; frame < period; ++frame) {
                renderer.frame();
                const Maps now = mapsOf(renderer);
                expectMapsOfTheirCandidates(now);
                EXPECT_EQ(changes(before, candidatesOf(now)), refresh);
                before = candidatesOf(now);
            }
            EXPECT_EQ(changes(begin, before), maps) << "after " << period << " frames every map is new";
        }
        // A setting that changes, and a map that does, renew all of them.
        renderer.set("roma.offset=1.25");
        renderer.frame();
        EXPECT_EQ(changes(before, candidatesOf(mapsOf(renderer))), maps);
        before = candidatesOf(mapsOf(renderer));
        renderer.set("map.method=dominant_axis");
        renderer.frame();
        expectMapsOfTheirCandidates(mapsOf(renderer));
        EXPECT_EQ(changes(before, candidatesOf(mapsOf(renderer))), maps);
        // From the start: the same again.
        renderer.set("map.method=separating");
        renderer.restart();
        renderer.frame();
        EXPECT_EQ(mapsOf(renderer).rotated, first);
    }
}

TEST_F(OccupancyRoma, AMapThatChangesEveryFrameRenewsAll) {
    RaySource::rays = raysAround(10, 1, 9);
    Renderer all = romaRenderer(sceneOf(randomTriangles(300, 1)), R"("resolution": 32, "jitter": true)", "",
                                R"("query": "any", "snap": true)");
    Renderer turns = romaRenderer(sceneOf(randomTriangles(300, 1)), R"("resolution": 32, "jitter": true)",
                                  R"("refresh": 3)", R"("query": "any", "snap": true)");
    for (int frame = 0; frame < 4; ++frame) {
        all.frame();
        turns.frame();
        EXPECT_EQ(mapsOf(all).rotated, mapsOf(turns).rotated);
        expectMapsOfTheirCandidates(mapsOf(all));
        EXPECT_EQ(candidatesOf(mapsOf(all)), candidatesOf(mapsOf(turns)));
    }
}

TEST_F(OccupancyRoma, RenewingInTurnIsLeftOutWhereNothingIsResampled) {
    RaySource::rays = raysAround(10, 1, 9);
    Renderer renderer = romaRenderer(sceneOf(randomTriangles(20, 2)), R"("resolution": 32)",
                                     R"("resample": false, "refresh": 3)", R"("query": "any", "snap": true)");
    renderer.frame();
    const std::vector<glm::vec3> before = candidatesOf(mapsOf(renderer));
    renderer.frame();
    EXPECT_EQ(changes(before, candidatesOf(mapsOf(renderer))), 0);
    const auto& reasons = renderer.plan().leftOut;
    EXPECT_TRUE(std::any_of(reasons.begin(), reasons.end(), [](const LeftOut& left) {
        return left.why == "the candidates stay as they are";
    }));
}

// What renewing in turn costs in noise: the variance over time of the visibility that a history of ten frames
// holds (weight 1/10 for the new frame), per point, averaged. Each frame draws new rays, as ambient occlusion
// does, so that only a part of the noise comes from the candidates.
TEST_F(OccupancyRoma, VarianceUnderAHistoryOfTenFrames) {
    constexpr int points = 1500, warmUp = 40, frames = 200;
    std::mt19937 place(3);
    std::normal_distribution<float> normal;
    const auto unit = [&](std::mt19937& random) {
        return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    };
    std::vector<glm::vec3> origins, normals;
    for (int i = 0; i < points; ++i) {
        origins.push_back(0.6f * unit(place));
        normals.push_back(unit(place));
    }
    RaySource::rays = raysAround(points, 1, 1); // as many as in each frame
    std::map<int, double> variance;
    std::map<int, std::unique_ptr<Renderer>> renderers;
    for (const int refresh : {0, 8, 4, 2})
        renderers[refresh].reset(new Renderer(
            romaRenderer(sceneOf(randomTriangles(400, 6)), R"("resolution": 32)",
                         fmt::format(R"("refresh": {})", refresh), R"("query": "any", "snap": true)")));
    std::map<int, std::vector<double>> history, sum, squares;
    for (const auto& [refresh, renderer] : renderers) {
        history[refresh].assign(points, 0);
        sum[refresh].assign(points, 0);
        squares[refresh].assign(points, 0);
    }
    std::mt19937 random(5);
    for (int frame = 0; frame < warmUp + frames; ++frame) {
        RaySource::rays.clear();
        for (size_t i = 0; i < points; ++i) // around the normal with density cosine
            RaySource::rays.push_back(rayRecord(origins[i], normals[i] + 0.999f * unit(random), 0,
                                                std::numeric_limits<float>::infinity(), normals[i]));
        for (auto& [refresh, renderer] : renderers) {
            renderer->frame();
            const auto hits = as<shared::HitRecord>(renderer->readBytes({"query", "hits"}));
            for (size_t i = 0; i < points; ++i) {
                const double visible = std::isinf(hits[i].t) ? 1 : 0;
                double& held = history[refresh][i];
                held = frame == 0 ? visible : 0.9 * held + 0.1 * visible;
                if (frame < warmUp) continue;
                sum[refresh][i] += held;
                squares[refresh][i] += held * held;
            }
        }
    }
    for (const auto& [refresh, total] : sum)
        for (size_t i = 0; i < points; ++i) {
            const double mean = total[i] / frames;
            variance[refresh] += (squares[refresh][i] / frames - mean * mean) / points;
        }
    for (const auto& [refresh, value] : variance)
        fmt::print("refresh {}: variance {:.5f}, {:.2f} of renewing all\n", refresh, value,
                   value / variance[0]);
    EXPECT_GT(variance[0], 0);
    EXPECT_LT(variance[8] / variance[0], 1.1); // measured: 1.03
    EXPECT_LT(variance[4] / variance[0], 1.2); // 1.12
    EXPECT_LT(variance[2] / variance[0], 1.4); // 1.27
}

// Rays that run out of columns are counted, and reported with the next frame.
TEST_F(OccupancyRoma, CountsExhaustedRays) {
    RaySource::rays.clear();
    // Below the plate, across half the map, far from any candidate's axis at 2 x 2 strata.
    for (int i = 0; i < 100; ++i)
        RaySource::rays.push_back(rayRecord({-0.9f, 0, -0.5f}, {1, 0.001f * float(i), 0.02f}));
    for (const auto& [iterations, exhausted] : {std::pair(1, 100.0), std::pair(256, 0.0)}) {
        Renderer renderer = romaRenderer(sceneOf(plate(0.5f)), R"("resolution": 64)",
                                         R"("angular": 2, "count_exhausted": true, "iterations": )" +
                                             std::to_string(iterations),
                                         R"("query": "any")");
        renderer.frame();
        const auto& values = renderer.frame().values.at("roma");
        EXPECT_EQ(values.at("rays"), 100.0);
        EXPECT_EQ(values.at("exhausted rays"), exhausted);
    }
}

TEST_F(OccupancyRoma, RefusesABufferThatIsNoMap) {
    Roma roma;
    Inputs inputs;
    inputs.set("occupancy", {Desc::buffer(1000, Format::R32UI), {}, Causes::All});
    inputs.set("grid", {Desc::buffer(32), {}, Causes::All});
    Declaration declaration = roma.declare({}, inputs, Demand::everything());
    ASSERT_EQ(declaration.problems.size(), 1u);
    EXPECT_EQ(declaration.problems[0].port, "occupancy");
    // 256 maps of 256 cells an edge are more than the least that OpenGL promises for a storage block.
    inputs.set("occupancy", {Desc::buffer(occupancyBytes(256), Format::R32UI), {}, Causes::All});
    roma.angular = 16;
    declaration = roma.declare({}, inputs, Demand::everything());
    ASSERT_EQ(declaration.problems.size(), 1u);
    EXPECT_NE(declaration.problems[0].message.find("536870912"), std::string::npos);
}

} // namespace
} // namespace kestrel::test
