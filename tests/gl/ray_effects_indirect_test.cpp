// One bounce: analytic truth, then the reference ray tracer, then what must not matter.
#include "ray_effects_fixture.h"

namespace kestrel::test {
namespace {

using Settings = std::vector<std::string>;
const PortRef gbufferPosition{"gbuffer", "position"}, gbufferCoverage{"gbuffer", "coverage"};

struct Indirect : EffectsTest {
    static Scene glowingBall() {
        Scene scene = trianglesScene(ball(1, 12));
        scene.materials[0].baseColour = glm::vec4(0.5f, 0.5f, 0.5f, 1);
        scene.materials[0].metallic = 0;
        scene.materials[0].emission = {0.25f, 0.5f, 2};
        return scene;
    }
};

TEST_F(Indirect, InsideAGlowingBallItIsTheBallsRadianceExactly) {
    const Image light =
        run(effectsGraph({bounce}), glowingBall(), {bounce}, 2, lookingAt({0, 0, 0}, {1, 0.2f, 0}))[0];
    for (int y = 0; y < light.height; ++y)
        for (int x = 0; x < light.width; ++x) {
            ASSERT_EQ(light.at(x, y, 0), 0.25f);
            ASSERT_EQ(light.at(x, y, 1), 0.5f);
            ASSERT_EQ(light.at(x, y, 2), 2.0f);
        }
}

TEST_F(Indirect, IntoAClosedBallNoSkyFalls) {
    for (const bool exact : {true, false}) {
        Settings settings = {"sky.colour=[1,1,1]", "indirect.radiance=sky.radiance"};
        if (!exact) settings.push_back("indirect.tracer=roma.tracer");
        const Image light = run(effectsGraph({bounce}, settings), glowingBall(), {bounce}, 8,
                                lookingAt({0, 0, 0}, {1, 0.2f, 0}))[0];
        double sum = 0;
        for (int y = 0; y < light.height; ++y)
            for (int x = 0; x < light.width; ++x) sum += light.at(x, y, 0);
        // The map holds every cell that the ball touches; rotated by point samples some light leaks.
        EXPECT_LE(sum / (light.width * light.height), exact ? 0.0 : 0.02);
    }
}

// Every point of the wall gets I / R^2 from a light in the middle, and sends albedo times it over pi.
TEST_F(Indirect, TheIntegratingSphere) {
    Scene scene = trianglesScene(ball(2, 32));
    scene.materials[0].baseColour = glm::vec4(0.8f, 0.4f, 0.2f, 1);
    scene.materials[0].metallic = 0;
    Light lamp;
    lamp.kind = LightKind::Point;
    lamp.intensity = 10;
    addLightTo(scene, lamp, {0, 0, 0}, {1, 0, 0, 0});
    const double expected = 0.8 * 10 / (4 * glm::pi<double>());
    for (const Settings& settings :
         {Settings{}, Settings{"indirect.radiance=rsm.radiance"},
          Settings{"indirect.radiance=rsm.radiance", "indirect.tracer=roma.tracer"},
          Settings{"indirect.radiance=rsm.radiance", "indirect.tracer=roma.tracer", "roma.offset=0.5"},
          Settings{"indirect.radiance=rsm.radiance", "indirect.tracer=roma.tracer", "indirect.snap=false",
                   "roma.iterations=64"}}) {
        const Image light =
            run(effectsGraph({bounce}, settings), scene, {bounce}, 8, lookingAt({0, 0, 0}, {1, 0.2f, 0}))[0];
        double sum[3] = {};
        for (int y = 0; y < light.height; ++y)
            for (int x = 0; x < light.width; ++x)
                for (int k = 0; k < 3; ++k)
                    sum[k] += double{light.at(x, y, k)} / (light.width * light.height);
        // Facets stand up to 1 % nearer than the sphere. Through ROMA as exactly (measured: 0.2 % off) where
        // rays start 1.5 cells off the surface; from half a cell on 6.5 % are lost of 64 cells, to hits of
        // the surface's own cells further behind it than the map of light takes for it.
        const double tolerance = !settings.empty() && settings.back() == "roma.offset=0.5" ? 0.08 : 0.02;
        EXPECT_NEAR(sum[0] / expected, 1, tolerance) << settings.size();
        EXPECT_NEAR(sum[1] / expected, 0.5, 0.5 * tolerance) << settings.size();
        EXPECT_NEAR(sum[2] / expected, 0.25, 0.25 * tolerance) << settings.size();
    }
}

TEST_F(Indirect, AnOpenPlaneUnderASky) {
    const Scene scene = trianglesScene(square());
    for (const float degrees : {0.0f, 40.0f, 75.0f}) {
        const glm::vec3 eye(3 * std::sin(glm::radians(degrees)), 0, 3 * std::cos(glm::radians(degrees)));
        const Settings sky = {"sky.colour=[0.5,1,4]", "indirect.radiance=sky.radiance"};
        const auto images = run(effectsGraph({bounce, gbufferCoverage}, sky), scene,
                                {bounce, gbufferCoverage}, 2, lookingAt(eye, {0, 0, 0}));
        Settings throughRoma = sky;
        throughRoma.push_back("indirect.tracer=roma.tracer");
        const Image roma =
            run(effectsGraph({bounce}, throughRoma), scene, {bounce}, 16, lookingAt(eye, {0, 0, 0}))[0];
        double sum = 0, count = 0;
        for (int y = 0; y < roma.height; ++y)
            for (int x = 0; x < roma.width; ++x) {
                const bool there = images[1].at(x, y) > 0;
                ASSERT_EQ(images[0].at(x, y, 0), there ? 0.5f : 0.0f);
                ASSERT_EQ(images[0].at(x, y, 2), there ? 4.0f : 0.0f);
                sum += there ? double{roma.at(x, y, 1)} : 0;
                count += there ? 1 : 0;
            }
        ASSERT_GT(count, 20);
        EXPECT_GE(sum / count, 0.995) << degrees;
    }
}

TEST_F(Indirect, HalfASky) {
    // A wall 100 high and 200 long beside the floor takes what is below its edge.
    const Scene scene = trianglesScene(joined(parallelogram({0, 0, -100}, {0, 0, 200}, {2, 0, 0}),
                                              parallelogram({0, 0, -100}, {0, 100, 0}, {0, 0, 200})));
    const glm::vec3 middle(1, 50, 0); // what render space counts from
    const auto images =
        run(effectsGraph({bounce, gbufferPosition}, {"sky.colour=[1,1,1]", "indirect.radiance=sky.radiance"}),
            scene, {bounce, gbufferPosition}, 16,
            lookingAt(glm::vec3(1, 2, 0) - middle, glm::vec3(1, 0, 0) - middle, {1, 0, 0}));
    double error = 0, count = 0, bias = 0;
    for (int y = 0; y < images[0].height; ++y)
        for (int x = 0; x < images[0].width; ++x) {
            if (images[1].at(x, y, 3) == 0 || images[1].at(x, y, 1) > -49.9f) continue;
            const double d = double{images[1].at(x, y, 0)} + 1;
            const double expected = 0.5 * (1 + d / std::sqrt(d * d + 1e4));
            error += std::pow(double{images[0].at(x, y, 0)} - expected, 2);
            bias += double{images[0].at(x, y, 0)} - expected;
            ++count;
        }
    ASSERT_GT(count, 100);
    // 256 stratified rays: about a quarter of the 1/32 of independent ones.
    EXPECT_LE(std::sqrt(error / count), 0.012);
    EXPECT_LE(std::abs(bias / count), 0.002);
}

TEST_F(Indirect, ConvergesToEmbree) {
    if (!hasReferences()) GTEST_SKIP() << "Embree is not built in";
    for (const char* source : {"builtin:cornell", "builtin:hall?detail=0.1"}) {
        const Scene scene = loadScene(source);
        const auto truth =
            run(embreeGraph({{"indirect", "result"}, gbufferCoverage}, {"indirect.samples=1024"}), scene,
                {{"indirect", "result"}, gbufferCoverage}, 1);
        // Rectangles are shadowed from their middle by DirectLight; every point of them counts in the
        // reference. A spot has no such difference.
        const bool same = std::string(source).find("hall") != std::string::npos;
        const Settings settings = {"direct.emission=false", "direct.resolution=1024"};
        const Image few = run(effectsGraph({bounce}, settings), scene, {bounce}, 1)[0];
        const Image many = run(effectsGraph({bounce}, settings), scene, {bounce}, 16)[0];
        double level = 0, count = 0;
        for (int y = 0; y < many.height; ++y)
            for (int x = 0; x < many.width; ++x)
                if (truth[1].at(x, y) > 0) {
                    level += truth[0].at(x, y, 1);
                    ++count;
                }
        level /= count;
        EXPECT_LE(colourError(truth[0], many, truth[1]), (same ? 0.15 : 0.5) * level) << source;
        if (same) {
            EXPECT_LE(colourError(truth[0], many, truth[1]), 0.5 * colourError(truth[0], few, truth[1]))
                << source;
        }
    }
}

TEST_F(Indirect, RaysOfOneStepAndOfSeveralAreTheSame) {
    const Scene scene = loadScene("builtin:cornell");
    for (const Settings& by :
         {Settings{}, Settings{"indirect.tracer=roma.tracer", "indirect.radiance=sky.radiance"}}) {
        Settings more = by;
        more.push_back("indirect.rays=32");
        const Image once = run(effectsGraph({bounce}, more), scene, {bounce}, 1)[0];
        const Image twice = run(effectsGraph({bounce}, by), scene, {bounce}, 2)[0];
        // Roma draws other candidates in the second frame.
        if (by.empty()) {
            EXPECT_LE(difference(once, twice).largest, 1e-5);
        }
        EXPECT_LE(difference(once, twice).rms, 0.1);
    }
}

TEST_F(Indirect, ARadianceThatNeedsMaterialsIsRefusedToATracerWithout) {
    try {
        run(effectsGraph({bounce}, {"indirect.tracer=roma.tracer"}), loadScene("builtin:cornell"), {bounce},
            1);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("needs normals and materials at hits"), std::string::npos)
            << error.what();
    }
}

TEST_F(Indirect, ABoundedDistanceMeetsLess) {
    const Settings sky = {"sky.colour=[1,1,1]", "indirect.radiance=sky.radiance"};
    Settings bounded = sky;
    bounded.push_back("indirect.distance=0.2");
    const Scene scene = loadScene("builtin:cornell");
    const auto all = run(effectsGraph({bounce, gbufferCoverage}, sky), scene, {bounce, gbufferCoverage}, 2);
    EXPECT_GT(meanWhere(run(effectsGraph({bounce}, bounded), scene, {bounce}, 2)[0], all[1]),
              meanWhere(all[0], all[1]) + 0.1);
}

} // namespace
} // namespace kestrel::test
