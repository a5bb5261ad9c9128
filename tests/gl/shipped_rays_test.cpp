// Tracing itself: the GLSL traversal against the CPU's, ray by ray, and every hit against Embree.
#include "reference/primary_hits.h"
#include "reference/tracer.h"
#include "scene/bvh_trace.h"
#include "shared/ray.h"
#include "shipped_fixture.h"
#include <algorithm>
#include <cstring>

namespace kestrel::test {
namespace {

struct Rays : ShippedTest {};

TEST_F(Rays, TheBvhInGlslFindsWhatTheCpuFinds) {
    const Scene scene = loadScene("builtin:tower?detail=0.05");
    Graph graph = shippedGraph("ray_query", {"by_bvh.query=closest"});
    graph.outputs = {{{"rays", "rays"}, {}}, {{"by_bvh", "hits"}, {}}};
    Renderer made = renderer(graph, scene);
    made.frame();
    const auto rays = as<shared::RayRecord>(made.readBytes({"rays", "rays"}));
    const auto hits = as<shared::HitRecord>(made.readBytes({"by_bvh", "hits"}));
    const Bvh bvh = buildBvh(flatten(scene, 0));
    ASSERT_EQ(rays.size(), hits.size());
    size_t traced = 0, different = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        if ((rays[i].flags & 1u) == 0) continue;
        const glm::vec3 o = rays[i].origin;
        const float start = shared::rayStart(0, std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}), 0);
        const auto expected =
            closestHit(bvh, {o + start * rays[i].normal, rays[i].direction, rays[i].tMin, rays[i].tMax});
        ++traced;
        const bool hit = std::isfinite(hits[i].t);
        if (hit != expected.has_value() ||
            (hit && std::abs(hits[i].t - expected->t) > 1e-4f * (1 + expected->t)))
            ++different;
    }
    ASSERT_GT(traced, 1000u);
    // GLSL compilers may contract multiply and add, so a ray that grazes an edge may fall to the other side.
    EXPECT_LE(different, traced / 1000);
}

// The layouts differ in boxes and order, never in what is met: hits of any, closest and all queries are the
// same to the bit, where triangles are opaque, masked or blended.
TEST_F(Rays, BothLayoutsOfTheHierarchyAnswerAlike) {
    for (const char* source : {"builtin:tower?detail=0.05", "builtin:grove?detail=0.02",
                               "builtin:lattice?detail=0.2&blended=0.5"}) {
        const Scene scene = loadScene(source);
        const auto answers = [&](const std::string& graph, const std::string& query,
                                 const std::string& layout, const PortRef& port) {
            std::vector<std::string> settings = {"bvh.layout=" + layout};
            if (!query.empty()) settings.push_back(query);
            Graph made = shippedGraph(graph, settings);
            made.outputs = {{port, {}}};
            Renderer drawn = renderer(made, scene);
            drawn.frame();
            return port.port == "count" ? drawn.read(port).values : as<float>(drawn.readBytes(port));
        };
        for (const char* query : {"by_bvh.query=any", "by_bvh.query=closest", ""}) {
            SCOPED_TRACE(std::string(source) + " " + query);
            const bool all = query[0] == 0;
            const PortRef port = all ? PortRef{"count", "count"} : PortRef{"by_bvh", "hits"};
            const auto wide = answers(all ? "hit_count" : "ray_query", query, "wide", port);
            const auto binary = answers(all ? "hit_count" : "ray_query", query, "binary", port);
            ASSERT_EQ(wide.size(), binary.size());
            // Bits: ids of triangles are no floats.
            EXPECT_EQ(std::memcmp(wide.data(), binary.data(), wide.size() * sizeof(float)), 0);
            EXPECT_TRUE(std::ranges::any_of(wide, [](float t) { return t > 0; }));
        }
    }
}

// The same rays through the BVH and through Embree; and the short answer is that of the long one.
TEST_F(Rays, QueriesAgreeWithEmbree) {
    if (shipped().find("ReferenceRayQuery") == nullptr) GTEST_SKIP() << "Embree is not built in";
    std::string text(readText(shareFolder() / "graphs/ray_query.json"));
    const auto insert = [&](const std::string& before, const std::string& what) {
        text.insert(text.find(before), what);
    };
    insert("\"by_bvh\": {", "\"by_embree\": { \"type\": \"ReferenceRayQuery\" }, ");
    insert("[\"rays.rays\", \"by_bvh.rays\"]", "[\"rays.rays\", \"by_embree.rays\"], ");
    insert("\"by_bvh.hits\"]", "\"by_bvh.distance\", \"by_embree.hits\", ");
    for (const std::string query : {"any", "closest"}) {
        SCOPED_TRACE(query);
        Graph graph = parseGraph(text, "ray_query.json");
        for (const char* pass : {"by_bvh", "by_embree"})
            applySetting(graph, shipped(), std::string(pass) + ".query=" + query);
        Renderer made = renderer(graph, loadScene("builtin:grove?detail=0.02"));
        made.frame();
        const auto embree = as<shared::HitRecord>(made.readBytes({"by_embree", "hits"}));
        const auto bvh = as<shared::HitRecord>(made.readBytes({"by_bvh", "hits"}));
        const auto distances = as<float>(made.readBytes({"by_bvh", "distance"}));
        ASSERT_EQ(embree.size(), bvh.size());
        ASSERT_EQ(embree.size(), distances.size());
        size_t different = 0, met = 0;
        for (size_t i = 0; i < bvh.size(); ++i) {
            EXPECT_EQ(bvh[i].t, distances[i]);
            met += std::isfinite(embree[i].t) ? 1 : 0;
            const bool same = std::isfinite(bvh[i].t) == std::isfinite(embree[i].t);
            const bool near = !std::isfinite(bvh[i].t) ||
                              std::abs(bvh[i].t - embree[i].t) <= 1e-4f * (1 + std::abs(embree[i].t));
            different += same && near ? 0 : 1;
        }
        EXPECT_GT(met, bvh.size() / 20);
        // Rays that graze an edge, or the rim of a masked leaf, may fall to either side.
        EXPECT_LE(different, bvh.size() / 200);
    }
}

// Where nothing is and the far plane infinite, a ray of no pixel is still a ray: one from nowhere would be
// walked through everything.
TEST_F(Rays, StartSomewhereAlsoWhereNothingIs) {
    Graph graph = shippedGraph("ray_query");
    graph.outputs = {{{"rays", "rays"}, {}}};
    Scene scene = trianglesScene(square());
    Renderer made = renderer(graph, scene);
    CameraState camera;
    camera.view = glm::lookAt(glm::vec3(3, 2, 4), glm::vec3(0), glm::vec3(0, 1, 0));
    camera.position = {3, 2, 4};
    camera.nearPlane = 0.05f;
    camera.farPlane = 0;
    made.setFreeCamera(camera);
    made.frame();
    size_t missing = 0;
    for (const shared::RayRecord& ray : as<shared::RayRecord>(made.readBytes({"rays", "rays"}))) {
        missing += (ray.flags & 1u) == 0;
        for (int k = 0; k < 3; ++k)
            ASSERT_TRUE(std::isfinite(ray.origin[k]) && std::isfinite(ray.direction[k]));
    }
    EXPECT_GT(missing, 1000u);
}

// The tracer that looks at nothing answers every ray alike, in the scene's measure.
TEST_F(Rays, TheConstantTracerAnswersAlike) {
    std::string text(readText(shareFolder() / "graphs/ray_query.json"));
    text.insert(text.find("\"by_bvh\": {"), "\"constant\": { \"type\": \"ConstantTracer\" }, ");
    for (const float scale : {1e-4f, 1.0f, 1e4f}) {
        for (const float distance : {0.0f, 0.5f}) {
            Graph graph = parseGraph(text, "ray_query.json");
            applySetting(graph, shipped(), "by_bvh.tracer=constant.tracer");
            applySetting(graph, shipped(), "by_bvh.query=closest");
            applySetting(graph, shipped(), fmt::format("constant.distance={}", distance));
            graph.outputs = {{{"rays", "rays"}, {}}, {{"by_bvh", "distance"}, {}}};
            const Scene scene = transformed("builtin:cornell", glm::scale(glm::dmat4(1), glm::dvec3(scale)));
            Renderer made = renderer(graph, scene);
            made.frame();
            const auto rays = as<shared::RayRecord>(made.readBytes({"rays", "rays"}));
            const auto found = as<float>(made.readBytes({"by_bvh", "distance"}));
            const float expected = distance * gatherFacts(scene).sphere.radius;
            size_t traced = 0;
            for (size_t i = 0; i < found.size(); ++i) {
                const bool met = (rays[i].flags & 1u) != 0 && distance > 0;
                traced += met ? 1 : 0;
                if (met)
                    ASSERT_NEAR(found[i], expected, 1e-6f * expected);
                else
                    ASSERT_TRUE(std::isinf(found[i]));
            }
            EXPECT_EQ(traced > 0, distance > 0);
        }
    }
}

TEST_F(Rays, EveryHitIsCountedAsByEmbree) {
    if (shipped().find("ReferenceAmbientOcclusion") == nullptr) GTEST_SKIP() << "Embree is not built in";
    const Scene scene = loadScene("builtin:lattice?detail=0.1");
    const Extent size{64, 36, 1};
    const Image count = render(shippedGraph("hit_count"), scene, {"count", "count"}, 1, {}, size);
    const Geometry geometry = flatten(scene, 0);
    const ReferenceTracer tracer(geometry, scene);
    size_t different = 0;
    double sum = 0;
    for (int y = 0; y < 36; ++y) {
        const std::vector<TraceRay> rays = cameraRays(cameraAt(scene, 0, 0), 64, 36, y);
        for (int x = 0; x < 64; ++x) {
            int expected = 0;
            tracer.allHits(rays[static_cast<size_t>(x)], [&](const TraceHit&) { return ++expected, false; });
            sum += expected;
            if (std::abs(count.at(x, y) - static_cast<float>(expected)) > 0.5f) ++different;
        }
    }
    EXPECT_GT(sum / (64 * 36), 5); // the lattice is deep
    // One rule on both sides; their rays are the same but for rounding, which shows at silhouettes.
    EXPECT_LE(different, 64u * 36u / 200u);
}

// A sheet whose vertices, and then whose edges, stand at the middles of pixels.
TEST_F(Rays, ASurfaceIsCountedOnceAtEveryVertexAndEdge) {
    for (const int cells : {1, 8, 16}) {
        std::vector<glm::vec3> corners;
        const auto at = [&](int x, int y) {
            return glm::vec3(x, y, 0) * (2.0f / static_cast<float>(cells)) - glm::vec3(1, 1, 0);
        };
        for (int y = 0; y < cells; ++y)
            for (int x = 0; x < cells; ++x)
                corners.insert(corners.end(), {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y),
                                               at(x + 1, y + 1), at(x, y + 1)});
        for (const bool orthographic : {true, false}) {
            CameraState camera;
            camera.view = glm::lookAt(glm::vec3(0, 0, 2), glm::vec3(0), glm::vec3(0, 1, 0));
            camera.position = {0, 0, 2};
            camera.orthographic = orthographic;
            // Eight pixels across the sheet's middle half: a pixel's middle every eighth from a sixteenth on.
            camera.halfHeight = 0.5f;
            camera.verticalFov = 2 * std::atan(0.25f);
            camera.farPlane = 0;
            for (const std::uint32_t size : {8u, 64u}) {
                RenderOptions options;
                Renderer made =
                    renderer(shippedGraph("hit_count"), trianglesScene(corners), options, {size, size, 1});
                made.setFreeCamera(camera);
                made.frame();
                for (const float count : made.read({"count", "count"}).values)
                    ASSERT_EQ(count, 1.0f) << cells;
            }
        }
    }
}

} // namespace
} // namespace kestrel::test
