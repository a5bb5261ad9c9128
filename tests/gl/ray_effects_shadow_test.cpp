// Soft shadows and glossy reflections: analytic truth, then the reference ray tracer, then extremes.
#include "ray_effects_fixture.h"

namespace kestrel::test {
namespace {

using Settings = std::vector<std::string>;
const PortRef where{"gbuffer", "position"}, covered{"gbuffer", "coverage"};

// Lambert's formula: irradiance over pi at `p` with normal n from a polygon of unit radiance wholly above the
// horizon.
double polygonFactor(const std::vector<glm::dvec3>& corners, const glm::dvec3& p, const glm::dvec3& n) {
    double sum = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - p),
                         b = glm::normalize(corners[(i + 1) % corners.size()] - p);
        sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(glm::cross(a, b)), n);
    }
    return std::abs(sum) / (2 * glm::pi<double>());
}

// A floor at y = 0 with a light above; render space counts from the floor's middle.
Scene litFloor(const Light& light, double height, const std::vector<glm::vec3>& more = {}, double scale = 1) {
    Scene scene = trianglesScene(joined(parallelogram({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}), more));
    addLightTo(scene, light, {0, height, 0}, downwards);
    scene.rootTransform = glm::scale(glm::dmat4(1), glm::dvec3(scale));
    finishScene(scene);
    return scene;
}

struct Shadow : EffectsTest {
    static Light panel(float x, float y, float radiance = 3) {
        Light light;
        light.kind = LightKind::Rectangle;
        light.halfSize = {x, y};
        light.intensity = radiance;
        return light;
    }
    static CameraState above(float scale = 1) {
        return lookingAt(scale * glm::vec3(0, 6, 0), {0, 0, 0}, {0, 0, -1});
    }
    // The mean over pixels of the relative difference to `expected(position)`, and the largest.
    static std::pair<double, double> relativeError(const Image& light, const Image& position,
                                                   const std::function<double(const glm::dvec3&)>& expected) {
        double sum = 0, largest = 0, count = 0;
        for (int y = 0; y < light.height; ++y)
            for (int x = 0; x < light.width; ++x) {
                if (position.at(x, y, 3) == 0) continue;
                const glm::dvec3 p(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2));
                const double truth = expected(p);
                const double error = std::abs(double{light.at(x, y, 0)} / truth - 1);
                sum += error;
                largest = std::max(largest, error);
                ++count;
            }
        EXPECT_GT(count, 100);
        return {sum / count, largest};
    }
};

TEST_F(Shadow, ARectangleOverAPlaneHasLambertsFormFactorAtAnyScale) {
    for (const double scale : {1e-4, 1.0, 1e4}) {
        const Scene scene = litFloor(panel(0.5f, 0.3f), 1, {}, scale);
        const auto images = run(effectsGraph({shadowed, openness, where}), scene, {shadowed, openness, where},
                                8, above(static_cast<float>(scale)));
        std::vector<glm::dvec3> corners;
        for (const glm::dvec2& s : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
            corners.push_back(scale * glm::dvec3(0.5 * s.x, 1, 0.3 * s.y));
        const auto [mean, largest] = relativeError(images[0], images[2], [&](const glm::dvec3& p) {
            return 3 * polygonFactor(corners, p, {0, 1, 0});
        });
        EXPECT_LE(mean, 0.004) << scale; // 128 stratified points
        EXPECT_LE(largest, 0.04) << scale;
        for (const float v : images[1].values) ASSERT_EQ(v, 1.0f); // nothing is in the way
    }
}

TEST_F(Shadow, ASphereLightFallsWithTheSquareOfTheDistance) {
    for (const float radius : {0.001f, 0.2f, 0.9f}) {
        Light lamp;
        lamp.kind = LightKind::Sphere;
        lamp.halfSize.x = radius;
        lamp.intensity = 2;
        const auto images =
            run(effectsGraph({shadowed, where}), litFloor(lamp, 1), {shadowed, where}, 8, above());
        const auto [mean, largest] = relativeError(images[0], images[1], [&](const glm::dvec3& p) {
            // A sphere of 0.9 is above the horizon of points within 2.06: all of the floor but its corners,
            // where the formula is not meant to hold.
            const double d2 = glm::dot(glm::dvec3(0, 1, 0) - p, glm::dvec3(0, 1, 0) - p);
            return 2 * double{radius} * double{radius} / d2 / std::sqrt(d2);
        });
        EXPECT_LE(mean, radius < 0.5f ? 0.004 : 0.05) << radius;
        EXPECT_LE(largest, radius < 0.5f ? 0.03 : 1) << radius;
    }
}

TEST_F(Shadow, AnEmissiveMeshShinesAsTheLightInItsPlace) {
    const Light light = panel(0.5f, 0.5f, 2);
    const Image byLight = run(effectsGraph({shadowed}), litFloor(light, 1), {shadowed}, 16, above())[0];
    Scene glowing = litFloor(light, 1, parallelogram({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}));
    // Its own primitive, so that only it glows.
    Primitive panelPart = glowing.meshes[0].primitives[0];
    panelPart.indices.erase(panelPart.indices.begin(), panelPart.indices.begin() + 6);
    panelPart.material = 1;
    glowing.meshes[0].primitives[0].indices.resize(6);
    glowing.meshes[0].primitives.push_back(panelPart);
    glowing.materials.push_back(glowing.materials[0]);
    glowing.materials[1].emission = glm::vec3(2);
    finishScene(glowing);
    const CameraState below = lookingAt({0, 0.9f - 0.5f, 3}, {0, -0.5f, 0}); // under the panel
    // Render space counts from the middle of floor and panel, half a unit up.
    const Scene plain = litFloor(light, 1, parallelogram({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}));
    const auto both = run(effectsGraph({shadowed, covered}), glowing, {shadowed, covered}, 16, below);
    const Image one = run(effectsGraph({shadowed}), plain, {shadowed}, 16, below)[0];
    // The panel shows where the light is and is no second one.
    EXPECT_LE(colourError(both[0], one, both[1]), 1e-6);
    Scene without = glowing;
    without.lights.clear();
    without.nodes.pop_back();
    without.roots.pop_back();
    finishScene(without);
    EXPECT_LE(colourError(run(effectsGraph({shadowed}), without, {shadowed}, 16, below)[0], one, both[1]),
              0.01);
    // Switched off nothing shines, and the pass says why.
    const Renderer made = renderer(effectsGraph({{"shadow", "result"}}, {"shadow.emission=false"}), without);
    std::string all;
    for (const LeftOut& left : made.plan().leftOut) all += left.what + ": " + left.why + "\n";
    EXPECT_NE(all.find("no area light, and emission is off"), std::string::npos) << all;
}

TEST_F(Shadow, ThePenumbraGrowsWithTheDistanceOfTheOccluder) {
    const auto width = [&](float height) {
        // A half plane whose edge runs along z at x = 0.
        const Scene scene =
            litFloor(panel(0.4f, 0.01f), 4, parallelogram({-2, height, -2}, {0, 0, 4}, {2, 0, 0}));
        const glm::vec3 middle(0, 0.5f * height, 0);
        const auto images = run(effectsGraph({openness, where}), scene, {openness, where}, 16,
                                lookingAt(glm::vec3(0, 0.04f, 0) - middle, -middle, {0, 0, -1}), {160, 9, 1});
        double low = 1e9, high = -1e9;
        for (int x = 0; x < 160; ++x) {
            const float v = images[0].at(x, 4);
            if (v <= 0.02f || v >= 0.98f) continue;
            low = std::min(low, double{images[1].at(x, 4, 0)});
            high = std::max(high, double{images[1].at(x, 4, 0)});
        }
        return high - low;
    };
    // The light's width times the edge's height over the way from edge to light; ends of 2 % are cut off.
    for (const float height : {0.5f, 1.0f})
        EXPECT_NEAR(width(height), 0.96 * 0.8 * height / (4 - height), 0.02);
}

TEST_F(Shadow, ConvergesToEmbree) {
    if (!hasReferences()) GTEST_SKIP() << "Embree is not built in";
    const Scene scene = loadScene("builtin:cornell");
    const auto truth =
        run(embreeGraph({{"shadow", "result"}, {"shadow", "visibility"}, covered}, {"shadow.samples=4096"}),
            scene, {{"shadow", "result"}, {"shadow", "visibility"}, covered}, 1);
    const auto at = [&](int frames, const Settings& settings = {}) {
        return run(effectsGraph({shadowed, openness}, settings), scene, {shadowed, openness}, frames);
    };
    const auto few = at(1, {"shadow.rays=4"}), some = at(4, {"shadow.rays=4"}),
               many = at(16, {"shadow.rays=4"});
    const double first = colourError(truth[0], few[0], truth[2]),
                 second = colourError(truth[0], some[0], truth[2]),
                 third = colourError(truth[0], many[0], truth[2]);
    // Independent samples halve the error for four times as many; stratified ones do at least nearly that.
    EXPECT_LE(second, 0.6 * first);
    EXPECT_LE(third, 0.6 * second);
    EXPECT_LE(third, 0.08);
    // The same rays in one step and in several frames.
    EXPECT_LE(difference(at(1, {"shadow.rays=64"})[0], many[0]).largest, 1e-4);
    // Through voxels: the lamp does not shadow itself, and what is lit stays so.
    const auto roma = at(16, {"shadow.tracer=roma.tracer", "roma.iterations=64", "bom.resolution=128"});
    EXPECT_NEAR(meanWhere(roma[1], truth[2]), meanWhere(truth[1], truth[2]), 0.06);
    EXPECT_LE(colourError(truth[0], roma[0], truth[2]), 0.35);
}

struct Gloss : EffectsTest {
    static Scene plane(float roughness, float metallic) {
        Scene scene = trianglesScene(square());
        scene.materials[0].roughness = roughness;
        scene.materials[0].metallic = metallic;
        return scene;
    }
};

TEST_F(Gloss, TheWhiteFurnaceIsNeverBrighterThanWhite) {
    const Settings sky = {"sky.colour=[1,1,1]", "glossy.radiance=sky.radiance"};
    for (const float degrees : {0.0f, 60.0f, 85.0f}) {
        const glm::vec3 eye(3 * std::sin(glm::radians(degrees)), 0, 3 * std::cos(glm::radians(degrees)));
        for (const float roughness : {0.0f, 0.3f, 1.0f}) {
            const auto images = run(effectsGraph({shine, covered}, sky), plane(roughness, 1),
                                    {shine, covered}, 4, lookingAt(eye, {0, 0, 0}));
            for (const float value : images[0].values) ASSERT_TRUE(value >= 0 && value <= 1.00001f) << value;
            const double mean = meanWhere(images[0], images[1]);
            if (roughness == 0.0f) {
                EXPECT_NEAR(mean, 1, 1e-3);
            }
            EXPECT_GT(mean, 0.3); // the roughest, seen along the plane, lose two thirds
        }
        // A dielectric reflects by Schlick's term alone.
        const auto glass = run(effectsGraph({shine, covered}, sky), plane(0, 0), {shine, covered}, 1,
                               lookingAt(eye, {0, 0, 0}));
        const double m = 1 - std::cos(glm::radians(double{degrees}));
        if (degrees < 80) {
            EXPECT_NEAR(glass[0].at(24, 13, 0), 0.04 + 0.96 * std::pow(m, 5), 0.006);
        }
    }
}

TEST_F(Gloss, AMirrorShowsTheOtherSide) {
    // A mirror at z = 0 (in render space -2, which counts from the middle), and behind the eye a wall that
    // glows red on the left and green on the right.
    std::vector<glm::vec3> corners = square();
    corners = joined(corners, parallelogram({-9, -9, 4}, {9, 0, 0}, {0, 18, 0}));
    corners = joined(corners, parallelogram({0, -9, 4}, {9, 0, 0}, {0, 18, 0}));
    Scene scene = trianglesScene(corners);
    const Primitive mirror = scene.meshes[0].primitives[0];
    scene.materials[0].roughness = 0;
    scene.materials[0].metallic = 1;
    for (const int side : {0, 1}) {
        Primitive wall = mirror;
        wall.indices.assign(mirror.indices.begin() + 6 + 6 * side, mirror.indices.begin() + 12 + 6 * side);
        wall.material = 1 + side;
        scene.meshes[0].primitives.push_back(wall);
        scene.materials.push_back(scene.materials[0]);
        scene.materials.back().emission = side == 0 ? glm::vec3(2, 0, 0) : glm::vec3(0, 2, 0);
    }
    scene.meshes[0].primitives[0].indices.resize(6);
    finishScene(scene);
    const auto images = run(effectsGraph({shine}), scene, {shine}, 1, lookingAt({0, 0, -1}, {0, 0, -4}));
    for (int y = 5; y < 22; ++y) {
        EXPECT_NEAR(images[0].at(10, y, 0), 2, 1e-2);
        EXPECT_EQ(images[0].at(10, y, 1), 0);
        EXPECT_NEAR(images[0].at(37, y, 1), 2, 1e-2);
    }
}

TEST_F(Gloss, ConvergesToEmbree) {
    if (!hasReferences()) GTEST_SKIP() << "Embree is not built in";
    const Scene scene = loadScene("builtin:hall?detail=0.1");
    const auto truth = run(embreeGraph({{"glossy", "result"}, covered}, {"glossy.samples=1024"}), scene,
                           {{"glossy", "result"}, covered}, 1);
    const Settings settings = {"direct.resolution=1024"};
    const Image few = run(effectsGraph({shine}, settings), scene, {shine}, 1)[0];
    const Image many = run(effectsGraph({shine}, settings), scene, {shine}, 16)[0];
    EXPECT_LE(colourError(truth[0], many, truth[1]), 0.6 * colourError(truth[0], few, truth[1]));
    EXPECT_NEAR(meanWhere(many, truth[1]) / meanWhere(truth[0], truth[1]), 1, 0.1);
}

TEST_F(Gloss, RoughSurfacesAreNotTracedAboveTheLimit) {
    const Settings sky = {"sky.colour=[1,1,1]", "glossy.radiance=sky.radiance", "glossy.max_roughness=0.5"};
    const CameraState camera = lookingAt({0, 0, 3}, {0, 0, 0});
    const auto rough = run(effectsGraph({shine, covered}, sky), plane(0.6f, 1), {shine, covered}, 1, camera);
    EXPECT_EQ(meanWhere(rough[0], rough[1]), 0);
    EXPECT_GT(meanWhere(run(effectsGraph({shine}, sky), plane(0.4f, 1), {shine}, 1, camera)[0], rough[1]),
              0.9);
}

// Scenes that are empty, dark, tiny and huge, and frames of a pixel and of a line.
struct EffectExtremes : EffectsTest {
    struct Extreme {
        Scene scene;
        Extent size{16, 9, 1};
    };
    static std::vector<Extreme> extremes() {
        std::vector<Extreme> all;
        all.push_back({trianglesScene({})});
        all.push_back({trianglesScene({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.5f}})});
        all.push_back({trianglesScene({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}})});
        all.push_back({loadScene("builtin:cornell"), {1, 1, 1}});
        all.push_back({loadScene("builtin:cornell"), {7, 1, 1}});
        for (const double scale : {1e-4, 1e4})
            all.push_back({transformed("builtin:cornell", glm::scale(glm::dmat4(1), glm::dvec3(scale)))});
        return all;
    }
    static void expectSound(const Graph& graph, const Extreme& extreme, const std::vector<PortRef>& ports,
                            int frames) {
        for (const Image& image : run(graph, extreme.scene, ports, frames, {}, extreme.size))
            for (const float value : image.values) ASSERT_GE(value, 0) << extreme.scene.source;
    }
};

TEST_F(EffectExtremes, EffectsAreSound) {
    const std::vector<PortRef> ports = {bounce, shadowed, openness, shine};
    for (const Extreme& extreme : extremes())
        for (const Settings& settings :
             {Settings{}, Settings{"indirect.tracer=roma.tracer", "indirect.radiance=rsm.radiance",
                                   "shadow.tracer=roma.tracer", "glossy.tracer=roma.tracer",
                                   "glossy.radiance=sky.radiance"}})
            expectSound(effectsGraph(ports, settings), extreme, ports, 2);
}

TEST_F(EffectExtremes, ReferencesAreSound) {
    if (!hasReferences()) GTEST_SKIP() << "Embree is not built in";
    const std::vector<PortRef> ports = {{"indirect", "result"}, {"shadow", "result"}, {"glossy", "result"}};
    for (const Extreme& extreme : extremes())
        expectSound(embreeGraph(ports, {"indirect.samples=2", "shadow.samples=2", "glossy.samples=2"}),
                    extreme, ports, 1);
}

TEST_F(EffectExtremes, AScaledSceneIsLitAlike) {
    const std::vector<PortRef> ports = {bounce, shadowed, shine};
    const auto usual = run(effectsGraph(ports), loadScene("builtin:cornell"), ports, 2);
    for (const double scale : {1e-4, 1e4}) {
        const auto scaled =
            run(effectsGraph(ports),
                transformed("builtin:cornell", glm::scale(glm::dmat4(1), glm::dvec3(scale))), ports, 2);
        // Single samples flip at edges.
        for (size_t i = 0; i < ports.size(); ++i)
            EXPECT_LE(difference(usual[i], scaled[i]).rms, 0.05) << i << " " << scale;
    }
}

TEST_F(EffectExtremes, WithoutAreaLightsThePassIsLeftOut) {
    const Renderer made =
        renderer(effectsGraph({{"shadow", "result"}}), loadScene("builtin:hall?detail=0.05"));
    std::string all;
    for (const LeftOut& left : made.plan().leftOut) all += left.what + ": " + left.why + "\n";
    EXPECT_NE(all.find("the scene has no area light and no material emits light"), std::string::npos) << all;
    for (const PlanPass& pass : made.plan().passes) EXPECT_NE(pass.type, "Bvh");
}

TEST_F(EffectExtremes, MoreEmissiveTrianglesThanExpectedGrowTheList) {
    Scene scene = trianglesScene(joined(ball(0.3f, 24), parallelogram({-2, -1, -2}, {0, 0, 4}, {4, 0, 0})));
    scene.materials[0].emission = glm::vec3(1);
    ASSERT_GT(flatten(scene, 0).triangleCount(), 1024u);
    const auto images = run(effectsGraph({shadowed, covered}), scene, {shadowed, covered}, 2);
    EXPECT_GT(meanWhere(images[0], images[1]), 0);
}

} // namespace
} // namespace kestrel::test
