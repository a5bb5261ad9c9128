// Rasterized depth maps against the second layer and against rays, on built-in scenes.
#include "shipped_fixture.h"
#include <bit>

namespace kestrel::test {
namespace {

struct RasterMap : ShippedTest {
    static constexpr Extent size{96, 54, 1};
    static Renderer svao(const std::string& scene, std::vector<std::string> settings,
                         const std::vector<PortRef>& outputs) {
        settings.insert(settings.begin(),
                        {"first_ao_pass.cutoff=1", "first_ao_pass.guard=64", "depth_map.guard=0",
                         "second_ao_pass.layers=raster_sd_map.layers"});
        Graph graph = shippedGraph("svao", settings);
        graph.outputs.clear();
        for (const PortRef& port : outputs) graph.outputs.push_back({port, {}});
        RenderOptions options;
        options.size = size;
        return {graph, shipped(), loadScene(scene), context().capabilities(), options};
    }
    static std::vector<float> floats(Renderer& made, const PortRef& port) {
        return as<float>(made.readBytes(port));
    }
    // Depths of a map, `slots` a texel; of whole numbers reading rounds to 24 bits, which is 8e-6 of a depth.
    static std::vector<float> slotsOf(Renderer& made, const PortRef& port, int slots) {
        const Desc desc = made.desc(port);
        const bool bits = formatInfo(desc.format).integer;
        const int each = bits ? 1 : formatInfo(desc.format).channels;
        std::vector<float> all;
        std::vector<Image> images;
        for (int layer = 0; layer * each < slots; ++layer) images.push_back(made.read(port, layer));
        for (size_t i = 0; i < images[0].pixelCount(); ++i)
            for (int slot = 0; slot < slots; ++slot) {
                const float value =
                    images[static_cast<size_t>(slot / each)]
                        .values[i * static_cast<size_t>(each) + static_cast<size_t>(slot % each)];
                const float depth = bits ? std::bit_cast<float>(static_cast<std::uint32_t>(value)) : value;
                all.push_back(std::min(depth, 3.0e38f));
            }
        return all;
    }
};

const char* const rasterScenes[] = {"builtin:tower?detail=0.2", "builtin:grove?detail=0.05"};
const PortRef rasterDepths{"raster_sd_map", "depths"}, rasterMask{"first_ao_pass", "sd_mask"},
    secondDepth{"second_depth", "second_depth"};

TEST_F(RasterMap, OneSlotThatTakesEverythingIsTheSecondLayer) {
    for (const char* scene : rasterScenes)
        for (const char* collection : {"coverage_mask", "k_buffer"}) {
            Renderer made = svao(scene,
                                 {"raster_sd_map.layers_per_texel=1", "raster_sd_map.interval=false",
                                  "first_ao_pass.divisor=1", "first_ao_pass.guard=0",
                                  fmt::format("raster_sd_map.collection={}", collection)},
                                 {rasterDepths, secondDepth, rasterMask});
            made.frame();
            const auto depths = floats(made, rasterDepths), second = floats(made, secondDepth);
            const auto mask = as<std::uint8_t>(made.readBytes(rasterMask));
            ASSERT_EQ(depths.size(), second.size());
            size_t found = 0, different = 0;
            for (size_t i = 0; i < depths.size(); ++i) {
                const float expected = mask[i] != 0 && second[i] > 0 ? second[i] : INFINITY;
                found += std::isfinite(expected) ? 1 : 0;
                // Two programs may round the depth of a fragment otherwise.
                const bool same = depths[i] == expected || std::abs(depths[i] - expected) <= 1e-5f * expected;
                different += same ? 0 : 1;
            }
            EXPECT_GT(found, 200u) << scene;
            EXPECT_LE(different, found / 200) << scene << " " << collection;
        }
}

TEST_F(RasterMap, ItsKBufferIsThatOfRays) {
    for (const char* scene : rasterScenes)
        for (const char* interval : {"true", "false"}) {
            Renderer made = svao(scene,
                                 {"raster_sd_map.collection=k_buffer", "sd_map.collection=k_buffer",
                                  "first_ao_pass.divisor=2", "sd_map.max_count=0", "sd_map.jitter=false",
                                  fmt::format("sd_map.interval={}", interval),
                                  fmt::format("raster_sd_map.interval={}", interval)},
                                 {rasterDepths, {"sd_map", "depths"}});
            made.frame();
            const auto drawn = slotsOf(made, rasterDepths, 4),
                       traced = slotsOf(made, {"sd_map", "depths"}, 4);
            ASSERT_EQ(drawn.size(), traced.size());
            size_t found = 0, different = 0;
            for (size_t i = 0; i < drawn.size(); ++i) {
                found += traced[i] < 1e38f ? 1 : 0;
                different += std::abs(drawn[i] - traced[i]) <= 1e-4f * traced[i] ? 0 : 1;
            }
            EXPECT_GT(found, 300u) << scene;
            // A ray and a rasterizer fall to different sides of an edge, and of an interval's ends.
            EXPECT_LE(different, found / 50) << scene << " interval " << interval;
        }
}

TEST_F(RasterMap, WithoutAMaskBothAreThatOfTheirOwnSize) {
    for (const char* scene : rasterScenes) {
        std::vector<std::string> settings;
        for (const char* map : {"sd_map", "raster_sd_map"})
            for (const char* setting :
                 {"sd_mask=", "ray_min=", "ray_max=", "collection=k_buffer", "divisor=2", "guard=65"})
                settings.push_back(fmt::format("{}.{}", map, setting));
        settings.insert(settings.end(), {"sd_map.max_count=0", "sd_map.jitter=false"});
        Renderer made = svao(scene, settings, {rasterDepths, {"sd_map", "depths"}});
        made.frame();
        // The depth's guard band has 64 pixels.
        const Desc& map = made.desc({"sd_map", "depths"});
        EXPECT_EQ(map.view, (View{.divisor = 2, .guard = 66}));
        EXPECT_EQ(made.desc(rasterDepths).view, map.view);
        const auto drawn = slotsOf(made, rasterDepths, 4), traced = slotsOf(made, {"sd_map", "depths"}, 4);
        ASSERT_EQ(drawn.size(), traced.size());
        size_t found = 0, different = 0;
        for (size_t i = 0; i < drawn.size(); ++i) {
            found += traced[i] < 1e38f ? 1 : 0;
            different += std::abs(drawn[i] - traced[i]) <= 1e-4f * traced[i] ? 0 : 1;
        }
        EXPECT_GT(found, 500u) << scene;
        EXPECT_LE(different, found / 50) << scene;
    }
}

// Slots are offered nothing but fragments, and in any order the same: twice the same map, whatever is drawn
// first.
TEST_F(RasterMap, EveryCollectionKeepsRealDepthsOnly) {
    for (const char* collection : {"coverage_mask", "reservoir", "k_buffer"})
        for (const int slots : {2, 16}) {
            const std::vector<std::string> kept = {fmt::format("raster_sd_map.collection={}", collection),
                                                   "first_ao_pass.divisor=1",
                                                   fmt::format("raster_sd_map.layers_per_texel={}", slots)};
            Renderer all = svao(rasterScenes[0],
                                {"raster_sd_map.collection=k_buffer", "raster_sd_map.layers_per_texel=16",
                                 "first_ao_pass.divisor=1"},
                                {rasterDepths}),
                     made = svao(rasterScenes[0], kept, {rasterDepths}),
                     again = svao(rasterScenes[0], kept, {rasterDepths});
            all.frame();
            made.frame();
            again.frame();
            const auto depths = slotsOf(made, rasterDepths, slots), sorted = slotsOf(all, rasterDepths, 16);
            EXPECT_EQ(depths, slotsOf(again, rasterDepths, slots)) << collection;
            size_t strange = 0, taken = 0;
            for (size_t i = 0; i < depths.size(); ++i) {
                if (depths[i] > 1e38f) continue;
                ++taken;
                const size_t texel = i / static_cast<size_t>(slots);
                bool known = false;
                for (size_t k = 0; k < 16; ++k)
                    known |= std::abs(sorted[16 * texel + k] - depths[i]) <= 3e-5f * depths[i];
                strange += known ? 0 : 1;
            }
            EXPECT_GT(taken, 200u) << collection;
            EXPECT_EQ(strange, 0u) << collection;
        }
}

TEST_F(RasterMap, RasterAndRayMapsRefineAlike) {
    // Whatever the collection, a map takes most of what the first pass is wrong by.
    const PortRef first{"first_ao_pass", "visibility"}, map{"second_ao_pass", "result"},
        rays{"ray_svao", "result"};
    for (const char* layers : {"raster_sd_map.layers", "sd_map.layers"}) {
        Renderer made = svao(rasterScenes[0],
                             {"first_ao_pass.exponent=4", "first_ao_pass.divisor=1",
                              fmt::format("second_ao_pass.layers={}", layers)},
                             {first, map, rays});
        made.frame();
        const double before = difference(made.read(first), made.read(rays)).rms,
                     after = difference(made.read(map), made.read(rays)).rms;
        EXPECT_LT(after, 0.5 * before) << layers;
    }
}

} // namespace
} // namespace kestrel::test
