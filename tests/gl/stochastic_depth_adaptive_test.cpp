// The map of two resolutions between those that it is made of, on built-in scenes.
#include "shipped_fixture.h"
#include <bit>

namespace kestrel::test {
namespace {

const PortRef adaptiveResult{"second_ao_pass", "result"}, adaptiveChosen{"adaptive_sd_map", "chosen"},
    adaptiveCells{"first_ao_pass", "sd_cells"};

struct AdaptiveMap : ShippedTest {
    static Renderer svao(const std::string& scene, std::vector<std::string> settings,
                         const std::vector<PortRef>& outputs) {
        settings.insert(settings.begin(), {"first_ao_pass.exponent=4", "first_ao_pass.cutoff=1",
                                           "first_ao_pass.guard=64", "depth_map.guard=16"});
        Graph graph = shippedGraph("svao", settings);
        graph.outputs.clear();
        for (const PortRef& port : outputs) graph.outputs.push_back({port, {}});
        RenderOptions options;
        options.size = {128, 72, 1};
        options.checkFinite = true;
        return {graph, shipped(), loadScene(scene), context().capabilities(), options};
    }
    static Image result(const std::string& scene, const std::vector<std::string>& settings) {
        Renderer made = svao(scene, settings, {adaptiveResult});
        made.frame();
        return made.read(adaptiveResult);
    }
    static std::vector<std::string> adaptive(std::vector<std::string> more) {
        more.emplace_back("second_ao_pass.layers=adaptive_sd_map.layers");
        return more;
    }
};

const char* const adaptiveScenes[] = {"builtin:tower?detail=0.2", "builtin:grove?detail=0.05"};

TEST_F(AdaptiveMap, IsTheCoarseMapWhereNothingAsks) {
    for (const char* scene : adaptiveScenes)
        for (const char* slots : {"sd_map.layers_per_texel=1", "sd_map.layers_per_texel=8"})
            EXPECT_EQ(result(scene, adaptive({slots, "adaptive_sd_map.edges=false"})), result(scene, {slots}))
                << scene << " " << slots;
}

// Without intervals, since a cell has that of its texel: that of all its samples.
TEST_F(AdaptiveMap, IsTheFullMapWhereEverythingAsks) {
    for (const char* scene : adaptiveScenes)
        for (const char* slots : {"sd_map.layers_per_texel=2", "sd_map.layers_per_texel=8"})
            for (const int divisor : {4, 8}) {
                const std::string coarse = fmt::format("first_ao_pass.divisor={}", divisor),
                                  fine = fmt::format("first_ao_pass.divisor={}", divisor / 4);
                const Image full =
                    result(scene, {slots, fine, "sd_map.interval=false", "sd_map.jitter=false"});
                for (const char* asks : {"adaptive_sd_map.edge=0", "adaptive_sd_map.density=1"})
                    EXPECT_EQ(result(scene, adaptive({slots, coarse, asks, "sd_map.interval=false",
                                                      "adaptive_sd_map.interval=false"})),
                              full)
                        << scene << " " << slots << " " << coarse << " " << asks;
            }
}

TEST_F(AdaptiveMap, EdgesAndDensityChooseMoreAndMoreOfWhatIsAsked) {
    const auto chosen = [](const std::string& setting, std::vector<std::uint32_t>& cells) {
        Renderer made =
            svao(adaptiveScenes[0], adaptive({setting}), {adaptiveResult, adaptiveChosen, adaptiveCells});
        made.frame();
        cells = as<std::uint32_t>(made.readBytes(adaptiveCells));
        return as<std::uint32_t>(made.readBytes(adaptiveChosen));
    };
    for (const std::vector<const char*>& settings :
         {std::vector<const char*>{"adaptive_sd_map.edges=false", "adaptive_sd_map.edge=0.5",
                                   "adaptive_sd_map.edge=0.05", "adaptive_sd_map.edge=0"},
          {"adaptive_sd_map.density=17", "adaptive_sd_map.density=8", "adaptive_sd_map.density=2",
           "adaptive_sd_map.density=1"}}) {
        std::vector<std::uint32_t> before, cells;
        size_t last = 0;
        for (const char* setting : settings) {
            const auto now = chosen(setting, cells);
            size_t count = 0;
            for (size_t i = 0; i < now.size(); ++i) {
                ASSERT_TRUE(now[i] == 0 || now[i] == cells[i]) << setting;
                ASSERT_TRUE(before.empty() || before[i] == 0 || now[i] == before[i]) << setting;
                count += now[i] != 0 ? 1 : 0;
            }
            EXPECT_TRUE(before.empty() || count > last) << setting << " " << count;
            last = count;
            before = now;
        }
        EXPECT_EQ(before, cells); // everything
    }
}

TEST_F(AdaptiveMap, WantsADivisorThatCellsDivide) {
    try {
        svao(adaptiveScenes[0], adaptive({"first_ao_pass.divisor=2"}), {adaptiveResult});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("has a divisor of 2, which is no multiple of 4"),
                  std::string::npos)
            << error.what();
    }
}

} // namespace
} // namespace kestrel::test
