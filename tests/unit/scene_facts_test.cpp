// Facts and bounds over the timeline, and what finishScene() completes.
#include "scene/builtin.h"
#include "scene/facts.h"
#include "scene/geometry.h"
#include "scene/timeline_bounds.h"
#include "support/assets.h"
#include <cmath>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

Primitive box(float size) {
    Primitive primitive;
    for (int i = 0; i < 8; ++i)
        primitive.positions.emplace_back(i & 1 ? size : -size, i & 2 ? size : -size, i & 4 ? size : -size);
    primitive.normals.assign(8, {0, 0, 1});
    primitive.indices = {0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7, 0, 4, 2, 1, 5, 3};
    return primitive;
}

Scene boxScene() {
    Scene scene;
    scene.meshes = {{"", {box(1)}, {}}};
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    scene.roots = {0};
    return scene;
}

// Every vertex of every frame lies in the stated box and sphere. How much of the box is needed at least: the
// smallest ratio over the axes.
float expectBoundsHold(const Scene& scene, int frames) {
    const SceneFacts facts = gatherFacts(scene);
    Flattener flattener(scene);
    Box all;
    for (int i = 0; i <= frames; ++i) {
        const Geometry& geometry = flattener.at(facts.duration * i / std::max(frames, 1));
        for (const glm::vec3& position : geometry.positions) {
            all.add(position);
            const double distance = glm::length(glm::dvec3(position) - glm::dvec3(facts.sphere.centre));
            if (distance > double(facts.sphere.radius)) {
                ADD_FAILURE() << "frame " << i << ": " << distance << " from the centre of a sphere of "
                              << facts.sphere.radius;
                return 0;
            }
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(facts.bounds.min[axis], all.min[axis]) << "axis " << axis;
        EXPECT_GE(facts.bounds.max[axis], all.max[axis]) << "axis " << axis;
    }
    float tightness = 1;
    for (int axis = 0; axis < 3; ++axis)
        if (facts.bounds.size()[axis] > 0)
            tightness = std::min(tightness, all.size()[axis] / facts.bounds.size()[axis]);
    return tightness;
}

TEST(Bounds, AreExactForWhatStandsStill) {
    Scene scene = boxScene();
    scene.nodes[0].rotation = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3)));
    finishScene(scene);
    EXPECT_GT(expectBoundsHold(scene, 0), 1 - 1e-6f);
}

TEST(Bounds, AreExactForLinearMotionAndHoldForTurning) {
    Scene scene = boxScene();
    const float half = std::sqrt(0.5f);
    scene.animations = {
        {"", {{0, AnimatedPath::Translation, Interpolation::Linear, {0, 1}, {0, 0, 0, 7, 0, 0}}}}};
    finishScene(scene);
    EXPECT_GT(expectBoundsHold(scene, 1000), 1 - 1e-6f);
    // A quarter turn about z: the corners bulge out to the square root of 2 between the keys.
    scene.animations = {
        {"", {{0, AnimatedPath::Rotation, Interpolation::Linear, {0, 1}, {0, 0, 0, 1, 0, 0, half, half}}}}};
    finishScene(scene);
    EXPECT_GT(expectBoundsHold(scene, 1000), 0.98f);
    EXPECT_GE(gatherFacts(scene).bounds.max.x, std::sqrt(2.0f));
}

TEST(Bounds, HoldForStepsAndOvershootingCurves) {
    Scene scene = boxScene();
    scene.animations = {
        {"",
         {{0, AnimatedPath::Translation, Interpolation::Step, {0, 1, 2}, {0, 0, 0, 90, 0, 0, 0, 50, 0}}}}};
    finishScene(scene);
    EXPECT_GT(expectBoundsHold(scene, 1000), 1 - 1e-6f) << "a jump passes nothing on its way";
    scene.animations = {{"",
                         {{0,
                           AnimatedPath::Translation,
                           Interpolation::CubicSpline,
                           {0, 0.5f},
                           {0, 0, 0, 0, 0, 0, 900, -300, 40, 500, 0, 0, 1, 1, 1, 0, 0, 0}}}}};
    finishScene(scene);
    EXPECT_GT(expectBoundsHold(scene, 1000), 0.7f);
}

TEST(Bounds, HoldForTurnsWithinTurns) {
    Scene scene = boxScene();
    scene.nodes.resize(3);
    scene.nodes[0].parent = 1;
    scene.nodes[0].translation = {4, 0, 0};
    scene.nodes[1].children = {0};
    scene.nodes[1].parent = 2;
    scene.nodes[1].translation = {0, 3, 0};
    scene.nodes[2].children = {1};
    scene.roots = {2};
    for (int node = 0; node < 3; ++node) {
        AnimationChannel turn{node, AnimatedPath::Rotation, Interpolation::Linear, {}, {}};
        for (int key = 0; key <= 4; ++key) {
            const float angle = float(key) * (1.3f + float(node)) / 2;
            turn.times.push_back(float(key) * (node == 1 ? 0.7f : 1.0f));
            turn.values.insert(turn.values.end(), {0, node == 1 ? std::sin(angle) : 0,
                                                   node == 1 ? 0 : std::sin(angle), std::cos(angle)});
        }
        scene.animations.push_back({"", {turn}});
    }
    finishScene(scene);
    EXPECT_GT(expectBoundsHold(scene, 5000), 0.9f);
}

// More vertices times keys than are sampled: boxes stand for the vertices, even samples for the keys.
TEST(Bounds, HoldWhereBoxesStandForVertices) {
    for (const int keys : {80, 3000}) {
        Scene scene = boxScene();
        Primitive& primitive = scene.meshes[0].primitives[0];
        primitive.joints.assign(8, {0, 1, 0, 0});
        primitive.weights.assign(8, {1, 0, 0, 0});
        primitive.targets.resize(1);
        primitive.targets[0].positions.assign(8, {0, 0.5f, 0});
        for (int i = 0; i < 20000; ++i) {
            const float angle = float(i) * 0.37f, part = float(i % 11) / 10;
            primitive.positions.emplace_back(std::cos(angle), std::sin(angle), 3 * part);
            primitive.normals.emplace_back(0, 0, 1);
            primitive.joints.emplace_back(0, 1, 0, 0);
            primitive.weights.emplace_back(1 - part, part, 0, 0);
            primitive.targets[0].positions.emplace_back(0, part, 0);
            const std::uint32_t vertex = static_cast<std::uint32_t>(8 + i);
            primitive.indices.insert(primitive.indices.end(), {vertex, vertex, vertex});
        }
        scene.nodes.resize(keys > 1000 ? 2000 : 4); // with so many nodes, not every key is taken
        scene.nodes[3].mesh = 0;                    // the same without a skin
        scene.nodes[0].skin = 0;
        scene.skins = {{"", {1, 2}, {glm::mat4(1), glm::mat4(1)}}};
        scene.roots = {0, 1, 2, 3};
        AnimationChannel swing{2, AnimatedPath::Rotation, Interpolation::Linear, {}, {}};
        for (int key = 0; key < keys; ++key) {
            const float angle = 0.5f * std::sin(0.05f * float(key));
            swing.times.push_back(float(key) / 30);
            swing.values.insert(swing.values.end(), {std::sin(angle), 0, 0, std::cos(angle)});
        }
        AnimationChannel carried = swing;
        carried.node = 3;
        AnimationChannel swell{
            0, AnimatedPath::Weights, Interpolation::CubicSpline, {0, 1}, {0, 0, 4, -4, 1, 0}};
        scene.animations = {{"", {swing, carried, swell}}};
        finishScene(scene);
        EXPECT_GT(expectBoundsHold(scene, 40), 0.3f) << keys << " keys";
    }
}

TEST(Bounds, ScaleWithTheScene) {
    for (const double scale : {1e-4, 1.0, 1e4}) {
        Scene scene = loadScene("builtin:tower?detail=0.02");
        const SceneFacts before = gatherFacts(scene);
        scene.rootTransform = glm::dmat4(scale);
        scene.rootTransform[3] = {1e4 * scale * double(before.sphere.radius), 0, 0, 1};
        finishScene(scene);
        const SceneFacts facts = gatherFacts(scene);
        EXPECT_NEAR(facts.sphere.radius / float(scale), before.sphere.radius, 1e-5f * before.sphere.radius);
        expectBoundsHold(scene, 0);
    }
}

class BuiltinBounds : public testing::TestWithParam<std::string> {};

TEST_P(BuiltinBounds, HoldAtEveryFrame) {
    const Scene scene = loadScene("builtin:" + GetParam() + "?detail=0.05");
    EXPECT_GT(expectBoundsHold(scene, scene.duration() > 0 ? 400 : 0), 0.7f);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BuiltinBounds, testing::ValuesIn(builtinNames()),
                         [](const auto& instance) { return instance.param; });

TEST(Bounds, HoldForRealScenesAtEveryFrame) {
    const std::filesystem::path assets = test::assetsFolder();
    if (assets.empty()) GTEST_SKIP() << "no folder of real scenes";
    for (const std::filesystem::path& file : test::gltfFilesBelow(assets)) {
        SCOPED_TRACE(file.string());
        const Scene scene = loadScene(file.string());
        EXPECT_GT(expectBoundsHold(scene, scene.duration() > 0 ? 500 : 0), 0.8f);
    }
}

TEST(Facts, CountWhatTheSceneHas) {
    Scene scene = boxScene();
    Material foliage;
    foliage.alphaMode = AlphaMode::Mask;
    foliage.doubleSided = true;
    foliage.normalTexture.image = 0;
    Material unused;
    unused.transmission = 1;
    unused.alphaMode = AlphaMode::Blend;
    scene.images = {{"", 1, 1, {1, 2, 3, 4}}};
    scene.materials = {foliage, unused};
    Primitive leaf = box(0.1f);
    leaf.material = 0;
    leaf.colours.assign(8, glm::vec4(1));
    scene.meshes[0].primitives.push_back(leaf);
    scene.nodes.resize(3);
    scene.nodes[1].mesh = 0;
    scene.roots = {0, 1};
    scene.lights = {{.name = {}, .kind = LightKind::Spot, .node = 2},
                    {.name = {}, .kind = LightKind::Sphere, .node = 0}};
    finishScene(scene);
    const SceneFacts facts = gatherFacts(scene);
    EXPECT_EQ(facts.triangles, 24u);
    EXPECT_EQ(facts.vertices, 32u);
    EXPECT_EQ(facts.instances, 4u);
    EXPECT_EQ(facts.materials, 2u);
    EXPECT_EQ(facts.images, 1u);
    EXPECT_EQ(facts.maskedTriangles, 12u);
    EXPECT_TRUE(facts.hasMasked);
    EXPECT_FALSE(facts.hasBlend) << "no triangle uses it";
    EXPECT_FALSE(facts.hasTransmission);
    EXPECT_TRUE(facts.hasDoubleSided);
    EXPECT_TRUE(facts.hasSingleSided);
    EXPECT_TRUE(facts.hasTextures);
    EXPECT_TRUE(facts.hasNormalMaps);
    EXPECT_TRUE(facts.hasVertexColours);
    EXPECT_FALSE(facts.hasEmission);
    EXPECT_EQ(facts.spotLights, 1u);
    EXPECT_EQ(facts.sphereLights, 1u);
    EXPECT_EQ(facts.lights(), 2u);
    EXPECT_FALSE(facts.geometryMoves || facts.cameraMoves || facts.lightsMove || facts.geometryDeforms);
    EXPECT_EQ(facts.duration, 0);
}

TEST(Facts, TellWhatMoves) {
    const auto factsWith = [](int node, AnimatedPath path, std::vector<float> values) {
        Scene scene = boxScene();
        scene.meshes[0].primitives[0].targets.resize(1);
        scene.meshes[0].primitives[0].targets[0].positions.assign(8, {1, 0, 0});
        scene.nodes.resize(3);
        scene.nodes[1].camera = 0;
        scene.nodes[2].light = 0;
        scene.roots = {0, 1, 2};
        scene.cameras = {{.name = {}, .node = 1}};
        scene.lights = {{.name = {}, .node = 2}};
        scene.animations = {{"", {{node, path, Interpolation::Linear, {0, 1}, std::move(values)}}}};
        finishScene(scene);
        return gatherFacts(scene);
    };
    const std::vector<float> move = {0, 0, 0, 1, 1, 1}, rest = {3, 3, 3, 3, 3, 3};
    EXPECT_TRUE(factsWith(0, AnimatedPath::Translation, move).geometryMoves);
    EXPECT_FALSE(factsWith(0, AnimatedPath::Translation, move).geometryDeforms);
    EXPECT_FALSE(factsWith(0, AnimatedPath::Translation, rest).geometryMoves) << "a constant moves nothing";
    EXPECT_TRUE(factsWith(0, AnimatedPath::Weights, {0, 1}).geometryDeforms);
    EXPECT_TRUE(factsWith(1, AnimatedPath::Translation, move).cameraMoves);
    EXPECT_FALSE(factsWith(1, AnimatedPath::Translation, move).geometryMoves);
    EXPECT_TRUE(factsWith(2, AnimatedPath::Translation, move).lightsMove);
}

TEST(Facts, OfAnEmptySceneAreEmpty) {
    Scene scene;
    finishScene(scene);
    const SceneFacts facts = gatherFacts(scene);
    EXPECT_EQ(facts.triangles, 0u);
    EXPECT_TRUE(facts.bounds.empty());
    EXPECT_EQ(facts.sphere.radius, 0);
    EXPECT_TRUE(flatten(scene, 0).positions.empty());
    EXPECT_FALSE(facts.hasSingleSided || facts.hasMasked);
}

TEST(FinishScene, IsIdempotent) {
    Scene scene = loadScene("builtin:skinned?detail=0.05");
    const Scene once = scene;
    finishScene(scene);
    EXPECT_EQ(scene.meshes, once.meshes);
    EXPECT_EQ(scene.nodes, once.nodes);
    EXPECT_EQ(scene.cameras, once.cameras);
    EXPECT_EQ(scene.origin, once.origin);
}

// All vertices are inside the picture and between the planes, at any size and under a rootTransform.
TEST(FinishScene, AddsACameraThatSeesTheWholeScene) {
    for (const double scale : {1e-4, 1.0, 1e4}) {
        SCOPED_TRACE(scale);
        Scene scene = boxScene();
        scene.nodes[0].scale = glm::dvec3(scale, 2 * scale, scale);
        scene.nodes[0].translation = {7 * scale, 0, 0};
        scene.rootTransform = glm::dmat4(3);
        scene.rootTransform[3].w = 1;
        finishScene(scene);
        ASSERT_EQ(scene.cameras.size(), 1u);
        const CameraState camera = cameraAt(scene, 0, 0);
        float highest = 0;
        for (const float aspect : {1.0f, 16.0f / 9.0f})
            for (const glm::vec3& position : flatten(scene, 0).positions) {
                const glm::vec4 clip = camera.projection(aspect) * camera.view * glm::vec4(position, 1);
                EXPECT_LT(std::abs(clip.x), clip.w);
                EXPECT_LT(std::abs(clip.y), clip.w);
                EXPECT_GT(clip.z, 0);
                EXPECT_LT(clip.z, clip.w);
                highest = std::max(highest, std::abs(clip.y) / clip.w);
            }
        EXPECT_GT(highest, 0.5f) << "fills the picture";
    }
}

TEST(FinishScene, MakesTangentsAlongTheTextureWhereANormalMapNeedsThem) {
    Scene scene = boxScene();
    Primitive& quad = scene.meshes[0].primitives[0];
    quad = {};
    quad.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    quad.normals.assign(4, {0, 0, 1});
    quad.texCoords = {{0, 0}, {0, 1}, {-1, 1}, {-1, 0}}; // u runs along -y, v along x
    quad.indices = {0, 1, 2, 0, 2, 3};
    finishScene(scene);
    EXPECT_TRUE(scene.meshes[0].primitives[0].tangents.empty()) << "no normal map";
    scene.materials.emplace_back().normalTexture.image = 0;
    scene.images = {{"", 1, 1, {1, 2, 3, 4}}};
    quad.material = 0;
    finishScene(scene);
    ASSERT_EQ(quad.tangents.size(), 4u);
    for (const glm::vec4& tangent : quad.tangents) EXPECT_EQ(tangent, glm::vec4(0, -1, 0, -1));
}

// A picture that hangs upright on a wall: its +y is up, though v runs down (glTF 2.0, normalTexture).
TEST(FinishScene, UpInANormalMapIsUpInItsPicture) {
    Scene scene = boxScene();
    Primitive& wall = scene.meshes[0].primitives[0];
    wall = {};
    wall.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    wall.normals.assign(4, {0, 0, 1});
    wall.texCoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    wall.indices = {0, 1, 2, 0, 2, 3};
    scene.materials.emplace_back().normalTexture.image = 0;
    scene.images = {{"", 1, 1, {128, 255, 128, 255}}};
    wall.material = 0;
    finishScene(scene);
    ASSERT_EQ(wall.tangents.size(), 4u);
    for (const glm::vec4& tangent : wall.tangents)
        EXPECT_EQ(glm::cross(wall.normals[0], glm::vec3(tangent)) * tangent.w, glm::vec3(0, 1, 0));
}

TEST(FinishScene, MirroredTexturesGiveTheOtherHandedness) {
    Scene scene = boxScene();
    Primitive& quad = scene.meshes[0].primitives[0];
    quad.texCoords.clear();
    for (const glm::vec3& position : quad.positions) quad.texCoords.emplace_back(-position.x, -position.y);
    scene.materials.emplace_back().normalTexture.image = 0;
    scene.images = {{"", 1, 1, {1, 2, 3, 4}}};
    quad.material = 0;
    finishScene(scene);
    EXPECT_EQ(quad.tangents[0].w, -1);
    for (size_t i = 0; i < quad.tangents.size(); ++i) {
        EXPECT_NEAR(glm::length(glm::vec3(quad.tangents[i])), 1, 1e-6);
        EXPECT_NEAR(glm::dot(glm::vec3(quad.tangents[i]), quad.normals[i]), 0, 1e-6);
    }
}

TEST(Facts, CamerasAreNamedAndSpotLightsWiderThanAFlatMapHoldsAreCounted) {
    Scene scene = boxScene();
    scene.cameras.resize(2);
    scene.cameras[1].name = "second";
    scene.lights.resize(4);
    for (Light& light : scene.lights) light.kind = LightKind::Spot;
    scene.lights[1].outerCone = wideSpotCone;
    scene.lights[2].outerCone = 1.5F;
    scene.lights[3].kind = LightKind::Point;
    scene.lights[3].outerCone = 1.5F;
    const SceneFacts facts = gatherFacts(scene);
    EXPECT_EQ(facts.cameras, (std::vector<std::string>{"", "second"}));
    EXPECT_EQ(facts.spotLights, 3U);
    EXPECT_EQ(facts.wideSpotLights, 1U);
}

} // namespace
} // namespace kestrel
