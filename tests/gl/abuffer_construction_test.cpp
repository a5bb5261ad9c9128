// The stages of the A-buffer by other means: bounds of boxes, all views in one draw, shifted buckets. None
// changes a list or a hit.
#include "abuffer_fixture.h"
#include "shared/ray.h"
#include "support/message.h"
#include <gmock/gmock.h>
#include <set>

namespace kestrel::test {
namespace {

struct ABufferConstruction : ABufferLists {
    struct Bounds {
        Image frame;
        std::vector<Image> faces;
    };
    static Bounds bounds(const Scene& scene, std::vector<std::string> settings, Extent frame = size) {
        settings.insert(settings.begin(), fmt::format("depth_bounds.side={}", side));
        Graph graph = shippedGraph("abuffer_ao", settings);
        graph.outputs = {{{"depth_bounds", "bounds"}, {}}, {{"depth_bounds", "cube_bounds"}, {}}};
        Renderer made = renderer(graph, scene, {}, frame);
        made.frame();
        Bounds result{made.read({"depth_bounds", "bounds"}), {}};
        for (int face = 0; face < 6; ++face)
            result.faces.push_back(made.read({"depth_bounds", "cube_bounds"}, face));
        return result;
    }
    // Pixels with fragments whose depths do not all lie within `wide`; and all pixels with fragments.
    static std::pair<size_t, size_t> outside(const Image& exact, const Image& wide) {
        std::pair<size_t, size_t> result;
        for (size_t i = 0; i < exact.pixelCount(); ++i) {
            if (exact.values[4 * i + 3] == 0) continue;
            ++result.second;
            if (wide.values[4 * i] < exact.values[4 * i] || wide.values[4 * i + 1] < exact.values[4 * i + 1])
                ++result.first;
        }
        return result;
    }
    // Of a ray from each pixel's surface: time and place of the hit.
    static std::vector<shared::HitRecord> hits(const Scene& scene, const std::vector<std::string>& settings) {
        Graph graph = shippedGraph("abuffer_ao", settings);
        const Graph query = parseGraph(R"({"kestrel": 1, "passes": {"hemisphere": {"type": "HemisphereRays"},
            "query": {"type": "RayQuery", "properties": {"query": "closest"}}}, "edges": [], "outputs": []})",
                                       "query.json");
        graph.passes.insert(graph.passes.end(), query.passes.begin(), query.passes.end());
        for (const auto& [from, to] : {std::pair{"gbuffer.depth", "hemisphere.depth"},
                                       {"gbuffer.normal", "hemisphere.normal"},
                                       {"hemisphere.rays", "query.rays"},
                                       {"abuffer.tracer", "query.tracer"}})
            applySetting(graph, shipped(), fmt::format("{}={}", to, from));
        graph.outputs = {{{"query", "hits"}, {}}};
        Renderer made = renderer(graph, scene, {}, {64, 36, 1});
        made.frame();
        return as<shared::HitRecord>(made.readBytes({"query", "hits"}));
    }
    static size_t differences(const std::vector<shared::HitRecord>& a,
                              const std::vector<shared::HitRecord>& b) {
        EXPECT_EQ(a.size(), b.size());
        size_t count = 0;
        for (size_t i = 0; i < a.size(); ++i) count += a[i].t == b[i].t && a[i].source == b[i].source ? 0 : 1;
        return count;
    }
};

TEST_F(ABufferConstruction, BoundsOfBoxesContainThoseOfTriangles) {
    std::vector<glm::vec3> floor; // whose box has no height
    for (const glm::vec3& p : square()) floor.push_back(3.0f * glm::vec3(p.x, 0, -p.y));
    std::vector<std::pair<std::string, Scene>> scenes = {{"a floor", trianglesScene(floor)}};
    for (const char* source : {"lattice?detail=0.3", "hall?detail=0.3", "grove?detail=0.05", "morph"})
        scenes.emplace_back(source, loadScene(std::string("builtin:") + source));
    scenes.emplace_back("lattice, parallel", loadScene("builtin:lattice?detail=0.3"));
    for (Camera& camera : scenes.back().second.cameras) camera.orthographic = true;
    for (const auto& [name, scene] : scenes) {
        const Bounds exact = bounds(scene, {}), wide = bounds(scene, {"depth_bounds.source=proxy"});
        const auto [lost, all] = outside(exact.frame, wide.frame);
        EXPECT_GT(all, 0u) << name;
        EXPECT_EQ(lost, 0u) << name;
        for (size_t face = 0; face < 6; ++face)
            EXPECT_EQ(outside(exact.faces[face], wide.faces[face]).first, 0u) << name << " " << face;
    }
}

TEST_F(ABufferConstruction, WithinABoxTheLeastDepthIsTheNearPlane) {
    // Two triangles far apart are one instance, in whose box the camera stands.
    Scene scene = trianglesScene({{-9, -9, -9}, {-8, -9, -9}, {-9, -8, -9}, {9, 9, 9}, {8, 9, 9}, {9, 8, 9}});
    Camera camera;
    camera.node = static_cast<int>(scene.nodes.size());
    Node node;
    node.camera = 0;
    scene.cameras = {camera};
    scene.nodes.push_back(node);
    scene.roots.push_back(camera.node);
    finishScene(scene);
    const Bounds wide = bounds(scene, {"depth_bounds.source=proxy", "depth_bounds.near=0.125"});
    for (size_t face = 0; face < 6; ++face)
        for (size_t i = 0; i < wide.faces[face].pixelCount(); ++i) {
            EXPECT_NEAR(-wide.faces[face].values[4 * i], 0.125f, 0.001f);
            EXPECT_GT(wide.faces[face].values[4 * i + 1], 8.0f);
        }
}

TEST_F(ABufferConstruction, BoxesChangeNeitherListsNorHits) {
    const Scene scene = loadScene("builtin:lattice?detail=0.3");
    const Lists expected = made(scene, {});
    const auto expectedHits = hits(scene, {});
    for (const char* structure : {"sb", "ll", "llb", "dllb"})
        for (const char* allocation : {"counter", "counted"}) {
            const bool counter = std::string(allocation) == "counter";
            if (counter != (std::string(structure) == "ll" || std::string(structure) == "dllb")) continue;
            const std::vector<std::string> settings = {"depth_bounds.source=proxy",
                                                       fmt::format("store.structure={}", structure),
                                                       fmt::format("store.allocation={}", allocation)};
            EXPECT_EQ(made(scene, settings), expected) << structure << " " << allocation;
            EXPECT_EQ(differences(hits(scene, settings), expectedHits), 0u) << structure << " " << allocation;
        }
}

TEST_F(ABufferConstruction, OneDrawIntoAllViewsGivesTheSameLists) {
    const bool layers = context().capabilities().has("GL_ARB_shader_viewport_layer_array");
    for (const char* source : {"builtin:lattice?detail=0.3", "builtin:grove?detail=0.05"}) {
        const Scene scene = loadScene(source);
        const Lists expected = made(scene, {});
        const Bounds expectedBounds = bounds(scene, {});
        for (const std::string drawing : {"geometry_shader", "vertex_layer"}) {
            if (drawing == "vertex_layer" && !layers) continue;
            for (const char* allocation : {"counted", "counter"}) {
                if (std::string(source) == "builtin:lattice?detail=0.3" && drawing == "vertex_layer")
                    continue;
                const std::vector<std::string> settings = {"depth_bounds.drawing=" + drawing,
                                                           "store.drawing=" + drawing,
                                                           fmt::format("store.allocation={}", allocation)};
                const Lists lists = made(scene, settings);
                size_t fragments = 0, different = 0;
                for (size_t i = 0; i < pixels; ++i) {
                    fragments += expected[i].size();
                    different += unmatched(lists[i], expected[i], 1e-5f);
                }
                // A geometry shader's vertices are rounded otherwise on their way to the rasterizer's grid (8
                // of 76,800 pixels on llvmpipe); instances are the same vertices.
                EXPECT_LE(different, drawing == "vertex_layer" ? 0 : fragments / 1000)
                    << source << " " << drawing << " " << allocation << " of " << fragments;
            }
            // A face beyond the last layer would land in the last one.
            const Bounds found = bounds(scene, {"depth_bounds.drawing=" + drawing});
            for (size_t face = 0; face < 6; ++face) {
                size_t different = 0;
                const Image &a = found.faces[face], &b = expectedBounds.faces[face];
                for (size_t i = 0; i < a.pixelCount(); ++i)
                    different += a.values[4 * i + 3] == b.values[4 * i + 3] ? 0 : 1;
                EXPECT_LE(different, drawing == "vertex_layer" ? 0u : 2u) << source << " " << face;
            }
        }
    }
}

TEST_F(ABufferConstruction, WhatTheDriverLacksIsNamed) {
    Capabilities without = context().capabilities();
    without.everyExtension = false;
    without.extensions.erase("GL_ARB_shader_viewport_layer_array");
    for (const char* setting : {"store.drawing=vertex_layer", "depth_bounds.drawing=vertex_layer"}) {
        RenderOptions options;
        options.size = size;
        EXPECT_THAT(messageOf<Error>([&] {
                        Renderer(shippedGraph("abuffer_ao", {setting}), shipped(),
                                 loadScene("builtin:lattice?detail=0.3"), without, options);
                    }),
                    ::testing::HasSubstr("GL_ARB_shader_viewport_layer_array"));
    }
}

TEST_F(ABufferConstruction, ShiftedBoundariesChangeNeitherListsNorHits) {
    EXPECT_EQ(shared::abufferShiftedBucket(2, 3, 4), 2u); // one each, the last empty
    EXPECT_EQ(shared::abufferShiftedBucket(9, 10, 4), 3u);
    EXPECT_EQ(shared::abufferShiftedBucket(0, 1, 16), 0u);
    const Scene scene = loadScene("builtin:lattice?detail=0.3");
    const Lists expected = made(scene, {});
    const auto expectedHits = hits(scene, {"abuffer.skipping=false", "store.structure=ll"});
    for (const char* structure : {"llb", "dllb"})
        for (const char* allocation : {"counter", "counted"})
            for (const int buckets : {1, 4, 16}) {
                // Each value meets each other one; all together would take a minute.
                if ((buckets == 16) != (std::string(structure) == "llb") ||
                    (buckets == 1 && std::string(allocation) == "counter"))
                    continue;
                const std::vector<std::string> settings = {
                    "store.boundaries=shifted", fmt::format("store.structure={}", structure),
                    fmt::format("store.allocation={}", allocation), fmt::format("store.buckets={}", buckets)};
                EXPECT_EQ(made(scene, settings), expected)
                    << structure << " " << allocation << " " << buckets;
                EXPECT_EQ(differences(hits(scene, settings), expectedHits), 0u)
                    << structure << " " << allocation << " " << buckets;
            }
}

TEST_F(ABufferConstruction, TrianglesThatNobodyReadsAreNotStored) {
    const auto stored = [](bool wanted) {
        Graph graph = shippedGraph("abuffer_ao");
        graph.outputs = {{{"reorder", "nodes"}, {}}};
        if (wanted) graph.outputs.push_back({{"reorder", "triangles"}, {}});
        Renderer made = renderer(graph, loadScene("builtin:lattice?detail=0.3"), {}, size);
        made.frame();
        const auto& values = made.last().values.at("store");
        EXPECT_EQ(values.at("bytes a pixel"), 8 + 8 * 4 + 4); // Table 2, DLLB of four buckets, and planes
        EXPECT_EQ(values.at("bytes a fragment"), 12 + 4);
        EXPECT_GT(values.at("elements of nodes"), 1000);
        return values.at("bytes of data a fragment");
    };
    EXPECT_EQ(stored(true), 4);
    EXPECT_EQ(stored(false), 0);
}

TEST_F(ABufferConstruction, AStaticSceneIsStoredOnceAndAMovingOneEachFrame) {
    for (const auto& [source, moves] :
         {std::pair{"builtin:lattice?detail=0.3", false}, {"builtin:morph", true}}) {
        RenderOptions options;
        options.timing = true;
        Renderer made = renderer(shippedGraph("abuffer_ao"), loadScene(source), options, size);
        for (int i = 0; i < 3; ++i) {
            std::set<std::string> ran;
            for (const StepSample& sample : made.frame().samples) ran.insert(sample.pass);
            for (const char* pass : {"depth_bounds", "store", "reorder"})
                EXPECT_EQ(ran.contains(pass), i == 0 || moves) << source << " " << pass << " " << i;
            EXPECT_TRUE(ran.contains("ao")) << source;
        }
    }
}

} // namespace
} // namespace kestrel::test
