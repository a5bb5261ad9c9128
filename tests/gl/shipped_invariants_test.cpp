// What must not change an image: leaving out, sharing memory, running again.
#include "shipped_fixture.h"

namespace kestrel::test {
namespace {

// A graph, settings that keep it cheap, and the scenes' facts that matter to it.
struct Case {
    const char* graph;
    std::vector<std::string> settings;
};

const Case cases[] = {
    {"ray_ao", {}},    {"ray_ao", {"ao.tracer=bvh.tracer"}},      {"compare_ao", {"reference.samples=2"}},
    {"hit_count", {}}, {"reference_ao", {"reference.samples=2"}},
};

const char* const scenes[] = {"builtin:blob?detail=0.02", "builtin:grove?detail=0.01",
                              "builtin:skinned?detail=0.05"};

struct Invariants : ShippedTest {
    static bool usable(const Graph& graph) {
        for (const GraphPass& pass : graph.passes)
            if (shipped().find(pass.type) == nullptr) return false;
        return true;
    }
    // Every output after three frames.
    static std::map<std::string, Image> outputs(const Case& test, const char* scene, RenderOptions options) {
        std::map<std::string, Image> images;
        const Graph graph = shippedGraph(test.graph, test.settings);
        Renderer made = renderer(graph, loadScene(scene), std::move(options));
        for (int i = 0; i < 3; ++i) made.frame();
        for (const GraphOutput& output : graph.outputs) images[output.port.text()] = made.read(output.port);
        return images;
    }
    static void expectEqual(const Case& test, const RenderOptions& a, const RenderOptions& b, double rms,
                            double largest) {
        if (!usable(loadGraph(shareFolder() / "graphs" / (std::string(test.graph) + ".json")))) return;
        for (const char* scene : scenes) {
            const auto first = outputs(test, scene, a), second = outputs(test, scene, b);
            for (const auto& [port, image] : first) {
                const Difference d = difference(image, second.at(port));
                EXPECT_LE(d.rms, rms) << test.graph << " on " << scene << ", " << port;
                EXPECT_LE(d.largest, largest) << test.graph << " on " << scene << ", " << port;
            }
        }
    }
};

TEST_F(Invariants, LeavingOutChangesNoImage) {
    RenderOptions keepAll;
    keepAll.keepAll = true;
    // With everything kept the G-buffer's program has more outputs: the driver may order its arithmetic
    // otherwise, and a binary visibility near an edge may flip. So: equal to the bit nearly everywhere, a
    // pixel may differ by one sample.
    for (const Case& test : cases) expectEqual(test, {}, keepAll, 0.01, 1);
}

TEST_F(Invariants, SharingMemoryChangesNoBit) {
    RenderOptions unshared;
    unshared.shareMemory = false;
    for (const Case& test : cases) expectEqual(test, {}, unshared, 0, 0);
}

TEST_F(Invariants, SharingSavesThirtyPercentOfTheLargestGraph) {
    const Graph graph = shippedGraph("full");
    std::map<bool, Image> images;
    std::map<bool, MemoryReport> memory;
    for (const bool share : {true, false}) {
        RenderOptions options;
        options.shareMemory = share;
        Renderer made = renderer(graph, loadScene("builtin:hall?detail=0.1"), options);
        for (int i = 0; i < 3; ++i) made.frame();
        images[share] = made.read({"tone", "image"});
        memory[share] = made.plan().memory;
    }
    EXPECT_EQ(images[true], images[false]);
    EXPECT_EQ(memory[true].unshared, memory[false].transient);
    EXPECT_EQ(memory[false].unshared, memory[false].transient);
    EXPECT_LT(memory[true].transient, memory[true].unshared);
    // At the size that the command line takes. Frames of a test are small beside maps of fixed size.
    Renderer made = renderer(graph, loadScene("builtin:hall?detail=0.1"));
    made.setSize({640, 360, 1});
    const MemoryReport& report = made.plan().memory;
    EXPECT_LE(static_cast<double>(report.transient), 0.7 * static_cast<double>(report.unshared));
}

TEST_F(Invariants, RunningAgainChangesNoBit) {
    for (const Case& test : cases) expectEqual(test, {}, {}, 0, 0);
}

TEST_F(Invariants, AnotherSeedChangesTheNoise) {
    RenderOptions other;
    other.seed = 7;
    const auto first = outputs(cases[0], scenes[0], {}), second = outputs(cases[0], scenes[0], other);
    EXPECT_GT(difference(first.at("mean.result"), second.at("mean.result")).rms, 0.01);
}

TEST_F(Invariants, AStaticSceneBuildsItsMapAndItsHierarchyOnce) {
    RenderOptions timing;
    timing.timing = true;
    Renderer made = renderer(shippedGraph("ray_query"), loadScene(scenes[0]), timing);
    int builds = 0;
    for (int i = 0; i < 4; ++i)
        for (const StepSample& sample : made.frame().samples)
            builds += sample.type == "Bvh" || sample.type == "OccupancyMap";
    const int steps = builds;
    made.restart();
    for (const StepSample& sample : made.frame().samples)
        builds += sample.type == "Bvh" || sample.type == "OccupancyMap";
    EXPECT_EQ(builds, 2 * steps) << "the steps of the first frame alone, and again after a restart";
}

TEST_F(Invariants, AMovingSceneBuildsThemEveryFrame) {
    RenderOptions timing;
    timing.timing = true;
    Renderer made = renderer(shippedGraph("ray_ao", {"ao.tracer=bvh.tracer"}),
                             loadScene("builtin:skinned?detail=0.05"), timing);
    int builds = 0;
    for (int i = 0; i < 4; ++i)
        for (const StepSample& sample : made.frame().samples) builds += sample.type == "Bvh";
    EXPECT_EQ(builds, 4);
}

} // namespace
} // namespace kestrel::test
