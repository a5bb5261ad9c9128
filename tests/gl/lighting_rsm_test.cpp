// Reflective shadow maps: what the module says, sums of modules, gathering, and what is made when.
#include "lighting_fixture.h"

namespace kestrel::test {
namespace {

const std::string rsm = R"("source": {"type": "ReflectiveShadowMap"})";

struct Rsm : LightingTest {
    static Light spot(float intensity = 3) {
        Light light = lightOf(LightKind::Spot, intensity);
        light.innerCone = 0.95f;
        light.outerCone = 1.1f;
        return light;
    }
};

TEST_F(Rsm, APlaneReflectsAlbedoOverPiTimesItsIrradiance) {
    const glm::vec3 albedo(0.2f, 0.5f, 0.9f);
    const std::pair<Light, const char*> cases[] = {
        {spot(), ""},
        {lightOf(LightKind::Point, 3), ""},
        {lightOf(LightKind::Directional, 3), R"("directional": true)"}};
    for (const auto& [light, properties] : cases) {
        const Scene scene = litScene(square(), {{light, {0.2f, 0.1f, 1}, {0, 0, -1}}}, albedo);
        const Image truth = picture(directGraph(), scene);
        const Image probe =
            picture(probeGraph(fmt::format(
                        R"("source": {{"type": "ReflectiveShadowMap", "properties": {{{}}}}})", properties)),
                    scene);
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x)
                for (int c = 0; c < 3; ++c) {
                    // Half floats, and the texel's middle instead of the point: 1 / 512 of the map's width
                    // away.
                    const float expected = albedo[c] * truth.at(x, y, c);
                    ASSERT_NEAR(probe.at(x, y, c), expected, 0.015f * expected + 1e-3f)
                        << static_cast<int>(light.kind) << " at " << x << ", " << y;
                }
    }
}

// A spot wider than one map can be has five faces, none of them behind it.
TEST_F(Rsm, AWideSpotLightIsReflectedAsAPointLightIs) {
    Light wide = lightOf(LightKind::Spot, 3);
    wide.innerCone = 1.55f;
    wide.outerCone = 1.57f;
    // From beside the plane and from close above it, where most of it is on the faces at the sides.
    for (const glm::vec3 at : {glm::vec3(0.2f, 0.1f, 1), glm::vec3(-0.3f, 0.2f, 0.25f)}) {
        const Image point =
            picture(probeGraph(rsm), litScene(square(), {{lightOf(LightKind::Point, 3), at, {0, 0, -1}}}));
        const Image spot = picture(probeGraph(rsm), litScene(square(), {{wide, at, {0, 0, -1}}}));
        for (int y = 2; y < 62; ++y)
            for (int x = 2; x < 62; ++x) {
                ASSERT_GT(point.at(x, y), 0) << x << ", " << y;
                ASSERT_NEAR(spot.at(x, y), point.at(x, y), 0.02f * point.at(x, y) + 1e-3f)
                    << at.z << " at " << x << ", " << y;
            }
    }
}

TEST_F(Rsm, TiltedPlanesHaveNoAcne) {
    for (const float tilt : {0.7f, 1.2f, 1.5f}) {
        const glm::vec3 direction(std::sin(tilt), 0.1f, -std::cos(tilt));
        const Scene scene = litScene(square(), {{spot(), -2.0f * glm::normalize(direction), direction}});
        const Image truth = picture(directGraph(R"("shadows": false)"), scene);
        const Image probe = picture(probeGraph(R"("source": {"type": "ReflectiveShadowMap"})"), scene);
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const float expected = 0.5f * truth.at(x, y);
                // Flat light: a texel covers much of the plane, at its border nothing.
                if (x < 2 || y < 2 || x > 61 || y > 61) continue;
                ASSERT_NEAR(probe.at(x, y), expected, 0.15f * expected + 2e-3f)
                    << tilt << " at " << x << ", " << y;
            }
    }
}

// Light from above; the probe sees the lit side, then the same surface's other side, then points off the
// surface.
TEST_F(Rsm, OnlyTheLitSideOfTheSurfaceItselfCounts) {
    const auto probed = [&](const std::string& properties, float z) {
        return picture(probeGraph(rsm, "", properties),
                       litScene(square(), {{spot(), {0, 0, z}, {0, 0, -z}}}));
    };
    EXPECT_GT(probed("", 1).at(32, 32), 0.1f);
    EXPECT_EQ(probed("", -1).at(32, 32), 0) << "the other side is dark";
    EXPECT_EQ(probed("\"lift\": 0.1", 1).at(32, 32), 0) << "nothing is there";
    EXPECT_EQ(probed("\"lift\": -0.1", 1).at(32, 32), 0);
    EXPECT_EQ(probed("\"lift\": -0.1, \"error\": 0.3", 1).at(32, 32), 0)
        << "behind the surface a quarter of the error counts";
    EXPECT_GT(probed("\"lift\": -0.1, \"error\": 0.44", 1).at(32, 32), 0.1f);
    EXPECT_GT(probed("\"lift\": 0.1, \"error\": 0.11", 1).at(32, 32), 0.1f);
}

TEST_F(Rsm, WhatStandsInShadowReflectsNothing) {
    std::vector<glm::vec3> corners = join(square(), quad({0, 0, 0.5f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
    corners = join(corners, quad({0, 0, -0.5f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
    auto made = lit(probeGraph(rsm), litScene(corners, {{spot(), {0, 0, 1}, {0, 0, -1}}}));
    CameraState camera = squareCamera();
    camera.view = glm::translate(glm::mat4(1), glm::vec3(0, 0, -0.45f));
    camera.position = glm::vec3(0, 0, 0.45f);
    made.setFreeCamera(camera);
    made.frame();
    const Image image = made.read({"probe", "result"});
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const glm::vec3 p = squarePoint(image, x, y);
            const float reach = std::max(std::abs(p.x), std::abs(p.y));
            if (reach < 0.48f) {
                ASSERT_EQ(image.at(x, y), 0) << x << ", " << y;
            }
            if (reach > 0.52f && glm::length(p) < 1.3f) {
                ASSERT_GT(image.at(x, y), 0) << x << ", " << y;
            }
        }
}

TEST_F(Rsm, ASumIsTheSumOfItsParts) {
    const Scene scene = litScene(square(), {{spot(), {0.3f, 0.1f, 1}, {0, 0, -1}}});
    const std::string parts = R"("a": {"type": "ReflectiveShadowMap"}, "b": {"type": "DirectLight"},
        "c": {"type": "Environment", "properties": {"kind": "constant", "colour": [0.5, 0.25, 0.125]}},
        "source": {"type": "RadianceSum"})";
    const std::string gbuffer = R"(,["g.depth", "b.depth"], ["g.normal", "b.normal"],)";
    const auto sum = [&](const std::string& edges) {
        return picture(probeGraph(parts, gbuffer + edges), scene);
    };
    const Image all = sum(
        R"(["a.radiance", "source.first"], ["b.radiance", "source.second"], ["c.radiance", "source.third"])");
    const Image alike = sum(
        R"(["a.radiance", "source.first"], ["a.radiance", "source.second"], ["a.radiance", "source.third"], ["a.radiance", "source.fourth"])");
    const Image a = picture(probeGraph(rsm), scene);
    const Image b = picture(probeGraph(R"("source": {"type": "DirectLight"})",
                                       R"(,["g.depth", "source.depth"], ["g.normal", "source.normal"])"),
                            scene);
    for (size_t i = 0; i < all.values.size(); ++i) {
        if (i % 4 == 3) continue;
        ASSERT_NEAR(all.values[i], a.values[i] + b.values[i], 1e-6f);
        ASSERT_NEAR(alike.values[i], 4 * a.values[i], 1e-6f);
    }
    // What misses sees the environment.
    auto away =
        lit(probeGraph(parts, gbuffer + R"(["c.radiance", "source.first"], ["a.radiance", "source.second"])"),
            scene);
    CameraState camera = squareCamera();
    camera.view = glm::translate(glm::mat4(1), glm::vec3(5, 0, -3));
    away.setFreeCamera(camera);
    away.frame();
    const Image sky = away.read({"probe", "result"});
    EXPECT_EQ(pixelColour(sky, 10, 10), glm::vec3(0.5f, 0.25f, 0.125f));
}

// A floor lit by a spot light, and a wall beside it. All points of the floor are seen from all points of the
// wall, so that the light there is an integral over the floor.
TEST_F(Rsm, GatheringIsTheIntegralOverALitFloor) {
    // The floor is z = -0.5 with x, y in [-1, 1]; the wall x = -1 with z in [-0.5, 0.5].
    std::vector<glm::vec3> corners = quad({0, 0, -0.5f}, {1, 0, 0}, {0, 1, 0});
    corners = join(corners, quad({-1, 0, 0}, {0, 1, 0}, {0, 0, 0.5f}));
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Light light = lightOf(kind, 3);
        light.innerCone = 0.5f;
        light.outerCone = 0.7f;
        // Of the point light the wall gets its share, too, but cannot light itself.
        const glm::vec3 at(0.1f, 0.1f, 0.45f);
        const Scene scene = litScene(corners, {{light, at, {0, 0, -1}}}, glm::vec3(0.6f));
        const Graph graph = graphOf(
            fmt::format(R"("g": {{"type": "GBuffer"}}, "rsm": {{"type": "ReflectiveShadowMap"}},
               "gather": {{"type": "RsmGather", "properties": {{"samples": 512, "radius": {}}}}}, "mean": {{"type": "Accumulate"}})",
                        1),
            R"(["g.depth", "gather.depth"], ["g.normal", "gather.normal"], ["rsm.maps", "gather.maps"],
               ["rsm.map_radiance", "gather.map_radiance"], ["rsm.map_normal", "gather.map_normal"],
               ["rsm.map_position", "gather.map_position"], ["gather.result", "mean.signal"])",
            R"("mean.result")");
        auto made = lit(graph, scene);
        // Looks at the wall along -x: right is -y... up is +z, half height 0.5 and half width 0.5.
        CameraState camera = squareCamera();
        camera.position = glm::vec3(0.9f, 0, 0);
        camera.view = glm::lookAt(camera.position, glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1));
        camera.halfHeight = 0.5f;
        made.setFreeCamera(camera);
        for (int i = 0; i < 16; ++i) made.frame();
        const Image image = made.read({"mean", "result"});
        for (const glm::ivec2 pixel :
             {glm::ivec2(32, 10), glm::ivec2(10, 30), glm::ivec2(50, 40), glm::ivec2(32, 55)}) {
            const glm::vec3 p(-1, (2 * (static_cast<float>(pixel.x) + 0.5f) / 64 - 1) * 0.5f,
                              (1 - 2 * (static_cast<float>(pixel.y) + 0.5f) / 64) * 0.5f);
            constexpr int n = 400;
            double sum = 0;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const glm::vec3 q((2 * static_cast<float>(i) + 1) / n - 1,
                                      (2 * static_cast<float>(j) + 1) / n - 1, -0.5f);
                    const glm::vec3 to = at - q;
                    const float d = glm::length(to);
                    const float scale = 1 / (std::cos(0.5f) - std::cos(0.7f));
                    float share = kind == LightKind::Spot
                                      ? std::clamp((to.z / d - std::cos(0.7f)) * scale, 0.0f, 1.0f)
                                      : 1;
                    const float radiance = 0.6f / pi * 3 * share * share * to.z / (d * d * d);
                    const glm::vec3 across = q - p;
                    const float r2 = glm::dot(across, across);
                    sum += double{radiance * across.x * (p.z - q.z) / (pi * r2 * r2)} * (4.0 / (n * n));
                }
            const auto expected = static_cast<float>(sum);
            // The image's right is -y or y by the camera's handedness: the scene is nearly, not quite, alike.
            const glm::vec3 right(glm::inverse(camera.view)[0]);
            ASSERT_NEAR(std::abs(right.y), 1, 1e-5f);
            const int x = right.y > 0 ? pixel.x : 63 - pixel.x;
            EXPECT_NEAR(image.at(x, pixel.y), expected, 0.03f * expected)
                << static_cast<int>(kind) << " at " << pixel.x << ", " << pixel.y;
        }
    }
}

TEST_F(Rsm, AStaticSceneIsMappedOnceUnlessJittered) {
    RenderOptions options;
    options.timing = true;
    const Scene scene = litScene(square(), {{spot(), {0.2f, 0.1f, 1}, {0, 0, -1}}});
    auto still = lit(probeGraph(rsm), scene, options);
    EXPECT_FALSE(still.frame().samples.empty());
    EXPECT_TRUE(still.frame().samples.empty());
    const std::string jittered = R"("source": {"type": "ReflectiveShadowMap",
        "properties": {"resolution": 64, "jitter": true, "position_jitter": 0.01}})";
    auto moving = lit(probeGraph(jittered), scene, options);
    moving.frame();
    const Image first = moving.read({"probe", "result"});
    EXPECT_FALSE(moving.frame().samples.empty());
    EXPECT_GT(difference(first, moving.read({"probe", "result"})).largest, 0);
    EXPECT_EQ(difference(first, picture(probeGraph(jittered), scene)).largest, 0)
        << "the same frame is the same again";
}

// Steps of single texels average out: a coarse jittered map comes near a fine one.
TEST_F(Rsm, JitterAveragesTexelsOut) {
    const Scene scene = litScene(square(), {{spot(), {0.2f, 0.1f, 1}, {0, 0, -1}}});
    const Image fine = picture(probeGraph(rsm), scene);
    const auto coarse = [&](const char* jitter, int frames) {
        auto made = lit(probeGraph(fmt::format(R"("source": {{"type": "ReflectiveShadowMap",
            "properties": {{"resolution": 32, "jitter": {}}}}})",
                                               jitter)),
                        scene);
        Image mean(64, 64, 4);
        for (int i = 0; i < frames; ++i) {
            made.frame();
            const Image one = made.read({"probe", "result"});
            for (size_t k = 0; k < mean.values.size(); ++k)
                mean.values[k] += one.values[k] / static_cast<float>(frames);
        }
        return mean;
    };
    EXPECT_LT(difference(fine, coarse("true", 16)).rms, 0.5 * difference(fine, coarse("false", 1)).rms);
}

TEST_F(Rsm, LightsOfTwoKindsAllCount) {
    std::vector<PlacedLight> lights;
    for (int i = 0; i < 5; ++i)
        lights.push_back({spot(static_cast<float>(i + 1)), {0.1f * static_cast<float>(i), 0, 1}, {0, 0, -1}});
    lights.push_back({lightOf(LightKind::Point, 2), {0, 0.3f, 1}, {0, 0, -1}});
    Image sum(64, 64, 4);
    for (const PlacedLight& light : lights) {
        const Image one = picture(probeGraph(rsm), litScene(square(), {light}));
        for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += one.values[i];
    }
    const Image all = picture(probeGraph(rsm), litScene(square(), lights));
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) ASSERT_NEAR(all.at(x, y), sum.at(x, y), 1e-5f) << x << ", " << y;
}

TEST_F(Rsm, WithoutALightThatIsMappedItIsBlackAndLeftOut) {
    for (const auto& lights :
         {std::vector<PlacedLight>{},
          std::vector<PlacedLight>{{lightOf(LightKind::Directional, 1), {0, 0, 1}, {0, 0, -1}}}}) {
        Graph graph = probeGraph(rsm);
        applySetting(graph, withProbe(), "source.directional=false");
        auto made = lit(graph, litScene(square(), lights));
        made.frame();
        EXPECT_TRUE(leavesOut(made.plan(), "maps: the scene has no light that is mapped"));
        for (const PlanStep& step : made.plan().steps) EXPECT_NE(step.step.name, "draw");
        EXPECT_EQ(made.read({"probe", "result"}).at(32, 32), 0);
    }
}

TEST_F(Rsm, MapsBeyondTheMemoryAreMadeSmallerAndTheNeedAndTheLimitAreTold) {
    const std::vector<PlacedLight> lights(33, {lightOf(LightKind::Point, 1), {0, 0, 1}, {0, 0, -1}});
    // 198 maps of 28 bytes a texel: the sides that 1 GiB leaves are 440 texels, of whole sixteens 432.
    const auto made =
        lit(probeGraph(R"("source": {"type": "ReflectiveShadowMap", "properties": {"resolution": 512}})"),
            litScene(square(), lights));
    EXPECT_TRUE(leavesOut(made.plan(),
                          "map resolution: 198 maps of 512 x 512 texels need 1.354 GiB; the limit "
                          "is 1 GiB: they are made of 432 x 432"));
}

// Lights at several places whose sum is known: all of them count where there are 34 or 64, the strongest
// where there are more.
TEST_F(Rsm, LightsAreCountedOneByOneAndTheWeakestAreLeftOut) {
    const std::string source =
        R"("source": {"type": "ReflectiveShadowMap", "properties": {"resolution": 16, "directional": true}})";
    const auto sum = [&](std::uint32_t points, std::uint32_t weak, bool sun) {
        std::vector<PlacedLight> lights(points, {lightOf(LightKind::Point, 1), {0, 0, 1}, {0, 0, -1}});
        for (std::uint32_t i = 0; i < weak; ++i)
            lights.insert(lights.begin(), {lightOf(LightKind::Point, 1e-3f), {0, 0, 1}, {0, 0, -1}});
        if (sun) lights.push_back({lightOf(LightKind::Directional, 5), {0, 0, 1}, {0, 0, -1}});
        auto made = lit(probeGraph(source), litScene(square(), lights));
        made.frame();
        const bool left =
            leavesOut(made.plan(), fmt::format("weak lights: the scene has {} lights; the limit is "
                                               "64: the {} weakest do not shine",
                                               lights.size(), lights.size() - 64));
        EXPECT_EQ(left, lights.size() > 64) << lights.size();
        return made.read({"probe", "result"}).at(32, 32);
    };
    const float one = sum(1, 0, false), day = sum(0, 0, true);
    ASSERT_GT(one, 0);
    ASSERT_GT(day, 0);
    // Each is rounded to a half float.
    EXPECT_NEAR(sum(33, 0, true), 33 * one + day, 1e-3f * 33 * one);
    EXPECT_NEAR(sum(63, 0, true), 63 * one + day, 1e-3f * 63 * one);
    EXPECT_NEAR(sum(63, 20, true), 63 * one + day, 1e-3f * 63 * one);
    EXPECT_NEAR(sum(90, 0, true), 63 * one + day, 1e-3f * 63 * one);
}

TEST_F(Rsm, ScaleAndStrengthStayFinite) {
    RenderOptions options;
    options.checkFinite = true;
    std::vector<glm::vec3> corners = quad({0, 0, -0.5f}, {1, 0, 0}, {0, 1, 0});
    corners = join(corners, quad({-1, 0, 0}, {0, 1, 0}, {0, 0, 0.5f}));
    const Graph graph = graphOf(
        R"("g": {"type": "GBuffer"}, "rsm": {"type": "ReflectiveShadowMap"}, "gather": {"type": "RsmGather"},
           "probe": {"type": "RadianceProbe"})",
        R"(["g.depth", "gather.depth"], ["g.normal", "gather.normal"], ["rsm.maps", "gather.maps"],
           ["rsm.map_radiance", "gather.map_radiance"], ["rsm.map_normal", "gather.map_normal"],
           ["rsm.map_position", "gather.map_position"], ["g.depth", "probe.depth"], ["g.normal", "probe.normal"],
           ["g.albedo", "probe.albedo"], ["rsm.radiance", "probe.radiance"])",
        R"("gather.result", "probe.result")");
    Image usual;
    for (const float scale : {1.0f, 1e-4f, 1e4f}) {
        Scene scene = litScene(corners, {{spot(), {0.1f, 0.1f, 0.45f}, {0, 0, -1}}}, glm::vec3(0.6f),
                               glm::scale(glm::dmat4(1), glm::dvec3(double{scale})));
        auto made = lit(graph, scene, options, scale);
        made.frame();
        const Image image = made.read({"gather", "result"});
        if (scale == 1.0f) usual = image;
        EXPECT_LE(difference(usual, image).rms, 0.01) << scale;
    }
    for (const float intensity : {0.0f, 1e9f})
        for (const LightKind kind : {LightKind::Point, LightKind::Spot}) {
            Light light = lightOf(kind, intensity);
            light.outerCone = 1.5707f;
            for (const glm::vec3 at :
                 {glm::vec3(0.1f, 0.1f, 0.45f), glm::vec3(0, 0, -0.5f), glm::vec3(-1, 0, -0.5f)}) {
                auto made = lit(graph, litScene(corners, {{light, at, {0, 0, -1}}}), options);
                made.frame();
            }
        }
    auto empty = lit(graph, litScene({}, {{spot(), {0, 0, 1}, {0, 0, -1}}}), options);
    empty.frame();
    auto dark = lit(graph, litScene(square(), {}), options);
    dark.frame();
    const Image none = dark.read({"gather", "result"});
    for (int y = 0; y < none.height; ++y)
        for (int x = 0; x < none.width; ++x)
            ASSERT_EQ(glm::vec4(pixelColour(none, x, y), none.at(x, y, 3)), glm::vec4(0, 0, 0, 1));
}

} // namespace
} // namespace kestrel::test
