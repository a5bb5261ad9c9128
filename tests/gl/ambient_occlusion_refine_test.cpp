// The second pass of ambient occlusion, on built-in scenes.
#include "shared/work_list.h"
#include "shipped_fixture.h"
#include <bit>

namespace kestrel::test {
namespace {

const PortRef firstPass{"first_ao_pass", "visibility"}, aoMask{"first_ao_pass", "mask"},
    byMap{"second_ao_pass", "result"}, byRays{"ray_svao", "result"};

struct RefinePass : ShippedTest {
    static Renderer svao(const std::string& scene, const char* camera, std::vector<std::string> settings,
                         const std::vector<PortRef>& outputs, Extent size = {128, 72, 1}) {
        // In so small a picture everything is near on screen.
        settings.insert(settings.begin(), {"first_ao_pass.exponent=4", "first_ao_pass.cutoff=1"});
        Graph graph = shippedGraph("svao", settings);
        graph.outputs.clear();
        for (const PortRef& port : outputs) graph.outputs.push_back({port, {}});
        RenderOptions options;
        options.camera = camera;
        options.size = size;
        options.checkFinite = true;
        return {graph, shipped(), loadScene(scene), context().capabilities(), options};
    }
    struct Pictures {
        Image first, map, rays, mask;
        // Mean squared error to the reference over the refined pixels.
        [[nodiscard]] double error(const Image& image) const {
            double sum = 0, count = 0;
            for (size_t i = 0; i < mask.values.size(); ++i)
                if (mask.values[i] > 0) {
                    sum += std::pow(double{image.values[i]} - double{rays.values[i]}, 2);
                    ++count;
                }
            EXPECT_GT(count, 200);
            return sum / count;
        }
    };
    static Pictures pictures(const std::string& scene, const char* camera,
                             const std::vector<std::string>& settings) {
        Renderer made = svao(scene, camera, settings, {firstPass, aoMask, byMap, byRays});
        made.frame();
        return {made.read(firstPass), made.read(byMap), made.read(byRays), made.read(aoMask)};
    }
};

const std::vector<std::string> onScreen = {"first_ao_pass.guard=0", "depth_map.guard=0"};

TEST_F(RefinePass, NeverBrightensWhatIsOnScreenAndLeavesTheRest) {
    for (const char* scene : {"builtin:tower?detail=0.2", "builtin:grove?detail=0.05"})
        for (const char* kernel : {"vao", "hbao"}) {
            std::vector<std::string> settings = onScreen;
            settings.push_back(fmt::format("first_ao_pass.kernel={}", kernel));
            const Pictures seen = pictures(scene, "", settings);
            size_t darker = 0;
            for (size_t i = 0; i < seen.mask.values.size(); ++i) {
                const float before = seen.first.values[i];
                // Half floats of the mean before the power: a step of it.
                EXPECT_LE(seen.map.values[i], before * 1.003f + 1e-4f);
                EXPECT_LE(seen.rays.values[i], before * 1.003f + 1e-4f);
                darker += seen.map.values[i] < before - 0.05f ? 1 : 0;
                if (seen.mask.values[i] == 0) {
                    ASSERT_EQ(seen.map.values[i], before);
                    ASSERT_EQ(seen.rays.values[i], before);
                }
            }
            EXPECT_GT(darker, 50u) << scene << " " << kernel;
        }
}

// Every layer in its own slot, where every sample has its own texel: what is left are samples whose texel is
// taken at another place than the ray.
TEST_F(RefinePass, WithAllLayersAtFullResolutionItIsTheReference) {
    for (const auto& [scene, camera] :
         {std::pair("builtin:tower?detail=0.2", "outside"), {"builtin:hall?detail=0.1", "nave"}}) {
        const Pictures seen = pictures(scene, camera,
                                       {"first_ao_pass.divisor=1", "sd_map.layers_per_texel=8",
                                        "sd_map.collection=k_buffer", "sd_map.max_count=0"});
        EXPECT_LE(seen.error(seen.map), 2e-3) << scene;
        EXPECT_LE(seen.error(seen.map), 0.05 * seen.error(seen.first)) << scene;
    }
}

TEST_F(RefinePass, MoreSlotsComeNearerToTheReference) {
    double before = 1e9;
    for (const int slots : {1, 2, 4, 8}) {
        const Pictures seen =
            pictures("builtin:lattice", "corner",
                     {"first_ao_pass.radius=0.3", fmt::format("sd_map.layers_per_texel={}", slots)});
        const double error = seen.error(seen.map);
        RecordProperty(fmt::format("slots_{}", slots), fmt::format("{}", error));
        if (slots == 1) before = seen.error(seen.first);
        EXPECT_LT(error, before) << slots;
        before = error;
    }
}

TEST_F(RefinePass, MoreHitsComeNearerToTheReference) {
    double before = 1e9;
    for (const int hits : {4, 8, 16}) {
        const Pictures seen =
            pictures("builtin:lattice", "corner",
                     {"first_ao_pass.radius=0.4", fmt::format("sd_map.max_count={}", hits)});
        const double error = seen.error(seen.map);
        RecordProperty(fmt::format("hits_{}", hits), fmt::format("{}", error));
        if (hits == 8) {
            EXPECT_LE(error, 0.25 * seen.error(seen.first));
        }
        EXPECT_LT(error, before) << hits;
        before = error;
    }
}

// Elsewhere rays meet fewer surfaces than that: more slots and hits gain little, but lose nothing. Four
// hundredths are for which of several hits chance keeps in so small a picture (at 640x360 nothing rises).
TEST_F(RefinePass, MoreSlotsAndHitsNeverHarm) {
    const std::pair<const char*, const char*> views[] = {{"builtin:tower?detail=0.3", "outside"},
                                                         {"builtin:hall?detail=0.3", "nave"},
                                                         {"builtin:grove?detail=0.1", "path"}};
    for (const auto& [scene, camera] : views)
        for (const char* count : {"sd_map.layers_per_texel={}", "sd_map.max_count={}"}) {
            double before = 1e9;
            for (const int value : {2, 4, 8, 16}) {
                if (value == 2 && count[7] == 'm') continue; // fewer hits than slots
                const Pictures seen = pictures(
                    scene, camera, {"first_ao_pass.radius=0.4", fmt::format(fmt::runtime(count), value)});
                const double error = seen.error(seen.map);
                EXPECT_LE(error, 1.04 * before) << scene << " " << count << " " << value;
                before = error;
            }
        }
}

// Where hits come front to back, what comes later is farther: a reservoir whose hits replace farther ones
// only keeps the first, however many it is shown.
TEST_F(RefinePass, CullingMakesTheFirstHitsStay) {
    const auto error = [](const char* count, const char* cull) {
        const Pictures seen =
            pictures("builtin:lattice", "corner", {"first_ao_pass.radius=0.4", count, cull});
        return seen.error(seen.map);
    };
    const double four = error("sd_map.max_count=4", "sd_map.z_cull=true"),
                 sixteen = error("sd_map.max_count=16", "sd_map.z_cull=true");
    EXPECT_GT(sixteen, 0.9 * four);
    EXPECT_LT(error("sd_map.max_count=16", "sd_map.z_cull=false"), 0.5 * sixteen);
}

// Near the border samples leave the picture; what a guard band of the map alone knows of them, against rays.
TEST_F(RefinePass, TheMapsGuardBandMendsTheBorder) {
    const std::pair<const char*, const char*> views[] = {{"builtin:tower?detail=0.3", "stairs"},
                                                         {"builtin:hall?detail=0.3", "nave"},
                                                         {"builtin:grove?detail=0.1", "path"}};
    for (const auto& [scene, camera] : views) {
        const auto picture = [&, scene = scene, camera = camera](const PortRef& port, const char* guard) {
            Renderer made =
                svao(scene, camera,
                     {"first_ao_pass.radius=1", "first_ao_pass.cutoff=3", "depth_map.guard=0", guard}, {port},
                     {320, 180, 1});
            made.frame();
            return made.read(port);
        };
        const Image rays = picture(byRays, "first_ao_pass.guard=256"),
                    with = picture(byMap, "first_ao_pass.guard=256"),
                    without = picture(byMap, "first_ao_pass.guard=0");
        constexpr int border = 12;
        double errorWith = 0, errorWithout = 0;
        for (int y = 0; y < rays.height; ++y)
            for (int x = 0; x < rays.width; ++x) {
                if (std::min({x, y, rays.width - 1 - x, rays.height - 1 - y}) >= border) continue;
                errorWith += std::pow(double{with.at(x, y)} - double{rays.at(x, y)}, 2);
                errorWithout += std::pow(double{without.at(x, y)} - double{rays.at(x, y)}, 2);
            }
        RecordProperty(fmt::format("border_{}", camera), fmt::format("{}", errorWith / errorWithout));
        EXPECT_GT(errorWithout, 10) << scene;
        EXPECT_LE(errorWith, 0.25 * errorWithout) << scene;
    }
}

TEST_F(RefinePass, AnEmptyMaskIsLeftOutByIndirectDispatch) {
    std::vector<std::string> settings = onScreen;
    settings.push_back("first_ao_pass.cutoff=1000");
    Renderer made =
        svao("builtin:tower?detail=0.1", "", settings,
             {firstPass, aoMask, byMap, byRays, {"first_ao_pass", "pixels"}, {"sd_map", "depths"}});
    made.frame();
    const auto header = as<std::uint32_t>(made.readBytes({"first_ao_pass", "pixels"}));
    EXPECT_EQ(header.at(0), 0u); // items
    EXPECT_EQ(header.at(4), 0u); // work groups
    EXPECT_EQ(made.read(byMap), made.read(firstPass));
    EXPECT_EQ(made.read(byRays), made.read(firstPass));
    for (const float depth : made.read({"sd_map", "depths"}).values) ASSERT_EQ(depth, 3.0e38f);
}

// What a pixel at the border is told by the guard bands is what it would see inside of a larger frame. The
// larger one is wider by whole tiles of the pattern, so that every pixel has the same samples.
TEST_F(RefinePass, ABorderPixelIsAsInALargerFrame) {
    const int more = 32, border = 4;
    const Extent small{112, 64, 1}, large{small.width + 2 * more, small.height + 2 * more, 1};
    for (const auto& [source, camera, settings] :
         {std::tuple("builtin:tower?detail=0.2", "above", std::vector<std::string>{"first_ao_pass.radius=1"}),
          {"builtin:hall?detail=0.1", "nave", {"first_ao_pass.radius=1"}},
          {"builtin:hall?detail=0.1", "nave", {"first_ao_pass.kernel=hbao", "first_ao_pass.radius=1.5"}}}) {
        const Scene scene = loadScene(source);
        const auto frame = [&, settings = &settings, camera = camera](const Extent& size) {
            Graph graph = shippedGraph("svao", *settings);
            graph.outputs = {{byRays, {}}, {aoMask, {}}};
            RenderOptions options;
            options.size = size;
            Renderer made(graph, shipped(), scene, context().capabilities(), options);
            CameraState state = cameraAt(scene, cameraIndex(scene, camera), 0);
            const auto heights = static_cast<float>(size.height) / static_cast<float>(small.height);
            state.verticalFov = 2 * std::atan(std::tan(state.verticalFov / 2) * heights);
            made.setFreeCamera(state);
            made.frame();
            return std::pair(made.read(byRays), made.read(aoMask));
        };
        const auto [alone, mask] = frame(small);
        const auto [around, unused] = frame(large);
        int pixels = 0, far = 0, occluded = 0, marked = 0;
        for (int y = 0; y < alone.height; ++y)
            for (int x = 0; x < alone.width; ++x) {
                if (std::min({x, y, alone.width - 1 - x, alone.height - 1 - y}) >= border) continue;
                ++pixels;
                occluded += alone.at(x, y) < 0.9f ? 1 : 0;
                marked += mask.at(x, y) > 0 ? 1 : 0;
                far += std::abs(alone.at(x, y) - around.at(x + more, y + more)) > 0.02f ? 1 : 0;
            }
        RecordProperty(fmt::format("{} {}", source, settings.back()), fmt::format("{} of {}", far, pixels));
        EXPECT_LE(far, pixels / 100) << source << " " << settings.back();
        EXPECT_GT(occluded, pixels / 20) << source;
        EXPECT_GT(marked, pixels / 40) << source;
    }
}

TEST_F(RefinePass, SamplesOfSeveralStepsAreThoseOfOne) {
    // 16 samples take two steps of rays; the layers take one for both, and all of them in the k-buffer are
    // the same.
    const Pictures seen =
        pictures("builtin:tower?detail=0.1", "outside",
                 {"first_ao_pass.samples=16", "first_ao_pass.divisor=1", "sd_map.layers_per_texel=8",
                  "sd_map.collection=k_buffer", "sd_map.max_count=0"});
    EXPECT_LE(seen.error(seen.map), 0.05 * seen.error(seen.first));
}

TEST_F(RefinePass, ASceneWithoutMaskedMaterialsHasNoAlphaTest) {
    const Renderer plain = svao("builtin:tower?detail=0.1", "", {}, {byMap}),
                   masked = svao("builtin:grove?detail=0.05", "", {}, {byMap});
    const auto tests = [](const Renderer& made) {
        size_t count = 0;
        for (const ProgramRequest& program : made.plan().programs)
            count += program.defines.contains("MATERIAL_MASKED") ? 1 : 0;
        return count;
    };
    EXPECT_EQ(tests(plain), 0u);
    EXPECT_GT(tests(masked), 0u);
}

TEST_F(RefinePass, WhatItReadsMustBeConnected) {
    Graph graph = parseGraph(R"({"kestrel": 1, "passes": {"gbuffer": {"type": "GBuffer"},
        "first": {"type": "AmbientOcclusionFirst"}, "second": {"type": "AmbientOcclusionRefine", "properties": {"dual": true}}},
        "edges": [["gbuffer.view_depth", "first.view_depth"], ["gbuffer.normal", "first.normal"],
            ["first.visibility", "second.visibility"], ["first.mean", "second.mean"], ["first.mask", "second.mask"],
            ["first.pixels", "second.pixels"], ["first.settings", "second.settings"],
            ["gbuffer.view_depth", "second.view_depth"], ["gbuffer.normal", "second.normal"]],
        "outputs": ["second.result"]})",
                             "test.json");
    try {
        renderer(graph, trianglesScene(square()));
        FAIL();
    } catch (const InputError& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("`source` layers needs it connected"), std::string::npos) << message;
        EXPECT_NE(message.find("`dual` needs it connected"), std::string::npos) << message;
    }
}

} // namespace
} // namespace kestrel::test
