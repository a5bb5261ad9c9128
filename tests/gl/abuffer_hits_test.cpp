// Every fragment or primitive along a ray, through the interface `hits`, beside the hierarchy's.
#include "shipped_fixture.h"

namespace kestrel::test {
namespace {

struct ABufferHits : ShippedTest {
    static constexpr Extent size{48, 27, 1};

    // How many hits each pixel's ray has, by `source` ("bvh.hits").
    static std::vector<float> counts(const Scene& scene, const std::string& source,
                                     const std::vector<std::string>& settings = {}) {
        Graph graph = shippedGraph("abuffer_ao", settings);
        graph.passes.push_back(
            parseGraph(
                R"({"kestrel": 1, "passes": {"count": {"type": "HitCount"}}, "edges": [], "outputs": []})",
                "test.json")
                .passes.front());
        applySetting(graph, shipped(), "count.hits=" + source);
        graph.outputs = {{{"count", "count"}, {}}};
        RenderOptions options;
        options.countIterations = true;
        Renderer made = renderer(graph, scene, options, size);
        made.frame();
        return made.read({"count", "count"}).values;
    }
};

TEST_F(ABufferHits, OfPrimitivesAreTheHierarchys) {
    for (const char* source : {"builtin:lattice?detail=0.3", "builtin:grove?detail=0.05"}) {
        const Scene scene = loadScene(source);
        const std::vector<float> expected = counts(scene, "bvh.hits");
        double sum = 0;
        for (const float count : expected) sum += count;
        EXPECT_GT(sum, static_cast<double>(expected.size())) << source;
        EXPECT_EQ(counts(scene, "abuffer.hits", {"abuffer.record=primitive"}), expected) << source;
    }
    const Scene scene = loadScene("builtin:lattice?detail=0.3");
    const std::vector<float> expected = counts(scene, "bvh.hits");
    for (const char* form : {"abuffer.skipping=false", "abuffer.march=exhaustive"})
        EXPECT_EQ(counts(scene, "abuffer.hits", {"abuffer.record=primitive", "store.buckets=16", form}),
                  expected)
            << form;
    // Of the cube's views alone, whose pixels a ray of the eye does not stay within.
    EXPECT_EQ(counts(scene, "abuffer.hits", {"abuffer.record=primitive", "depth_bounds.main_view=false"}),
              expected);
}

// The ray of a pixel meets the pixel's list: what its rasterizer gave to it, which at edges is not what the
// ray says.
TEST_F(ABufferHits, OfFragmentsAreThePixelsLists) {
    const Scene scene = loadScene("builtin:lattice?detail=0.3");
    const std::vector<float> expected = counts(scene, "bvh.hits"), first = counts(scene, "abuffer.hits");
    double sum = 0, different = 0;
    for (size_t i = 0; i < expected.size(); ++i) {
        sum += expected[i];
        different += std::abs(first[i] - expected[i]);
    }
    EXPECT_LE(different, 0.02 * sum) << different << " of " << sum;
    for (const char* form : {"store.structure=sb", "store.structure=ll", "abuffer.march=exhaustive"})
        EXPECT_EQ(counts(scene, "abuffer.hits", {form}), first) << form;
    const std::vector<float> nearest = counts(scene, "abuffer.hits", {"abuffer.layering=single"});
    for (size_t i = 0; i < nearest.size(); ++i) EXPECT_EQ(nearest[i], std::min(first[i], 1.0f)) << i;
}

} // namespace
} // namespace kestrel::test
