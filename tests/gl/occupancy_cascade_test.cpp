// Nested maps around the camera: cells and rotated bits to the bit, queries and ambient occlusion against
// triangles.
#include "gl/occupancy_fixture.h"
#include "passes/occupancy/candidates.h"
#include "passes/occupancy_oracle.h"
#include "scene/bvh_trace.h"
#include "scene/geometry.h"
#include "shared/occupied_cells.h"
#include <fmt/format.h>
#include <list>

namespace kestrel::test {
namespace {

using OccupancyCascade = GlTest;

// RaySource::rays through a tracer "map" made of `passes` and `edges`: hits at "query.hits".
Graph tracingGraph(const std::string& passes, const std::string& edges, const std::string& query) {
    return parseGraph(
        R"({"kestrel": 1, "passes": {)" + passes +
            R"(, "rays": {"type": "RaySource"},
            "query": {"type": "RayQuery", "properties": {)" +
            query + R"(}}},
        "edges": [)" +
            edges +
            R"(["rays.rays", "query.rays"], ["map.tracer", "query.tracer"]], "outputs": ["query.hits"]})",
        "test.json");
}

Graph cascadeGraph(const std::string& properties, const std::string& query) {
    return tracingGraph(R"("map": {"type": "RomaCascade", "properties": {)" + properties + "}}", "", query);
}

RenderOptions cascadePreviews() {
    RenderOptions options;
    for (const char* port : {"occupancy", "grids", "maps", "rotations", "directions"})
        options.previews.push_back({"map", port});
    return smallFrame(options);
}

void lookFrom(Renderer& renderer, const glm::vec3& position) {
    CameraState camera;
    camera.position = position;
    camera.view[3] = glm::vec4(-position, 1);
    renderer.setFreeCamera(camera);
}

std::vector<shared::OccupancyGrid> gridsOf(Renderer& renderer) {
    return as<shared::OccupancyGrid>(renderer.readBytes({"map", "grids"}));
}

// Both base maps and rotated maps of all levels are what they must be.
void expectLevels(Renderer& renderer, const Scene& scene) {
    const std::vector<shared::OccupancyGrid> grids = gridsOf(renderer);
    const auto occupancy = wordsOf(renderer, {"map", "occupancy"});
    const auto maps = wordsOf(renderer, {"map", "maps"});
    const auto rotations = as<shared::RomaRotation>(renderer.readBytes({"map", "rotations"}));
    const int n = static_cast<int>(grids[0].resolution);
    const size_t words = static_cast<size_t>(n) * n * n / 32;
    const Geometry geometry = flatten(scene, 0);
    std::mt19937 random(3);
    for (size_t level = 0; level < grids.size(); ++level) {
        const std::vector<std::uint32_t> base(occupancy.begin() + static_cast<std::ptrdiff_t>(level * words),
                                              occupancy.begin() +
                                                  static_cast<std::ptrdiff_t>((level + 1) * words));
        EXPECT_EQ(base, oracleMap(geometry, grids[level])) << "level " << level;
        for (int i = 0; i < 5000; ++i) {
            const glm::ivec3 cell(random() % n, random() % n, random() % n);
            const size_t map = random() % rotations.size();
            const shared::RomaRotation& axes = rotations[map];
            const glm::ivec3 odd = 2 * cell + 1 - n;
            const glm::ivec3 at = glm::ivec3(n / 2 << shared::romaFractionBits) +
                                  odd.x * glm::ivec3(axes.halfX) + odd.y * glm::ivec3(axes.halfY) +
                                  odd.z * glm::ivec3(axes.halfZ);
            bool expected = true;
            glm::ivec3 source(0);
            for (int k = 0; k < 3; ++k) {
                source[k] = at[k] >> shared::romaFractionBits;
                expected = expected && source[k] >= 0 && source[k] < n;
            }
            expected = expected && isSet(base, n, source);
            const size_t column = ((level * rotations.size() + map) * n + cell.y) * n + cell.x;
            const std::uint32_t word = maps.at(column * (n / 32) + (cell.z >> 5));
            ASSERT_EQ((word >> (cell.z & 31) & 1u) != 0, expected) << "level " << level << " map " << map;
        }
    }
}

TEST_F(OccupancyCascade, LevelsAreMarkedAndRotatedWhereTheCameraIs) {
    RaySource::rays = raysAround(10, 1, 9);
    const Scene scene = sceneOf(randomTriangles(200, 1));
    for (const auto& [levels, refresh] : {std::pair(2, 0), std::pair(4, 5)}) {
        Renderer renderer(
            cascadeGraph(fmt::format(R"("levels": {}, "resolution": 32, "refresh": {})", levels, refresh),
                         R"("snap": true)"),
            registry(), scene, context().capabilities(), cascadePreviews());
        const auto marked = [&] { return renderer.last().values.at("map").at("levels marked"); };
        lookFrom(renderer, {0.3f, -0.2f, 0.1f});
        renderer.frame();
        EXPECT_EQ(marked(), levels);
        expectLevels(renderer, scene);
        const std::vector<shared::OccupancyGrid> grids = gridsOf(renderer);
        EXPECT_EQ(grids.back().centre, renderer.facts().sphere.centre);
        for (size_t i = 0; i + 1 < grids.size(); ++i) {
            EXPECT_FLOAT_EQ(grids[i].cellSize, 0.5f * grids[i + 1].cellSize);
            const glm::vec3 aside = glm::abs(grids[i].centre - glm::vec3(0.3f, -0.2f, 0.1f));
            EXPECT_LE(std::max(aside.x, std::max(aside.y, aside.z)), 0.501f * grids[i].cellSize);
        }
        renderer.frame();
        EXPECT_EQ(marked(), 0) << "nothing has changed";
        expectLevels(renderer, scene);
        // On by a cell of the finest level: that one alone.
        lookFrom(renderer, glm::vec3(0.3f, -0.2f, 0.1f) + glm::vec3(1.01f * grids[0].cellSize, 0, 0));
        renderer.frame();
        EXPECT_GE(marked(), 1);
        EXPECT_LT(marked(), levels);
        expectLevels(renderer, scene);
        lookFrom(renderer, {-0.5f, 0.4f, 0.2f});
        renderer.frame();
        EXPECT_EQ(marked(), levels - 1) << "the coarsest lies around the scene";
        expectLevels(renderer, scene);
    }
}

// From the occupied cells alone, or by visiting all: the same maps to the bit, while the camera moves and
// maps are renewed in turn.
TEST_F(OccupancyCascade, ScatteredMapsAreTheGatheredOnes) {
    RaySource::rays = raysAround(10, 1, 9);
    const Scene scene = sceneOf(randomTriangles(12, 1));
    for (const int refresh : {0, 5}) {
        std::list<Renderer> renderers; // which do not move
        for (const char* rotation : {"automatic", "gather"}) {
            RenderOptions options = cascadePreviews();
            if (renderers.empty()) options.previews.push_back({"map", "cells"});
            renderers.emplace_back(
                cascadeGraph(fmt::format(R"("levels": 3, "resolution": 64, "refresh": {}, "rotation": "{}")",
                                         refresh, rotation),
                             R"("snap": true)"),
                registry(), scene, context().capabilities(), options);
        }
        for (const glm::vec3& camera :
             {glm::vec3(0.3f, -0.2f, 0.1f), glm::vec3(0.3f, -0.2f, 0.1f), glm::vec3(0.31f, -0.2f, 0.1f),
              glm::vec3(-0.5f, 0.4f, 0.2f), glm::vec3(-0.5f, 0.4f, 0.2f)}) {
            std::vector<std::vector<std::uint32_t>> maps;
            for (Renderer& renderer : renderers) {
                lookFrom(renderer, camera);
                renderer.frame();
                maps.push_back(wordsOf(renderer, {"map", "maps"}));
            }
            EXPECT_GT(setBits(maps[0]), 1000u);
            ASSERT_EQ(maps[0], maps[1]) << "refresh " << refresh;
        }
        // That something was scattered at all.
        const std::vector<std::byte> cells = renderers.front().readBytes({"map", "cells"});
        for (size_t level = 0; level < 3; ++level) {
            shared::OccupiedCellsHeader header{};
            std::memcpy(&header, cells.data() + level * cells.size() / 3, sizeof(header));
            EXPECT_GT(header.count, 0u);
            EXPECT_GT(header.scatter.x, 0u) << "level " << level;
            EXPECT_EQ(header.rotate.x, 0u);
        }
    }
}

// The distances found along the directions really traced, against the triangles.
TEST_F(OccupancyCascade, ClosestHitsLieNearThoseOfTheTriangles) {
    std::vector<glm::vec3> corners;
    for (const glm::vec3& p : randomTriangles(24, 5)) corners.push_back(0.95f * glm::normalize(p + 0.01f));
    for (size_t i = 0; i < corners.size(); i += 3) { // large ones, each about a point of a small one
        corners[i + 1] = glm::vec3(corners[i].y, -corners[i].z, 0.3f * corners[i].x);
        corners[i + 2] = 0.4f * glm::vec3(-corners[i].z, corners[i].x, corners[i].y);
    }
    const Scene scene = sceneOf(corners);
    const Bvh bvh = buildBvh(flatten(scene, 0), {});
    const glm::vec3 camera(0.2f, 0.1f, -0.3f);
    for (const bool snap : {true, false}) {
        RaySource::rays = raysAround(6000, 1, 4);
        for (size_t i = 0; i < RaySource::rays.size(); ++i) {
            shared::RayRecord& ray = RaySource::rays[i];
            ray.normal = glm::vec3(0);
            if (i % 3 != 0) ray.origin = camera + 0.3f * ray.origin;
        }
        const std::string query = snap ? R"("snap": true)" : R"("snap": false)";
        const std::string properties = R"("levels": 3, "resolution": 128, "iterations": 256)";
        Renderer closest(cascadeGraph(properties, query + R"(, "query": "closest")"), registry(), scene,
                         context().capabilities(), cascadePreviews());
        Renderer any(cascadeGraph(properties, query + R"(, "query": "any")"), registry(), scene,
                     context().capabilities(), cascadePreviews());
        for (Renderer* renderer : {&closest, &any}) {
            lookFrom(*renderer, camera);
            renderer->frame();
        }
        const auto hits = as<shared::HitRecord>(closest.readBytes({"query", "hits"}));
        const auto anyHits = as<shared::HitRecord>(any.readBytes({"query", "hits"}));
        const auto grids = gridsOf(closest);
        int agree = 0, hitCount = 0, missed = 0, found[3] = {};
        for (size_t i = 0; i < hits.size(); ++i) {
            const shared::RayRecord& ray = RaySource::rays[i];
            EXPECT_EQ(std::isinf(hits[i].t), std::isinf(anyHits[i].t));
            const auto truth = closestHit(bvh, {ray.origin, hits[i].direction, ray.tMin, ray.tMax});
            hitCount += truth.has_value();
            if (std::isinf(hits[i].t)) {
                missed += truth.has_value();
                continue;
            }
            const size_t level = hits[i].idX / 16;
            ++found[level];
            EXPECT_GE(hits[i].t, ray.tMin);
            EXPECT_LE(hits[i].t, ray.tMax);
            agree += truth && std::abs(truth->t - hits[i].t) < 3 * grids[level].cellSize;
        }
        fmt::print("{}: {} of {} hits, {} missed; by level {} {} {}\n", snap ? "snapped" : "exact", agree,
                   hitCount, missed, found[0], found[1], found[2]);
        ASSERT_GT(hitCount, 400);
        // Thin triangles fall between the turned cells of a map now and then; a ray past an edge hits a cell.
        EXPECT_LT(missed, hitCount / 100);
        EXPECT_GT(agree, hitCount * 8 / 10);
        for (const int count : found) EXPECT_GT(count, 20);
    }
}

TEST_F(OccupancyCascade, NothingIsHitInAnEmptyScene) {
    RaySource::rays = raysAround(50, 1, 9);
    Renderer renderer(cascadeGraph("", ""), registry(), emptyScene(), context().capabilities(), smallFrame());
    renderer.frame();
    for (const shared::HitRecord& hit : as<shared::HitRecord>(renderer.readBytes({"query", "hits"})))
        EXPECT_TRUE(std::isinf(hit.t));
}

TEST_F(OccupancyCascade, CountsExhaustedRays) {
    // Through the bodies of all spheres, clear of everything.
    RaySource::rays.assign(40, rayRecord({-0.9f, 0.4f, 0.4f}, {1, 0.02f, 0.01f}));
    for (const int iterations : {1, 256}) {
        Renderer renderer(
            cascadeGraph(
                fmt::format(R"("count_exhausted": true, "angular": 2, "iterations": {})", iterations), ""),
            registry(),
            sceneOf({{-1, 0, 0}, {-1, 0.01f, 0}, {-1, 0, 0.01f}, {1, 0, 0}, {1, 0.01f, 0}, {1, 0, 0.01f}}),
            context().capabilities(), smallFrame());
        lookFrom(renderer, {0, 0, 0});
        renderer.frame();
        const auto& values = renderer.frame().values.at("map");
        EXPECT_EQ(values.at("rays"), 40.0);
        EXPECT_EQ(values.at("exhausted rays") > 0, iterations == 1);
    }
}

// A body in the middle of a floor sixteen times its size, and what is seen of it from close by.
struct NearField {
    Scene scene;
    glm::vec3 camera{0};
    float reach = 0; // of occluders
    std::vector<glm::vec3> points, normals;
    std::vector<double> truth;
};

NearField nearField(float enlargement) {
    const Geometry body = flatten(loadScene("builtin:blob?detail=0.05"), 0);
    const float size = 0.5f * glm::length(body.bounds.size());
    std::vector<glm::vec3> corners;
    for (const std::uint32_t index : body.indices)
        corners.push_back(body.positions[index] - body.bounds.centre());
    const float low = -0.5f * body.bounds.size().y, wide = enlargement * size / std::sqrt(2.0f);
    const glm::vec3 a(-wide, low, -wide), b(wide, low, -wide), c(wide, low, wide), d(-wide, low, wide);
    for (const glm::vec3& corner : {a, c, b, a, d, c}) corners.push_back(corner);
    NearField field;
    field.scene = sceneOf(corners);
    field.reach = 0.5f * size;
    const glm::vec3 middle(-glm::vec3(field.scene.origin));
    field.camera = middle + size * glm::vec3(0.7f, 0.5f, 1.0f);

    const Geometry geometry = flatten(field.scene, 0);
    const Bvh bvh = buildBvh(geometry, {});
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    const auto unit = [&] {
        return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    };
    while (field.points.size() < 400) {
        const glm::vec3 direction = glm::normalize(middle + 0.5f * size * unit() - field.camera);
        const auto hit = closestHit(bvh, {field.camera, direction});
        if (!hit || hit->t > 3 * size) continue;
        glm::vec3 p[3];
        for (size_t k = 0; k < 3; ++k) p[k] = geometry.positions[geometry.indices[3 * hit->triangle + k]];
        glm::vec3 n = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
        if (glm::dot(n, direction) > 0) n = -n;
        const glm::vec3 point = field.camera + hit->t * direction;
        int open = 0;
        for (int i = 0; i < 400; ++i)
            open +=
                !anyHit(bvh, {point + 1e-4f * size * n, glm::normalize(n + 0.999f * unit()), 0, field.reach});
        field.points.push_back(point);
        field.normals.push_back(n);
        field.truth.push_back(open / 400.0);
    }
    return field;
}

// Root mean square error of the visibility within reach, over 96 frames of a ray a point.
double nearFieldError(const NearField& field, const Graph& graph) {
    RaySource::rays = raysAround(static_cast<int>(field.points.size()), 1, 1);
    Renderer renderer(graph, registry(), field.scene, context().capabilities(), smallFrame());
    lookFrom(renderer, field.camera);
    std::mt19937 random(9);
    std::normal_distribution<float> normal;
    const auto unit = [&] {
        return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    };
    std::vector<double> open(field.points.size()), weight(field.points.size());
    for (int frame = 0; frame < 96; ++frame) {
        for (size_t i = 0; i < field.points.size(); ++i)
            RaySource::rays[i] = rayRecord(field.points[i], field.normals[i] + 0.999f * unit(), 0,
                                           field.reach, field.normals[i]);
        renderer.frame();
        const auto hits = as<shared::HitRecord>(renderer.readBytes({"query", "hits"}));
        for (size_t i = 0; i < hits.size(); ++i) {
            weight[i] += double{hits[i].weight};
            open[i] += std::isinf(hits[i].t) ? double{hits[i].weight} : 0;
        }
    }
    double sum = 0;
    for (size_t i = 0; i < open.size(); ++i) {
        const double error = open[i] / std::max(weight[i], 1e-9) - field.truth[i];
        sum += error * error / static_cast<double>(open.size());
    }
    return std::sqrt(sum);
}

TEST_F(OccupancyCascade, KeepsNearDetailInASceneSixteenTimesLarger) {
    const std::string single =
        R"("bom": {"type": "OccupancyMap", "properties": {"resolution": 64, "method": "exact"}},
        "map": {"type": "Roma"})";
    const std::string edges = R"(["bom.occupancy", "map.occupancy"], ["bom.grid", "map.grid"], )";
    const std::string snap = R"("snap": true)";
    const NearField small = nearField(1), large = nearField(16);
    const double alone = nearFieldError(small, tracingGraph(single, edges, snap));
    const double one = nearFieldError(large, tracingGraph(single, edges, snap));
    const double nested = nearFieldError(large, cascadeGraph(R"("resolution": 64, "levels": 4)", snap));
    fmt::print("one map: {:.3f} alone, {:.3f} in the large scene; four nested: {:.3f}\n", alone, one, nested);
    EXPECT_LT(nested, 0.7 * one);
    EXPECT_LT(nested, 1.5 * alone);
}

} // namespace
} // namespace kestrel::test
