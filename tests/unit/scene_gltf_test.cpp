// What the importer reads from files that are right.
#include "scene/gltf_import.h"
#include "support/gltf_builder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using test::GltfBuilder;
using test::TemporaryFolder;
using testing::ElementsAre;

using Indices = std::vector<std::uint32_t>;

TEST(GltfImport, ReadsATriangle) {
    const TemporaryFolder folder;
    const Scene scene = test::triangleFile().import(folder);
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Primitive& primitive = scene.meshes[0].primitives.at(0);
    EXPECT_THAT(primitive.positions, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)));
    EXPECT_EQ(primitive.indices, (Indices{0, 1, 2}));
    EXPECT_EQ(primitive.material, -1);
    EXPECT_EQ(scene.roots, std::vector<int>{0});
    EXPECT_EQ(scene.name, "test.gltf");
    EXPECT_TRUE(scene.warnings.empty());
}

Indices indicesOfMode(int mode, size_t vertices) {
    const TemporaryFolder folder;
    GltfBuilder builder;
    std::vector<float> positions;
    for (size_t i = 0; i < vertices; ++i) positions.insert(positions.end(), {float(i), float(i % 2), 0});
    builder.addMeshNode({{"attributes", {{"POSITION", builder.floats(positions, 3)}}}, {"mode", mode}});
    const Scene scene = builder.import(folder);
    return scene.meshes[0].primitives.empty() ? Indices{} : scene.meshes[0].primitives[0].indices;
}

TEST(GltfImport, TurnsStripsAndFansIntoTriangles) {
    EXPECT_EQ(indicesOfMode(4, 6), (Indices{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(indicesOfMode(5, 5), (Indices{0, 1, 2, 1, 3, 2, 2, 3, 4}));
    EXPECT_EQ(indicesOfMode(6, 5), (Indices{1, 2, 0, 2, 3, 0, 3, 4, 0}));
}

TEST(GltfImport, LeavesOutPointsAndLinesWithOneWarning) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    builder.addMeshNode({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
    builder.addMeshNode({{"attributes", {{"POSITION", 0}}}, {"mode", 3}});
    const Scene scene = builder.import(folder);
    EXPECT_THAT(scene.warnings, ElementsAre("points and lines are not drawn"));
    EXPECT_EQ(scene.meshes[0].primitives.size(), 1u);
    EXPECT_TRUE(scene.meshes[1].primitives.empty());
}

TEST(GltfImport, KeepsOnlyTheVerticesThatTrianglesUse) {
    const TemporaryFolder folder;
    GltfBuilder builder;
    const size_t positions = builder.floats({9, 9, 9, 0, 0, 0, 8, 8, 8, 1, 0, 0, 0, 1, 0}, 3);
    const size_t indices = builder.accessor<std::uint8_t>({4, 1, 3}, 1, test::UnsignedByte);
    builder.addMeshNode({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
    const Primitive primitive = builder.import(folder).meshes[0].primitives[0];
    EXPECT_THAT(primitive.positions, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)));
    EXPECT_EQ(primitive.indices, (Indices{2, 0, 1}));
}

TEST(GltfImport, ReadsQuantizedAttributes) {
    const TemporaryFolder folder;
    GltfBuilder builder;
    const size_t positions =
        builder.accessor<std::int16_t>({32767, 0, -32768, 16384, 0, 0, 0, 32767, 0}, 3, test::Short, true);
    // KHR_mesh_quantization: rows of three bytes are padded to four.
    const size_t view = builder.view(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, -128, 0, 0});
    builder.document["bufferViews"][view]["byteStride"] = 4;
    builder.document["accessors"].push_back({{"bufferView", view},
                                             {"componentType", test::Byte},
                                             {"normalized", true},
                                             {"count", 3},
                                             {"type", "VEC3"}});
    const size_t coordinates =
        builder.accessor<std::uint8_t>({0, 255, 51, 0, 0, 0}, 2, test::UnsignedByte, true);
    const size_t plain = builder.accessor<std::uint16_t>({7, 300, 0, 0, 0, 0}, 2, test::UnsignedShort);
    builder.addMeshNode({{"attributes",
                          {{"POSITION", positions},
                           {"NORMAL", positions + 1},
                           {"TEXCOORD_0", coordinates},
                           {"TEXCOORD_1", plain}}}});
    builder.document["extensionsRequired"] = {"KHR_mesh_quantization"};
    const Primitive primitive = builder.import(folder).meshes[0].primitives[0];
    EXPECT_EQ(primitive.positions[0], glm::vec3(1, 0, -1)); // -32768 counts as -32767
    EXPECT_FLOAT_EQ(primitive.positions[1].x, 16384.0f / 32767.0f);
    EXPECT_EQ(primitive.normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(primitive.normals[2], glm::vec3(0, -1, 0));
    EXPECT_EQ(primitive.texCoords[0], glm::vec2(0, 1));
    EXPECT_FLOAT_EQ(primitive.texCoords[1].x, 0.2f);
    EXPECT_EQ(primitive.texCoords1[0], glm::vec2(7, 300));
}

TEST(GltfImport, ReadsSparseAccessorsWithAndWithoutABase) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    const size_t indices = builder.view(std::vector<std::uint8_t>{2});
    const size_t values = builder.view(std::vector<float>{5, 6, 7});
    const nlohmann::json sparse = {
        {"count", 1},
        {"indices", {{"bufferView", indices}, {"componentType", test::UnsignedByte}}},
        {"values", {{"bufferView", values}}}};
    builder.document["accessors"][0]["sparse"] = sparse;
    builder.document["accessors"].push_back(
        {{"componentType", test::Float}, {"count", 3}, {"type", "VEC3"}, {"sparse", sparse}});
    builder.document["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 2}}};
    const Primitive primitive = builder.import(folder).meshes[0].primitives[0];
    EXPECT_THAT(primitive.positions, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(5, 6, 7)));
    EXPECT_THAT(primitive.targets[0].positions, ElementsAre(glm::vec3(0), glm::vec3(0), glm::vec3(5, 6, 7)));
}

TEST(GltfImport, MakesUnitNormalsAndWeightsThatSumToOne) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    auto& attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
    attributes["NORMAL"] = builder.floats({0, 0, 2, 0, 0, 0, 0.6f, 0.8f, 0}, 3);
    attributes["WEIGHTS_0"] = builder.floats({1, 1, 0, 0, 0, 0, 0, 0, 0.25f, 0.25f, 0.25f, 0.25f}, 4);
    attributes["JOINTS_0"] =
        builder.accessor<std::uint8_t>({0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3}, 4, test::UnsignedByte);
    const Primitive primitive = builder.import(folder).meshes[0].primitives[0];
    EXPECT_THAT(primitive.normals,
                ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, 1), glm::vec3(0.6f, 0.8f, 0)));
    EXPECT_THAT(primitive.weights,
                ElementsAre(glm::vec4(0.5f, 0.5f, 0, 0), glm::vec4(1, 0, 0, 0), glm::vec4(0.25f)));
    EXPECT_EQ(primitive.joints[0], glm::uvec4(0, 1, 0, 0));
}

// A 2 x 1 PNG: red, and half transparent green.
const char* const pngUri =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAD0lEQVR42mP4"
    "z8DwHwgbABB5A37EGHKQAAAAAElFTkSuQmCC";

TEST(GltfImport, ReadsMaterialsWithTheirExtensionsAndTextures) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    builder.document["images"] = {{{"uri", pngUri}, {"name", "spots"}}};
    builder.document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
    builder.document["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}}};
    builder.document["materials"] = nlohmann::json::parse(R"([{
        "name": "paint",
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.25,
            "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform":
                {"offset": [0.5, 0.25], "rotation": 0.125, "scale": [2, 4], "texCoord": 1}}}},
        "normalTexture": {"index": 1, "scale": 0.75},
        "occlusionTexture": {"index": 1},
        "emissiveFactor": [1, 0.5, 0],
        "alphaMode": "MASK", "alphaCutoff": 0.375, "doubleSided": true,
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3000000000}, "KHR_materials_unlit": {},
            "KHR_materials_transmission": {"transmissionFactor": 0.875}, "KHR_materials_ior": {"ior": 2},
            "KHR_materials_clearcoat": {"clearcoatFactor": 1}}
    }, {}])");
    const Scene scene = builder.import(folder);
    ASSERT_EQ(scene.materials.size(), 2u);
    const Material& paint = scene.materials[0];
    EXPECT_EQ(paint.name, "paint");
    EXPECT_EQ(paint.baseColour, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(paint.metallic, 0.5f);
    EXPECT_EQ(paint.roughness, 0.25f);
    EXPECT_EQ(paint.emission, glm::vec3(3e9f, 1.5e9f, 0));
    EXPECT_EQ(paint.normalScale, 0.75f);
    EXPECT_EQ(paint.alphaMode, AlphaMode::Mask);
    EXPECT_EQ(paint.alphaCutoff, 0.375f);
    EXPECT_TRUE(paint.doubleSided);
    EXPECT_TRUE(paint.unlit);
    EXPECT_EQ(paint.transmission, 0.875f);
    EXPECT_EQ(paint.ior, 2.0f);
    EXPECT_EQ(paint.baseColourTexture, (TextureRef{.image = 0,
                                                   .texCoord = 1,
                                                   .wrapS = Wrap::ClampToEdge,
                                                   .wrapT = Wrap::MirroredRepeat,
                                                   .nearest = true,
                                                   .offset = {0.5f, 0.25f},
                                                   .scale = {2, 4},
                                                   .rotation = 0.125f}));
    EXPECT_EQ(paint.normalTexture.image, 0);
    EXPECT_EQ(paint.normalTexture.wrapS, Wrap::Repeat);
    EXPECT_EQ(scene.materials[1], Material{});
    EXPECT_THAT(scene.warnings, ElementsAre("the extension KHR_materials_clearcoat is ignored",
                                            "occlusion textures are ignored"));
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images[0].name, "spots");
    EXPECT_EQ(scene.images[0].width, 2);
    EXPECT_EQ(scene.images[0].height, 1);
    EXPECT_THAT(scene.images[0].rgba, ElementsAre(255, 0, 0, 255, 0, 255, 0, 128));
}

TEST(GltfImport, ReadsCamerasAndLights) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    builder.document["cameras"] = nlohmann::json::parse(R"([
        {"type": "perspective", "name": "far", "perspective": {"yfov": 0.5, "znear": 1e-6}},
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 10}}])");
    builder.document["extensions"] = nlohmann::json::parse(R"({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "name": "s", "color": [1, 0.5, 0.25], "intensity": 7, "range": 9,
         "spot": {"innerConeAngle": 0.125, "outerConeAngle": 0.25}},
        {"type": "directional"}]}})");
    builder.document["extensionsUsed"] = {"KHR_lights_punctual"};
    builder.document["nodes"] = nlohmann::json::parse(R"([
        {"mesh": 0},
        {"camera": 1, "name": "plan", "translation": [1, 2, 3]},
        {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 1}}},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"extras": {"KESTREL_area_light": {"kind": "rectangle", "half_size": [0.5, 0.25], "intensity": 4, "index": 1}}}])");
    builder.document["scenes"][0]["nodes"] = {0, 1, 2, 3, 4};
    const Scene scene = builder.import(folder);
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_EQ(scene.cameras[0].name, "far");
    EXPECT_EQ(scene.cameras[0].node, 2);
    EXPECT_LE(scene.cameras[0].farPlane, 0) << "infinite";
    EXPECT_EQ(scene.cameras[0].nearPlane, 1e-6f);
    EXPECT_EQ(scene.cameras[0].aspect, 0);
    EXPECT_TRUE(scene.cameras[1].orthographic);
    EXPECT_EQ(scene.cameras[1].name, "plan") << "the node's, where the camera has none";
    EXPECT_EQ(scene.cameras[1].aspect, 1.5f);
    EXPECT_EQ(scene.cameras[1].halfHeight, 2.0f);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].kind, LightKind::Spot);
    EXPECT_EQ(scene.lights[0].colour, glm::vec3(1, 0.5f, 0.25f));
    EXPECT_EQ(scene.lights[0].intensity, 7);
    EXPECT_EQ(scene.lights[0].range, 9);
    EXPECT_EQ(scene.lights[0].innerCone, 0.125f);
    EXPECT_EQ(scene.lights[0].outerCone, 0.25f);
    EXPECT_EQ(scene.lights[1].kind, LightKind::Rectangle);
    EXPECT_EQ(scene.lights[1].halfSize, glm::vec2(0.5f, 0.25f));
    EXPECT_EQ(scene.lights[2].kind, LightKind::Directional);
    EXPECT_EQ(scene.lights[2].node, 2);
    EXPECT_EQ(scene.nodes[4].light, 1);
}

TEST(GltfImport, LoadsTheDefaultSceneOfSeveral) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    builder.document["nodes"].push_back({{"mesh", 0}, {"translation", {1, 2, 3}}});
    builder.document["scenes"].push_back({{"nodes", {1}}});
    builder.document["scene"] = 1;
    const Scene scene = builder.import(folder);
    EXPECT_EQ(scene.roots, std::vector<int>{1});
    EXPECT_EQ(scene.nodes[1].translation, glm::dvec3(1, 2, 3));
    EXPECT_THAT(scene.warnings, ElementsAre("the file has 2 scenes; scene 1 is loaded"));
}

TEST(GltfImport, ReadsAnimationsOfAllInterpolations) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    builder.document["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}, {{"POSITION", 0}}};
    builder.document["meshes"][0]["weights"] = {0.5, 0.25};
    const size_t times = builder.floats({0, 1}, 1);
    const size_t moves = builder.floats({0, 0, 0, 1, 2, 3}, 3);
    const size_t turns = builder.accessor<std::int8_t>({0, 0, 0, 127, 0, 127, 0, 0}, 4, test::Byte, true);
    const size_t weights = builder.floats({0, 0, 1, 2, 0, 0, 0, 0, 3, 4, 0, 0}, 1);
    const auto sampler = [&](size_t output, const char* interpolation) {
        return nlohmann::json{{"input", times}, {"output", output}, {"interpolation", interpolation}};
    };
    const auto channel = [](int index, const char* path) {
        return nlohmann::json{{"sampler", index}, {"target", {{"node", 0}, {"path", path}}}};
    };
    builder.document["animations"] = {
        {{"name", "all"},
         {"samplers", {sampler(moves, "STEP"), sampler(turns, "LINEAR"), sampler(weights, "CUBICSPLINE")}},
         {"channels",
          {channel(0, "translation"), channel(1, "rotation"), channel(2, "weights"),
           channel(0, "pointer")}}}};
    const Scene scene = builder.import(folder);
    ASSERT_EQ(scene.animations.size(), 1u);
    const std::vector<AnimationChannel>& channels = scene.animations[0].channels;
    ASSERT_EQ(channels.size(), 3u);
    EXPECT_EQ(channels[0].interpolation, Interpolation::Step);
    EXPECT_EQ(channels[1].path, AnimatedPath::Rotation);
    EXPECT_THAT(channels[1].values, ElementsAre(0, 0, 0, 1, 0, 1, 0, 0));
    EXPECT_EQ(channels[2].interpolation, Interpolation::CubicSpline);
    EXPECT_EQ(channels[2].values.size(), 12u);
    EXPECT_EQ(scene.duration(), 1);
    EXPECT_THAT(scene.warnings, ElementsAre("animations of 'pointer' are ignored"));
}

TEST(GltfImport, ReadsBuffersAndImagesBesideTheFile) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    writeFile(folder / "with space.bin", std::as_bytes(std::span(builder.data)));
    builder.document["buffers"] = {{{"byteLength", builder.data.size()}, {"uri", "with%20space.bin"}}};
    EXPECT_EQ(builder.import(folder).meshes[0].primitives[0].positions.size(), 3u);
}

} // namespace
} // namespace kestrel
