// Stiff and extreme cases through the shipped graphs: no NaN, no infinity, nothing out of range, no GL error,
// and what must not matter (scale, place, far plane) does not.
#include "shipped_fixture.h"

namespace kestrel::test {
namespace {

using Settings = std::vector<std::string>;

struct Extremes : ShippedTest {
    static constexpr Extent small{48, 27, 1};

    // Both tracers, three methods of map (EveryMethod has all), a blur and the hit count.
    static void expectSound(const Scene& scene, Extent size = small) {
        RenderOptions options;
        options.checkFinite = options.countIterations = true;
        std::vector<std::pair<const char*, Settings>> runs = {
            {"ray_ao", {}},
            {"ray_ao", {"bom.method=exact", "bom.jitter=true"}},
            {"ray_ao", {"bom.method=dominant_axis", "ao.snap=false", "bom.resolution=64"}},
            {"ray_ao", {"ao.tracer=bvh.tracer"}},
            {"hit_count", {}},
        };
        if (shipped().find("ReferenceAmbientOcclusion") != nullptr)
            runs.push_back({"compare_ao", {"reference.samples=2", "error.interval=1"}});
        for (const auto& [name, settings] : runs) {
            const Graph graph = shippedGraph(name, settings);
            Renderer made = renderer(graph, scene, options, size);
            for (int i = 0; i < 2; ++i) made.frame();
            for (const GraphOutput& output : graph.outputs) {
                const float most = output.port.text() == "count.count" ? 1000.0f : 1.0f;
                for (const float value : made.read(output.port).values)
                    ASSERT_TRUE(value >= 0 && value <= most)
                        << name << " " << output.port.text() << " = " << value;
            }
        }
    }
};

// Every method of map on the scenes that are hard for one: nothing, one triangle, slivers, cells' borders.
struct EveryMethod : Extremes, ::testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(EveryMethod, IsSoundWhereGeometryIsHard) {
    const auto [method, extension] = GetParam();
    if (extension != nullptr && !context().capabilities().has(extension))
        GTEST_SKIP() << "this driver has no " << extension;
    std::vector<glm::vec3> borders;
    for (const float z : {-1.0f, 0.0f, 0.25f, 1.0f})
        for (const glm::vec3& p : square()) borders.push_back(p + glm::vec3(0, 0, z));
    const std::vector<std::vector<glm::vec3>> all = {
        {},
        {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.5f}},
        {{-1, 0.5f, 0}, {1, 0.5f, 0}, {0, 0.5f + 1e-7f, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
        borders};
    RenderOptions options;
    options.checkFinite = true;
    for (const std::vector<glm::vec3>& corners : all) {
        Renderer made =
            renderer(shippedGraph("ray_ao", {std::string("bom.method=") + method, "bom.resolution=64"}),
                     trianglesScene(corners), options, small);
        for (int i = 0; i < 2; ++i) made.frame();
        const Image image = made.read({"mean", "result"});
        for (const float value : image.values) ASSERT_TRUE(value >= 0 && value <= 1) << corners.size();
        // Squares one behind the other hide much of the sky from each other, by whatever method.
        if (corners.size() == borders.size()) {
            EXPECT_LT(*std::min_element(image.values.begin(), image.values.end()), 1.0f);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         ::testing::Values(std::pair{"three_axis", static_cast<const char*>(nullptr)},
                                           std::pair{"logic_op", static_cast<const char*>(nullptr)},
                                           std::pair{"interlock", "GL_ARB_fragment_shader_interlock"},
                                           std::pair{"framebuffer_fetch", "GL_EXT_shader_framebuffer_fetch"},
                                           std::pair{"dominant_axis", static_cast<const char*>(nullptr)},
                                           std::pair{"exact", static_cast<const char*>(nullptr)},
                                           std::pair{"separating", static_cast<const char*>(nullptr)}),
                         [](const auto& of) { return std::string(of.param.first); });

TEST_F(Extremes, TheMethodsOfTheTestAreThoseOfThePass) {
    const PropertyInfo* method = shipped().find("OccupancyMap")->property("method");
    EXPECT_EQ(method->choices,
              (std::vector<std::string>{"three_axis", "logic_op", "interlock", "framebuffer_fetch",
                                        "dominant_axis", "exact", "separating"}));
}

TEST_F(Extremes, AnEmptyScene) { expectSound(trianglesScene({})); }

TEST_F(Extremes, OneTriangle) { expectSound(trianglesScene({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.5f}})); }

TEST_F(Extremes, DegenerateAndSliverTriangles) {
    expectSound(trianglesScene({{0, 0, 0},
                                {0, 0, 0},
                                {0, 0, 0}, // a point
                                {-1, 0, 0},
                                {0, 0, 0},
                                {1, 0, 0}, // a line
                                {-1, 0.5f, 0},
                                {1, 0.5f, 0},
                                {0, 0.5f + 1e-7f, 0}, // a sliver
                                {-1, -1, 0},
                                {1, -1, 0},
                                {0, 1, 0},
                                {-1, -1, 0},
                                {1, -1, 0},
                                {0, 1, 0}}));                       // twice the same
    expectSound(trianglesScene({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}})); // no area, no extent at all
    expectSound(trianglesScene({{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}));
}

TEST_F(Extremes, GeometryOnVoxelBorders) {
    // Axis-parallel squares at multiples of what is a cell's edge for powers of two.
    std::vector<glm::vec3> corners;
    for (const float z : {-1.0f, -0.5f, 0.0f, 0.25f, 1.0f})
        for (const glm::vec3& p : square()) {
            corners.push_back(p + glm::vec3(0, 0, z));
        }
    expectSound(trianglesScene(corners));
}

TEST_F(Extremes, FramesOfOnePixelAndOfOddSize) {
    const Scene scene = loadScene("builtin:blob?detail=0.02");
    for (const Extent size : {Extent{1, 1, 1}, Extent{1, 7, 1}, Extent{33, 17, 1}}) expectSound(scene, size);
}

TEST_F(Extremes, FarOverNearOfAMillion) {
    Scene scene = loadScene("builtin:blob?detail=0.02");
    const CameraState camera = cameraAt(scene, 0, 0);
    const Graph graph = shippedGraph("ray_ao", {"ao.tracer=bvh.tracer"});
    const auto withPlanes = [&](float nearPlane, float farPlane) {
        Renderer made = renderer(graph, scene);
        CameraState changed = camera;
        changed.nearPlane = nearPlane;
        changed.farPlane = farPlane;
        made.setFreeCamera(changed);
        for (int i = 0; i < 4; ++i) made.frame();
        return made.read({"mean", "result"});
    };
    // Depth is reversed and float: the far plane costs no precision. Positions differ in their last bits, so
    // single samples at edges may flip: a quarter in a mean of four frames.
    const Image usual = withPlanes(camera.nearPlane, camera.farPlane);
    EXPECT_LE(difference(usual, withPlanes(1e-3f, 1e3f)).rms, 0.03);
    EXPECT_LE(difference(usual, withPlanes(1e-3f, 0)).rms, 0.03); // infinite
}

// The picture of a scene scaled or moved as a whole is that of the scene, up to single samples that flip at
// edges.
struct Whole : Extremes, ::testing::WithParamInterface<std::pair<double, double>> {};

TEST_P(Whole, ScaleAndPlaceDoNotMatter) {
    const auto [scale, shift] = GetParam();
    const char* source = "builtin:blob?detail=0.02";
    const glm::dmat4 transform =
        glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(shift, -shift, 0.5 * shift)), glm::dvec3(scale));
    const Scene changed = transformed(source, transform);
    expectSound(changed);
    RenderOptions otherSeed;
    otherSeed.seed = 3;
    for (const Settings& settings :
         {Settings{"ao.tracer=bvh.tracer"}, Settings{}, Settings{"bom.method=exact"}}) {
        const Image usual = render(shippedGraph("ray_ao", settings), transformed(source, glm::dmat4(1)),
                                   {"mean", "result"}, 4);
        const Image other = render(shippedGraph("ray_ao", settings), changed, {"mean", "result"}, 4);
        const Image seed =
            render(shippedGraph("ray_ao", settings), changed, {"mean", "result"}, 4, otherSeed);
        // No further apart than the pictures of two seeds, and by far less on the whole.
        EXPECT_LE(difference(usual, other).rms, 0.5 * difference(usual, seed).rms);
    }
}

INSTANTIATE_TEST_SUITE_P(ScaleAndShift, Whole,
                         ::testing::Values(std::pair{1e-4, 0.0}, std::pair{1e4, 0.0}, std::pair{1.0, 2e4},
                                           std::pair{1e-4, 2.0}));

} // namespace
} // namespace kestrel::test
