// A scene that is exported and loaded again is the same scene.
#include "scene/builtin.h"
#include "scene/gltf_export.h"
#include "scene/gltf_import.h"
#include "support/assets.h"
#include "support/gltf_builder.h"
#include <gtest/gtest.h>

namespace kestrel {
namespace {

void expectEqual(const Primitive& a, const Primitive& b) {
    EXPECT_EQ(a.positions.size(), b.positions.size());
    EXPECT_EQ(a.indices, b.indices);
    EXPECT_TRUE(a.positions == b.positions);
    EXPECT_TRUE(a.normals == b.normals);
    EXPECT_TRUE(a.tangents == b.tangents);
    EXPECT_TRUE(a.texCoords == b.texCoords && a.texCoords1 == b.texCoords1);
    EXPECT_TRUE(a.colours == b.colours);
    EXPECT_TRUE(a.joints == b.joints);
    EXPECT_TRUE(a.weights == b.weights);
    EXPECT_TRUE(a.targets == b.targets);
    EXPECT_TRUE(a == b);
}

void expectEqual(const Scene& a, const Scene& b) {
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    for (size_t i = 0; i < a.nodes.size(); ++i) EXPECT_EQ(a.nodes[i], b.nodes[i]) << "node " << i;
    EXPECT_EQ(a.roots, b.roots);
    ASSERT_EQ(a.meshes.size(), b.meshes.size());
    for (size_t i = 0; i < a.meshes.size(); ++i) {
        SCOPED_TRACE("mesh " + std::to_string(i) + " " + a.meshes[i].name);
        EXPECT_EQ(a.meshes[i].name, b.meshes[i].name);
        EXPECT_EQ(a.meshes[i].weights, b.meshes[i].weights);
        ASSERT_EQ(a.meshes[i].primitives.size(), b.meshes[i].primitives.size());
        for (size_t k = 0; k < a.meshes[i].primitives.size(); ++k)
            expectEqual(a.meshes[i].primitives[k], b.meshes[i].primitives[k]);
    }
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (size_t i = 0; i < a.materials.size(); ++i)
        EXPECT_EQ(a.materials[i], b.materials[i]) << "material " << i;
    EXPECT_EQ(a.images, b.images);
    EXPECT_EQ(a.skins, b.skins);
    EXPECT_EQ(a.cameras, b.cameras);
    EXPECT_EQ(a.lights, b.lights);
    EXPECT_EQ(a.animations, b.animations);
    EXPECT_EQ(a.rootTransform, b.rootTransform);
    EXPECT_EQ(a.origin, b.origin);
}

Scene exportedAndLoaded(const Scene& scene) {
    const test::TemporaryFolder folder;
    exportScene(scene, folder / "again.glb");
    return loadScene((folder / "again.glb").string());
}

Primitive quad() {
    Primitive quad;
    quad.positions = {{0, 0, 0}, {1, 0, 0.1f}, {1, 1, 0}, {0, 1, 0.3f}};
    quad.normals = {{0, 0, 1}, {0, 1, 0}, {0.6f, 0.8f, 0}, {0, 0, -1}};
    quad.texCoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    quad.indices = {0, 1, 2, 0, 2, 3};
    return quad;
}

// Something of everything that a Scene can hold.
Scene everything() {
    Scene scene;
    TextureImage image{"noise", 3, 2, {}};
    for (int i = 0; i < 24; ++i) image.rgba.push_back(static_cast<std::uint8_t>(i * 37));
    scene.images = {image, {"one", 1, 1, {9, 8, 7, 6}}};

    Material paint;
    paint.name = "paint \"quoted\" \u00e4";
    paint.baseColour = {0.1f, 0.2f, 0.3f, 0.7f};
    paint.metallic = 1.0f / 3.0f;
    paint.roughness = 0.1f;
    paint.emission = {17, 12.1f, 4.3f};
    paint.normalScale = 0.3f;
    paint.alphaMode = AlphaMode::Blend;
    paint.alphaCutoff = 0.3f;
    paint.doubleSided = true;
    paint.transmission = 0.9f;
    paint.ior = 1.33f;
    paint.baseColourTexture = {.image = 1, .texCoord = 1, .wrapS = Wrap::ClampToEdge, .nearest = true};
    paint.normalTexture = {.image = 0, .offset = {0.1f, 0.2f}, .scale = {3, 4}, .rotation = 0.7f};
    paint.metallicRoughnessTexture.image = 0;
    paint.emissionTexture = {.image = 0, .wrapT = Wrap::MirroredRepeat};
    Material lamp;
    lamp.emission = {0.5f, 0.1f, 0};
    lamp.unlit = true;
    lamp.alphaMode = AlphaMode::Mask;
    scene.materials = {paint, lamp};

    Primitive rich = quad();
    rich.material = 0;
    rich.texCoords1 = {{0, 0}, {0.5f, 0}, {0.5f, 0.5f}, {0, 2}};
    rich.colours = {{1, 0, 0, 1}, {0.1f, 0.2f, 0.3f, 0.4f}, {1, 1, 1, 1}, {0, 0, 0, 0}};
    rich.joints = {{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}};
    rich.weights = {{0.7f, 0.3f, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}};
    rich.targets.resize(2);
    rich.targets[0].positions.assign(4, {0, 0, 0.1f});
    rich.targets[1].positions.assign(4, {0.1f, 0, 0});
    rich.targets[1].normals.assign(4, {0, 0.01f, 0});
    Primitive flat = quad();
    flat.normals.clear();
    flat.material = 1;
    flat.targets.resize(2);
    flat.targets[0].positions.assign(4, {0, 0, 0.2f});
    flat.targets[1].positions.assign(4, {0, 0, 0.3f});
    scene.meshes = {{"rich", {rich, flat}, {0.25f, 0.5f}}};
    scene.skins = {{"bones", {2, 3}, {glm::mat4(1), glm::mat4(0.9f)}}};
    scene.skins[0].inverseBind[1][3] = {0.1f, 0.2f, 0.3f, 1};

    scene.nodes.resize(8);
    scene.nodes[0].name = "body";
    scene.nodes[0].mesh = 0;
    scene.nodes[0].skin = 0;
    scene.nodes[0].weights = {0.1f, 0.2f};
    scene.nodes[1].translation = {1e7 + 0.123456789, -2, 1.0 / 3.0};
    scene.nodes[1].rotation = glm::normalize(glm::dquat(1, 2, 3, 4));
    scene.nodes[1].scale = {1, 2, -3};
    scene.nodes[1].children = {2, 4};
    scene.nodes[1].mesh = 0;
    scene.nodes[2].parent = 1;
    scene.nodes[2].children = {3};
    scene.nodes[3].parent = 2;
    scene.nodes[4].parent = 1;
    scene.nodes[4].matrix = glm::dmat4(2);
    (*scene.nodes[4].matrix)[3] = {0.1, 0.2, 0.3, 1};
    scene.nodes[4].light = 1;
    scene.nodes[5].light = 0;
    scene.nodes[5].camera = 1;
    scene.nodes[6].camera = 0;
    scene.nodes[6].light = 2;
    scene.nodes[7].light = 3;
    scene.roots = {0, 1, 5, 7, 6};

    scene.cameras = {{.name = "wide", .verticalFov = 1.1f, .nearPlane = 1e-4f, .farPlane = 0, .node = 6},
                     {.name = "plan",
                      .orthographic = true,
                      .aspect = 1.7777f,
                      .halfHeight = 2.1f,
                      .nearPlane = 0,
                      .farPlane = 11.3f,
                      .node = 5}};
    scene.lights = {{.name = "window",
                     .kind = LightKind::Rectangle,
                     .intensity = 3.3f,
                     .halfSize = {0.5f, 0.1f},
                     .node = 5},
                    {.name = "spot",
                     .kind = LightKind::Spot,
                     .colour = {1, 0.3f, 0.1f},
                     .intensity = 55.5f,
                     .range = 7.1f,
                     .innerCone = 0.1f,
                     .outerCone = 0.2f,
                     .node = 4},
                    {.name = "bulb", .kind = LightKind::Sphere, .halfSize = {0.2f, 0}, .node = 6},
                    {.name = "sun", .kind = LightKind::Directional, .node = 7}};

    const auto channel = [](int node, AnimatedPath path, Interpolation interpolation,
                            std::vector<float> values) {
        return AnimationChannel{node, path, interpolation, {0.1f, 0.7f}, std::move(values)};
    };
    scene.animations = {
        {"walk",
         {channel(2, AnimatedPath::Translation, Interpolation::Step, {0, 0, 0, 0.1f, 0.2f, 0.3f}),
          channel(2, AnimatedPath::Rotation, Interpolation::Linear, {0, 0, 0, 1, 0, 0.6f, 0, 0.8f})}},
        {"grow",
         {channel(3, AnimatedPath::Scale, Interpolation::CubicSpline,
                  {0, 0, 0, 1, 1, 1, 0.1f, 0, 0, 0, 0, 0.1f, 2, 2, 2, 0, 0, 0}),
          channel(0, AnimatedPath::Weights, Interpolation::Linear, {0, 1, 1, 0})}}};
    finishScene(scene);
    return scene;
}

TEST(GltfExport, LoadsEqual) {
    const Scene scene = everything();
    EXPECT_FALSE(scene.meshes[0].primitives[0].tangents.empty()) << "a normal map needs tangents";
    EXPECT_TRUE(scene.meshes[0].primitives[1].flatNormals);
    expectEqual(scene, exportedAndLoaded(scene));
}

TEST(GltfExport, IsTheSameToTheByteAndAfterASecondRound) {
    const Scene scene = everything();
    const std::vector<std::byte> bytes = exportedGlb(scene);
    EXPECT_EQ(bytes, exportedGlb(scene));
    EXPECT_EQ(bytes, exportedGlb(exportedAndLoaded(scene)));
}

TEST(GltfExport, PutsARootTransformAboveTheRoots) {
    Scene scene = everything();
    scene.rootTransform = glm::dmat4(3);
    scene.rootTransform[3] = {1, 2, 3, 1};
    finishScene(scene);
    const Scene again = exportedAndLoaded(scene);
    ASSERT_EQ(again.roots.size(), 1u);
    EXPECT_EQ(again.nodes[static_cast<size_t>(again.roots[0])].matrix, scene.rootTransform);
    EXPECT_EQ(again.nodes[static_cast<size_t>(again.roots[0])].children, scene.roots);
}

TEST(GltfExport, WritesAnEmptyScene) {
    Scene empty;
    finishScene(empty);
    ASSERT_EQ(empty.cameras.size(), 1u);
    EXPECT_EQ(empty.cameras[0].name, "default");
    expectEqual(empty, exportedAndLoaded(empty));
}

TEST(GltfExport, NamesTheFileThatCannotBeWritten) {
    try {
        exportScene(Scene{}, "/proc/no/such/place.glb");
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("/proc/no/such"), std::string::npos) << error.what();
    }
}

TEST(GltfExport, NamesAJointOnceAVertexWithItsWeightsSummed) {
    Scene scene = everything();
    Primitive& primitive = scene.meshes[0].primitives[0];
    primitive.joints = {{1, 1, 0, 0}, {0, 1, 0, 1}, {1, 1, 1, 1}, {1, 0, 1, 0}};
    primitive.weights = {
        {0.5f, 0.5f, 0, 0}, {0.25f, 0.25f, 0.25f, 0.25f}, glm::vec4(0.25f), {0, 0.5f, 0.5f, 0}};
    const Primitive again = exportedAndLoaded(scene).meshes[0].primitives[0];
    EXPECT_EQ(again.joints,
              (std::vector<glm::uvec4>{{1, 0, 0, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}}));
    EXPECT_EQ(again.weights,
              (std::vector<glm::vec4>{{1, 0, 0, 0}, {0.5f, 0.5f, 0, 0}, {1, 0, 0, 0}, {0, 0.5f, 0.5f, 0}}));
}

// Of each vertex: no joint twice, joint 0 where there is no weight.
TEST(GltfExport, TheSkinnedSceneNamesEachJointOnce) {
    for (const Mesh& mesh : builtinScene("builtin:skinned?detail=0.1").meshes)
        for (const Primitive& primitive : mesh.primitives)
            for (size_t v = 0; v < primitive.joints.size(); ++v)
                for (int k = 0; k < 4; ++k) {
                    ASSERT_TRUE(primitive.weights[v][k] > 0 || primitive.joints[v][k] == 0);
                    for (int other = 0; other < k; ++other)
                        ASSERT_FALSE(primitive.weights[v][k] > 0 && primitive.weights[v][other] > 0 &&
                                     primitive.joints[v][k] == primitive.joints[v][other]);
                }
}

class BuiltinExport : public testing::TestWithParam<std::string> {};

TEST_P(BuiltinExport, LoadsEqual) {
    const Scene scene = loadScene("builtin:" + GetParam() + "?detail=0.02");
    expectEqual(scene, exportedAndLoaded(scene));
}

INSTANTIATE_TEST_SUITE_P(Scenes, BuiltinExport, testing::ValuesIn(builtinNames()),
                         [](const auto& instance) { return instance.param; });

TEST(GltfExport, LoadsRealScenesEqual) {
    const std::filesystem::path assets = test::assetsFolder();
    if (assets.empty()) GTEST_SKIP() << "no folder of real scenes";
    for (const std::filesystem::path& file : test::gltfFilesBelow(assets)) {
        SCOPED_TRACE(file.string());
        const Scene scene = loadScene(file.string());
        // A scene that no camera was added to keeps all its names.
        expectEqual(scene, exportedAndLoaded(scene));
    }
}

} // namespace
} // namespace kestrel
