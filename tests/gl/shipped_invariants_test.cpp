// What must not change an image: sharing memory, running again. Leaving out: shipped_leaving_out_test.cpp.
#include "shipped_fixture.h"
#include <bit>

namespace kestrel::test {
namespace {

// Scenes of every kind of light, material and motion, small.
const char* const scenes[] = {
    "builtin:blob?detail=0.02",  "builtin:hall?detail=0.05",    "builtin:cornell",
    "builtin:grove?detail=0.01", "builtin:skinned?detail=0.05", "builtin:pool?detail=0.05",
    "builtin:morph?detail=0.05", "builtin:tower?detail=0.02"};

// A shipped graph on one of the scenes, in rotation over the graphs: each graph and each scene occurs.
struct Case {
    std::string graph;
    std::vector<std::string> settings;
    size_t scene = 0;
    [[nodiscard]] std::string name() const {
        return graph +
               (settings.empty() ? "" : "_" + settings.front().substr(settings.front().find('=') + 1));
    }
};

std::vector<Case> allCases() {
    std::vector<Case> cases;
    for (const std::string& name : shippedGraphNames()) {
        cases.push_back({name, {}, cases.size()});
        for (const char* pass : {"ao", "shadow", "glossy", "indirect"})
            if (name == "ray_ao" || name == "soft_shadow" || name == "glossy" || name == "indirect")
                if (const Graph graph = shippedGraph(name); graph.find(pass) != nullptr)
                    cases.push_back({name, {std::string(pass) + ".tracer=bvh.tracer"}, cases.size()});
        // So small a picture has no samples that are far on screen.
        for (const char* edge :
             {"second_ao_pass.layers=raster_sd_map.layers", "second_ao_pass.layers=adaptive_sd_map.layers",
              "second_ao_pass.layers=second_depth.layers", "blur.signal=ray_svao.result"})
            if (name == "svao") cases.push_back({name, {edge, "first_ao_pass.cutoff=1"}, cases.size()});
    }
    return cases;
}

Graph cheap(const Case& test) { return lightened(shippedGraph(test.graph, test.settings)); }

// Every output after three frames: pictures, and buffers as numbers of 32 bits.
std::map<std::string, Image> outputsOf(Renderer& made) {
    std::map<std::string, Image> images;
    for (int i = 0; i < 3; ++i) made.frame();
    for (const GraphOutput& output : made.graph().outputs) {
        Image& image = images[output.port.text()];
        if (made.desc(output.port).kind == ResourceKind::Texture2D) {
            image = made.read(output.port);
            continue;
        }
        for (const std::uint32_t word : as<std::uint32_t>(made.readBytes(output.port)))
            image.values.push_back(std::bit_cast<float>(word));
        image.width = static_cast<int>(image.values.size());
        image.height = image.channels = 1;
    }
    return images;
}

struct Invariants : ShippedTest {
    static std::map<std::string, Image> outputs(const Case& test, const char* scene, RenderOptions options) {
        Renderer made = renderer(cheap(test), loadScene(scene), std::move(options), {48, 27, 1});
        return outputsOf(made);
    }
};

struct EveryGraph : Invariants, testing::WithParamInterface<Case> {
    void SetUp() override {
        Invariants::SetUp();
        for (const GraphPass& pass : cheap(GetParam()).passes)
            if (shipped().find(pass.type) == nullptr) GTEST_SKIP() << "this build has no " << pass.type;
    }
    static const char* scene() { return scenes[GetParam().scene % std::size(scenes)]; }
    // Numbers that are the same in both, infinities of rays that meet nothing among them, do not differ.
    static Difference apart(const Image& a, const Image& b) {
        Image finiteA = a, finiteB = b;
        for (size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i)
            if (std::bit_cast<std::uint32_t>(a.values[i]) == std::bit_cast<std::uint32_t>(b.values[i]))
                finiteA.values[i] = finiteB.values[i] = 0;
        return difference(finiteA, finiteB);
    }
};

TEST_P(EveryGraph, SharingMemoryAndRunningAgainChangeNoBit) {
    RenderOptions unshared;
    unshared.shareMemory = false;
    Renderer made = renderer(cheap(GetParam()), loadScene(scene()), {}, {48, 27, 1});
    const auto first = outputsOf(made);
    const auto alone = outputs(GetParam(), scene(), unshared), again = outputs(GetParam(), scene(), {});
    made.restart();
    const auto restarted = outputsOf(made);
    made.rewind();
    const auto rewound = outputsOf(made);
    ASSERT_FALSE(first.empty());
    for (const auto& [port, image] : first) {
        EXPECT_EQ(apart(image, alone.at(port)).largest, 0) << port << " with memory of its own";
        EXPECT_EQ(apart(image, again.at(port)).largest, 0) << port << " run again";
        EXPECT_EQ(apart(image, restarted.at(port)).largest, 0) << port << " started again";
        EXPECT_EQ(apart(image, rewound.at(port)).largest, 0) << port << " rewound";
    }
}

INSTANTIATE_TEST_SUITE_P(Graphs, EveryGraph, testing::ValuesIn(allCases()), [](const auto& of) {
    std::string name = of.param.name();
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
});

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

TEST_F(Invariants, AnotherSeedChangesTheNoise) {
    RenderOptions other;
    other.seed = 7;
    const Case test{"ray_ao", {}, 0};
    const auto first = outputs(test, scenes[0], {}), second = outputs(test, scenes[0], other);
    EXPECT_GT(difference(first.at("mean.result"), second.at("mean.result")).rms, 0.01);
}

TEST_F(Invariants, AStaticSceneBuildsItsMapAndItsHierarchyOnce) {
    RenderOptions timing;
    timing.timing = true;
    Renderer made = renderer(shippedGraph("ray_query"), loadScene(scenes[0]), timing);
    // Steps of each type in one frame.
    const auto builds = [&made] {
        std::map<std::string, int> steps{{"Bvh", 0}, {"OccupancyMap", 0}};
        for (const StepSample& sample : made.frame().samples)
            if (const auto found = steps.find(sample.type); found != steps.end()) ++found->second;
        return steps;
    };
    const auto first = builds();
    for (const auto& [type, steps] : first) EXPECT_GT(steps, 0) << type;
    for (int i = 0; i < 3; ++i)
        for (const auto& [type, steps] : builds()) EXPECT_EQ(steps, 0) << type << " in frame " << i + 1;
    made.rewind();
    for (const auto& [type, steps] : builds()) EXPECT_EQ(steps, 0) << type << " rewound";
    made.restart();
    EXPECT_EQ(builds(), first);
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
    EXPECT_EQ(made.last().values.at("bvh").at("refits since building"), 3);
}

// A hierarchy that is fitted to what moves answers as one that is built anew for each frame.
TEST_F(Invariants, AFittedHierarchyShowsTheSamePicture) {
    const auto picture = [](const std::string& layout) {
        Renderer made = renderer(shippedGraph("ray_ao", {"ao.tracer=bvh.tracer", "bvh.layout=" + layout}),
                                 loadScene("builtin:morph?detail=0.2"), {});
        for (int i = 0; i < 6; ++i) made.frame();
        return made.read({"mean", "result"}).values;
    };
    EXPECT_EQ(picture("wide"), picture("binary"));
}

} // namespace
} // namespace kestrel::test
