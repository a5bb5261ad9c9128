// The fragments of an A-buffer as depth layers: the second pass of ambient occlusion takes them as it takes
// those of a stochastic depth map that misses none.
#include "shipped_fixture.h"

namespace kestrel::test {
namespace {

using ABufferLayers = ShippedTest;

Graph svaoGraph(const std::vector<std::string>& settings) {
    Graph graph = shippedGraph("svao");
    const Graph lists = shippedGraph("abuffer_ao");
    for (const char* pass : {"depth_bounds", "store", "reorder", "abuffer"}) {
        for (const GraphPass& each : lists.passes)
            if (each.name == pass) graph.passes.push_back(each);
        for (const GraphEdge& edge : lists.edges)
            if (edge.to.pass == pass) graph.edges.push_back(edge);
    }
    for (const char* setting :
         {"depth_bounds.cube=false", "depth_map.guard=0", "first_ao_pass.guard=0", "first_ao_pass.divisor=1",
          "first_ao_pass.exponent=4", "first_ao_pass.cutoff=1", "second_ao_pass.layers=abuffer.layers"})
        applySetting(graph, shipped(), setting);
    for (const std::string& setting : settings) applySetting(graph, shipped(), setting);
    graph.outputs.clear();
    for (const PortRef& port : {PortRef{"first_ao_pass", "visibility"},
                                {"first_ao_pass", "mask"},
                                {"second_ao_pass", "result"},
                                {"ray_svao", "result"}})
        graph.outputs.push_back({port, {}});
    return graph;
}

TEST_F(ABufferLayers, RefineAmbientOcclusionAsAllHitsAlongRaysDo) {
    const Scene scene = loadScene("builtin:tower?detail=0.2");
    RenderOptions options;
    options.camera = "outside";
    options.checkFinite = options.countIterations = true;
    Image before;
    for (const char* structure : {"sb", "dllb"}) {
        Renderer made =
            renderer(svaoGraph({std::string("store.structure=") + structure}), scene, options, {96, 54, 1});
        made.frame();
        const Image first = made.read({"first_ao_pass", "visibility"}),
                    mask = made.read({"first_ao_pass", "mask"}),
                    layers = made.read({"second_ao_pass", "result"}),
                    hits = made.read({"ray_svao", "result"});
        double far = 0, near = 0, count = 0;
        for (size_t i = 0; i < mask.values.size(); ++i) {
            if (mask.values[i] == 0) continue;
            far += std::pow(double{first.values[i]} - double{hits.values[i]}, 2);
            near += std::pow(double{layers.values[i]} - double{hits.values[i]}, 2);
            ++count;
        }
        ASSERT_GT(count, 200);
        EXPECT_LE(near / count, 2e-3) << structure;
        EXPECT_LE(near, 0.05 * far) << structure;
        if (before.values.empty()) before = layers;
        EXPECT_EQ(layers.values, before.values) << structure;
    }
}

TEST_F(ABufferLayers, ASceneWithoutTrianglesHasNone) {
    Renderer made = renderer(svaoGraph({}), trianglesScene({}));
    made.frame();
    for (const float value : made.read({"second_ao_pass", "result"}).values) ASSERT_EQ(value, 1);
}

} // namespace
} // namespace kestrel::test
