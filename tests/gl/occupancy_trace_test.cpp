// Walking through an occupancy map: every method finds the same cells to the bit, and those that brute force
// finds.
#include "gl/occupancy_fixture.h"
#include "scene/scene.h"
#include <fmt/format.h>

namespace kestrel::test {
namespace {

using OccupancyTraceGl = GlTest;

const std::vector<std::string> walks = {R"("method": "dda_3d")", R"("method": "dda_2d", "mips": false)",
                                        R"("method": "dda_2d", "mips": true)", R"("method": "bricks")"};

// RaySource::rays through MapSource's map by each of the walks.
Renderer walkRenderer(const std::string& properties, const std::string& query) {
    std::string passes = R"("map": {"type": "MapSource"}, "rays": {"type": "RaySource"})", edges, outputs;
    for (size_t i = 0; i < walks.size(); ++i) {
        passes += fmt::format(R"(, "walk{0}": {{"type": "OccupancyTrace", "properties": {{{1}{2}}}}},
            "query{0}": {{"type": "RayQuery", "properties": {{{3}}}}})",
                              i, walks[i], properties.empty() ? "" : ", " + properties, query);
        edges += fmt::format(R"({1}["map.occupancy", "walk{0}.occupancy"], ["map.grid", "walk{0}.grid"],
            ["rays.rays", "query{0}.rays"], ["walk{0}.tracer", "query{0}.tracer"])",
                             i, i == 0 ? "" : ", ");
        outputs += fmt::format(R"({}"query{}.hits")", i == 0 ? "" : ", ", i);
    }
    const Graph graph = parseGraph(R"({"kestrel": 1, "passes": {)" + passes + R"(}, "edges": [)" + edges +
                                       R"(], "outputs": [)" + outputs + "]}",
                                   "test.json");
    return {graph, registry(), emptyScene(), context().capabilities(), smallFrame()};
}

std::vector<std::vector<shared::HitRecord>> walked(const std::string& properties, const std::string& query) {
    Renderer renderer = walkRenderer(properties, query);
    renderer.frame();
    std::vector<std::vector<shared::HitRecord>> hits;
    for (size_t i = 0; i < walks.size(); ++i)
        hits.push_back(as<shared::HitRecord>(renderer.readBytes({fmt::format("query{}", i), "hits"})));
    return hits;
}

// Fills MapSource: single cells (a share of all), and plates of the kind that surfaces make.
void fillMap(int n, double share, int plates, std::uint32_t seed) {
    MapSource::begin(n);
    std::mt19937 random(seed);
    const auto cell = [&] { return static_cast<int>(random() % static_cast<std::uint32_t>(n)); };
    const auto count = static_cast<int>(share * n * n * n);
    for (int i = 0; i < count; ++i) MapSource::mark({cell(), cell(), cell()});
    for (int i = 0; i < plates; ++i) {
        const int axis = cell() % 3, height = cell(), size = 2 + cell() / 3, u0 = cell(), v0 = cell();
        for (int u = u0; u < std::min(n, u0 + size); ++u)
            for (int v = v0; v < std::min(n, v0 + size); ++v) {
                glm::ivec3 at(u, v, height);
                std::swap(at[axis], at.z);
                MapSource::mark(at);
            }
    }
}

// Rays for which a border decides: from corners, edges and faces of cells, along axes and diagonals, on the
// cube's own faces, and ending exactly at a plane.
std::vector<shared::RayRecord> borderRays(int n, int count, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto cell = [&] { return static_cast<int>(random() % static_cast<std::uint32_t>(n + 1)); };
    std::vector<shared::RayRecord> rays;
    for (int i = 0; i < count; ++i) {
        glm::vec3 at(cell(), cell(), cell());
        if (i % 4 == 1) at[i % 3] += 0.5f;
        if (i % 4 == 2) at += glm::vec3(0.5f, 0.25f, 0);
        if (i % 7 == 3) at[i % 3] = i % 2 == 0 ? 0.0f : float(n);
        if (i % 11 == 4) at[i % 3] += i % 2 == 0 ? float(2 * n) : float(-2 * n); // outside
        glm::vec3 direction(0);
        while (direction == glm::vec3(0))
            for (int k = 0; k < 3; ++k) direction[k] = float(static_cast<int>(random() % 5) - 2);
        if (i % 3 == 0)
            direction = glm::vec3(i % 9 == 0, i % 9 == 3, i % 9 == 6) * (i % 2 == 0 ? 1.0f : -1.0f);
        if (i % 13 == 5) direction.z = -0.0f;
        if (direction == glm::vec3(0)) direction.x = 1;
        const float to = i % 5 == 0 ? float(cell()) : std::numeric_limits<float>::infinity();
        shared::RayRecord ray = rayRecord((at - 0.5f * float(n)) / 32.0f, direction, 0, to / 32);
        // Not quite along an axis: planes along the other two are passed late, or never.
        if (i % 17 == 6) ray.direction = {1, 1e-9f, -1e-13f};
        rays.push_back(ray);
    }
    return rays;
}

AlignedRay inCells(const shared::RayRecord& ray, double offset, double skip) {
    const shared::OccupancyGrid& grid = MapSource::grid;
    const double cell = grid.cellSize;
    const bool surface = ray.normal != glm::vec3(0);
    return {0, glm::dvec3(ray.origin) / cell + offset * glm::dvec3(ray.normal) + double(grid.halfResolution),
            glm::dvec3(ray.direction), std::max(ray.tMin / cell, surface ? skip : 0.0), ray.tMax / cell};
}

std::vector<glm::ivec3> mapCells() {
    const int n = static_cast<int>(MapSource::grid.resolution);
    std::vector<glm::ivec3> cells;
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                if (isSet(MapSource::words, n, {x, y, z})) cells.emplace_back(x, y, z);
    return cells;
}

// Hits of the walks agree in every bit; how many there are.
int expectSameHits(const std::vector<std::vector<shared::HitRecord>>& closest,
                   const std::vector<std::vector<shared::HitRecord>>& any, const std::string& what) {
    int hitCount = 0;
    for (size_t i = 0; i < closest[0].size(); ++i) {
        const shared::HitRecord& first = closest[0][i];
        hitCount += !std::isinf(first.t);
        for (size_t walk = 0; walk < closest.size(); ++walk) {
            const shared::HitRecord& hit = closest[walk][i];
            EXPECT_EQ(std::memcmp(&hit, &first, sizeof(hit)), 0)
                << what << " ray " << i << ": " << walks[walk] << " finds " << hit.t << " " << std::hex
                << hit.idX << ", not " << first.t << " " << first.idX;
            EXPECT_EQ(std::isinf(any[walk][i].t), std::isinf(first.t)) << what << " ray " << i;
        }
        if (::testing::Test::HasFailure()) return hitCount;
    }
    return hitCount;
}

TEST_F(OccupancyTraceGl, EveryMethodFindsTheSameCellsToTheBit) {
    for (const int n : {32, 64, 128, 256}) {
        const float reach = float(n) / 64;
        for (const auto& [share, plates] : {std::pair(0.0, 1), std::pair(0.0005, 12), std::pair(0.02, 40)}) {
            fillMap(n, share, plates, 11);
            for (const bool border : {false, true}) {
                RaySource::rays = border ? borderRays(n, 20'000, 5) : raysAround(20'000, reach, 3);
                const std::string properties = R"("offset": 1.25, "skip": 0.75)";
                const auto closest = walked(properties, R"("query": "closest")");
                const int hits = expectSameHits(closest, walked(properties, R"("query": "any")"),
                                                fmt::format("n {} share {} border {}", n, share, border));
                EXPECT_GE(hits, share > 0 ? 500 : 0) << n;
                RaySource::texels = true;
                const auto many = walked(properties, R"("query": "any")");
                RaySource::texels = false;
                for (size_t walk = 0; walk < walks.size(); ++walk)
                    for (size_t i = 0; i < RaySource::rays.size(); ++i)
                        ASSERT_EQ(std::isinf(many[walk][i].t), std::isinf(closest[0][i].t))
                            << walks[walk] << " ray " << i << " of many";
            }
        }
    }
}

TEST_F(OccupancyTraceGl, FindsWhatBruteForceFinds) {
    for (const int n : {32, 64}) {
        fillMap(n, 0.001, 16, 4);
        const std::vector<glm::ivec3> cells = mapCells();
        RaySource::rays = raysAround(3000, float(n) / 64, 8);
        const auto hits = walked(R"("offset": 1.25, "skip": 0.75)", R"("query": "closest")")[2];
        int hitCount = 0;
        for (size_t i = 0; i < hits.size(); ++i) {
            const shared::RayRecord& ray = RaySource::rays[i];
            EXPECT_EQ(hits[i].direction, ray.direction);
            EXPECT_EQ(hits[i].weight, 1.0f);
            const AlignedRay line = inCells(ray, 1.25, 0.75);
            const auto sure = ways(cells, line, 1e-3), maybe = ways(cells, line, -1e-3);
            if (std::isinf(hits[i].t)) {
                EXPECT_TRUE(sure.empty()) << "n " << n << " ray " << i << " missed what it meets";
                continue;
            }
            ++hitCount;
            // The cell that it names is occupied and met, and none that is surely met lies before it.
            const std::uint32_t id = hits[i].idX;
            const glm::ivec3 cell(id & 255, id >> 8 & 255, id >> 16);
            ASSERT_TRUE(isSet(MapSource::words, n, cell));
            const auto way = ways({cell}, line, -1e-3);
            ASSERT_EQ(way.size(), 1u) << "n " << n << " ray " << i << " does not meet the cell it names";
            EXPECT_LE(way[0].first, sure.empty() ? infinity : sure[0].first + 2e-3) << i;
            const double middle = 0.5 * (way[0].first + way[0].second);
            EXPECT_NEAR(hits[i].t * 32, std::clamp(middle, ray.tMin * 32.0, ray.tMax * 32.0), 2e-3) << i;
            ASSERT_FALSE(maybe.empty());
        }
        EXPECT_GT(hitCount, 200);
    }
}

// A shared plane belongs to the cell that is entered; a ray within a face of the cube counts as inside.
TEST_F(OccupancyTraceGl, RaysAlongAxesMeetTheirColumn) {
    MapSource::begin(32);
    MapSource::mark({20, 7, 9});
    const auto at = [](float x, float y, float z) { return (glm::vec3(x, y, z) - 16.0f) / 32.0f; };
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    RaySource::rays = {
        rayRecord(at(0.5f, 7.5f, 9.5f), x),                // meets it
        rayRecord(at(-40, 7, 9), x),                       // on an edge of it, from outside
        rayRecord(at(0.5f, 8.5f, 9.5f), x),                // beside it
        rayRecord(at(31.5f, 7.5f, 9.5f), -x),              // from the other side
        rayRecord(at(31.5f, 7.5f, 9.5f), x),               // away from it
        rayRecord(at(20.5f, 31, 9.5f), -y),                // along y
        rayRecord(at(20.5f, 7.5f, 60), -z),                // along z from outside
        rayRecord(at(20.5f, 7.5f, 60), z),                 // and away
        rayRecord(at(20.5f, 7.5f, 0.5f), z, 0, 8.4f / 32), // ends before it
        rayRecord(at(20.5f, 7.5f, 0.5f), z, 0, 8.6f / 32), // ends in it
        rayRecord(at(20.5f, 7.5f, 9.5f), x, 0, 0.1f / 32), // within it
        rayRecord(at(20.5f, 7.5f, 0.5f), z, 9.6f / 32),    // begins behind it
        rayRecord(at(20.5f, 7.5f, 9.5f), x, 2, 1),         // is empty
    };
    const bool expected[] = {true,  true,  false, true, false, true, true,
                             false, false, true,  true, false, false};
    const auto hits = walked("", R"("query": "closest")");
    const auto any = walked("", R"("query": "any")");
    for (size_t walk = 0; walk < walks.size(); ++walk)
        for (size_t i = 0; i < std::size(expected); ++i) {
            EXPECT_EQ(!std::isinf(hits[walk][i].t), expected[i]) << walks[walk] << " ray " << i;
            EXPECT_EQ(!std::isinf(any[walk][i].t), expected[i]) << walks[walk] << " ray " << i;
        }
    EXPECT_FLOAT_EQ(hits[0][0].t * 32, 20); // the middle of its way through the cell
    EXPECT_FLOAT_EQ(hits[0][6].t * 32, 50.5f);
}

TEST_F(OccupancyTraceGl, CountsExhaustedRays) {
    MapSource::begin(64);
    MapSource::mark({63, 32, 32});
    RaySource::rays.assign(50, rayRecord({-0.9f, 0.01f, 0.02f}, {1, 0.001f, 0.002f}));
    for (const auto& [iterations, exhausted, many] :
         {std::tuple(1, 50.0, false), std::tuple(256, 0.0, false), std::tuple(1, 50.0, true),
          std::tuple(256, 0.0, true)}) {
        RaySource::texels = many;
        Renderer renderer = walkRenderer(
            fmt::format(R"("count_exhausted": true, "iterations": {})", iterations), R"("query": "any")");
        renderer.frame();
        const auto& values = renderer.frame().values;
        for (const char* walk : {"walk0", "walk1", "walk2", "walk3"}) {
            EXPECT_EQ(values.at(walk).at("rays"), 50.0);
            EXPECT_EQ(values.at(walk).at("exhausted rays"), exhausted) << walk;
        }
    }
    RaySource::texels = false;
}

// The scene's own map: scale does not matter, and an empty scene is left out.
TEST_F(OccupancyTraceGl, WorksAtAnyScaleAndWithoutAScene) {
    const auto traced = [](Scene scene) {
        const Graph graph = parseGraph(R"({"kestrel": 1, "passes": {
                "map": {"type": "OccupancyMap", "properties": {"resolution": 32}},
                "walk": {"type": "OccupancyTrace"}, "rays": {"type": "RaySource"},
                "query": {"type": "RayQuery", "properties": {"query": "closest"}}},
            "edges": [["map.occupancy", "walk.occupancy"], ["map.grid", "walk.grid"],
                      ["rays.rays", "query.rays"], ["walk.tracer", "query.tracer"]],
            "outputs": ["query.hits"]})",
                                       "test.json");
        Renderer renderer(graph, registry(), std::move(scene), context().capabilities(), smallFrame());
        renderer.frame();
        return as<shared::HitRecord>(renderer.readBytes({"query", "hits"}));
    };
    std::vector<std::vector<shared::HitRecord>> found;
    for (const float scale : {1.0f, 1.0f / 8192, 8192.0f}) { // powers of two: the same cells
        RaySource::rays = raysAround(500, scale, 3);
        found.push_back(traced(sceneOf(randomTriangles(60, 2, scale))));
        int hits = 0;
        for (size_t i = 0; i < found.back().size(); ++i) {
            hits += !std::isinf(found.back()[i].t);
            EXPECT_EQ(found.back()[i].idX, found.front()[i].idX) << scale;
        }
        EXPECT_GT(hits, 30);
    }
    for (const shared::HitRecord& hit : traced(emptyScene())) EXPECT_TRUE(std::isinf(hit.t));
}

// From the inner sides of a sealed room with walls of one cell and more, at most one ray in a hundred gets
// out, where cells are marked and rays start as they do by default, and where all cells that walls touch are
// marked.
TEST_F(OccupancyTraceGl, WallsOfACellHoldTheRays) {
    const glm::dquat turned(glm::dvec3(0.3, 0.5, 0.2)); // as the scene is
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const auto& [tenths, method] :
         {std::pair(10, "exact"), std::pair(15, "exact"), std::pair(20, "exact"), std::pair(30, "exact"),
          std::pair(10, "separating"), std::pair(15, "separating"), std::pair(20, "separating"),
          std::pair(30, "separating")}) {
        const double within = 1 - 0.1 * tenths * 2 * std::sqrt(3.0) / 126;
        RaySource::rays.clear();
        for (int i = 0; i < 20'000; ++i) {
            glm::dvec3 point = within * glm::dvec3(unit(random), unit(random), unit(random));
            glm::dvec3 normal(0), direction(unit(random), unit(random), unit(random));
            const double side = i % 2 == 0 ? 1 : -1;
            normal[i % 3] = -side;
            point[i % 3] = side * within;
            direction[i % 3] = -side * std::abs(direction[i % 3]);
            RaySource::rays.push_back(rayRecord(glm::vec3(turned * point), glm::vec3(turned * direction), 0,
                                                std::numeric_limits<float>::infinity(),
                                                glm::vec3(turned * normal)));
        }
        const Graph graph = parseGraph(R"({"kestrel": 1, "passes": {
                "map": {"type": "OccupancyMap", "properties": {"method": ")" +
                                           std::string(method) + R"("}},
                "walk": {"type": "OccupancyTrace"}, "roma": {"type": "Roma"}, "rays": {"type": "RaySource"},
                "walked": {"type": "RayQuery"}, "snapped": {"type": "RayQuery", "properties": {"snap": true}}},
            "edges": [["map.occupancy", "walk.occupancy"], ["map.grid", "walk.grid"],
                      ["map.occupancy", "roma.occupancy"], ["map.grid", "roma.grid"],
                      ["rays.rays", "walked.rays"], ["walk.tracer", "walked.tracer"],
                      ["rays.rays", "snapped.rays"], ["roma.tracer", "snapped.tracer"]],
            "outputs": ["walked.hits", "snapped.hits"]})",
                                       "test.json");
        Renderer renderer(graph, registry(), loadScene(fmt::format("builtin:stress_sealed?count={}", tenths)),
                          context().capabilities(), smallFrame());
        renderer.frame();
        for (const char* query : {"walked", "snapped"}) {
            int leaks = 0;
            for (const shared::HitRecord& hit : as<shared::HitRecord>(renderer.readBytes({query, "hits"})))
                leaks += std::isinf(hit.t) && hit.weight > 0;
            EXPECT_LE(leaks, 200) << query << " through walls of " << tenths << " tenths of a cell, "
                                  << method;
        }
    }
}

} // namespace
} // namespace kestrel::test
