// EXT_mesh_gpu_instancing: one mesh at many places.
#include "scene/facts.h"
#include "scene/geometry.h"
#include "scene/gltf_export.h"
#include "scene/gltf_import.h"
#include "support/gltf_builder.h"
#include "support/message.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel::gltf_instancing_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

void addInstances(GltfBuilder& builder, const json& attributes, size_t node = 0) {
    builder.document["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    builder.document["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
}

// The same nodes one by one, with `translations` of three floats each.
std::vector<glm::vec3> positionsAt0(Scene scene) {
    finishScene(scene);
    std::vector<glm::vec3> positions = flatten(scene, 0).positions;
    for (glm::vec3& position : positions) position += glm::vec3(scene.origin);
    return positions;
}

TEST(GltfInstancing, PutsTheMeshWhereTheAttributesSay) {
    const TemporaryFolder folder;
    for (const bool required : {false, true}) {
        GltfBuilder builder = test::triangleFile();
        builder.document["nodes"][0]["translation"] = {0, 0, 10};
        const size_t t = builder.floats({0, 0, 0, 5, 0, 0}, 3), s = builder.floats({1, 1, 1, 2, 2, 2}, 3);
        // A quarter turn about z, as normalized 16-bit integers; not quite unit, as they are.
        const size_t r =
            builder.accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170}, 4, test::Short, true);
        addInstances(builder, {{"TRANSLATION", t}, {"ROTATION", r}, {"SCALE", s}});
        if (required) builder.document["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
        const Scene scene = builder.import(folder);
        EXPECT_TRUE(scene.warnings.empty());
        const std::vector<glm::vec3> positions = positionsAt0(scene);
        const glm::vec3 wanted[] = {{0, 0, 10}, {1, 0, 10}, {0, 1, 10}, {5, 0, 10}, {5, 2, 10}, {3, 0, 10}};
        ASSERT_EQ(positions.size(), 6u);
        for (size_t i = 0; i < 6; ++i) EXPECT_LT(glm::length(positions[i] - wanted[i]), 1e-5f) << i;
    }
}

TEST(GltfInstancing, EachAttributeMayBeMissingAndBytesTurnToo) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    addInstances(builder, {{"ROTATION",
                            builder.accessor<std::int8_t>({0, 0, 127, 0, 0, 0, 0, 0}, 4, test::Byte, true)}});
    const std::vector<glm::vec3> positions = positionsAt0(builder.import(folder));
    ASSERT_EQ(positions.size(), 6u);
    EXPECT_LT(glm::length(positions[1] - glm::vec3(-1, 0, 0)), 1e-5f) << "half a turn about z";
    EXPECT_LT(glm::length(positions[4] - glm::vec3(1, 0, 0)), 1e-5f) << "no rotation turns nothing";
}

TEST(GltfInstancing, ChildrenAndWhatIsElsewhereStayOne) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    builder.document["nodes"][0]["children"] = {1};
    builder.document["nodes"].push_back({{"mesh", 0}});
    addInstances(builder, {{"TRANSLATION", builder.floats({1, 0, 0, 2, 0, 0, 3, 0, 0}, 3)},
                           {"_ID", builder.floats({1, 2, 3}, 1)}});
    Scene scene = builder.import(folder);
    EXPECT_THAT(scene.warnings, ElementsAre("the attribute _ID of instances is ignored"));
    finishScene(scene);
    EXPECT_EQ(gatherFacts(scene).triangles, 4u);
    // Exported and read again they are the same nodes.
    exportScene(scene, folder / "again.glb");
    EXPECT_EQ(loadScene((folder / "again.glb").string()).nodes, scene.nodes);
}

TEST(GltfInstancing, SaysWhatIsWrong) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    const size_t two = builder.floats({0, 0, 0, 5, 0, 0}, 3),
                 three = builder.floats({1, 1, 1, 2, 2, 2, 3, 3, 3}, 3);
    const auto message = [&](const json& attributes) {
        addInstances(builder, attributes);
        return test::messageOf([&] { (void)builder.import(folder); });
    };
    EXPECT_THAT(message({{"SCALE", three}, {"TRANSLATION", two}}),
                HasSubstr("nodes[0].EXT_mesh_gpu_instancing: there are 2 of TRANSLATION, but 3 of SCALE"));
    EXPECT_THAT(message({{"ROTATION", two}}),
                HasSubstr("(nodes[0].EXT_mesh_gpu_instancing.ROTATION) is not VEC4"));
    EXPECT_THAT(message({{"ROTATION", 99}}),
                HasSubstr("attributes.ROTATION is 99, but there are 4 accessors"));
}

TEST(GltfInstancing, TooManyAreThinnedOutEvenlyWithAWarningThatNamesFigureAndLimit) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    std::vector<float> translations;
    for (int i = 0; i < 100; ++i) translations.insert(translations.end(), {static_cast<float>(i), 0, 0});
    addInstances(builder, {{"TRANSLATION", builder.floats(translations, 3)}});
    writeFile(folder / "many.gltf", builder.text());
    for (const GltfLimits& limits : {GltfLimits{.instances = 25}, GltfLimits{.triangles = 75}}) {
        const Scene scene = importGltf(folder / "many.gltf", {}, limits);
        ASSERT_EQ(scene.nodes.size(), 26u);
        EXPECT_EQ(scene.nodes[1].translation.x, 0);
        EXPECT_EQ(scene.nodes[25].translation.x, 96);
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_THAT(scene.warnings[0],
                    HasSubstr("the scene has 100 instances of 100 triangles and 300 vertices in "
                              "all; at most "));
        EXPECT_THAT(scene.warnings[0], HasSubstr("are drawn: 25 of them are, evenly chosen"));
    }
}

TEST(GltfInstancing, MillionsOfTrianglesAreMade) {
    const TemporaryFolder folder;
    // 2,800 places of a mesh of 2,715 triangles.
    constexpr size_t places = 2800, triangles = 2715;
    GltfBuilder builder;
    std::vector<std::uint16_t> indices;
    for (size_t i = 0; i < triangles; ++i) indices.insert(indices.end(), {0, 1, 2});
    std::vector<float> translations;
    for (size_t i = 0; i < places; ++i)
        translations.insert(translations.end(), {static_cast<float>(i % 53), static_cast<float>(i / 53), 0});
    const size_t p = builder.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3),
                 n = builder.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    builder.addMeshNode({{"attributes", {{"POSITION", p}, {"NORMAL", n}}},
                         {"indices", builder.accessor(indices, 1, test::UnsignedShort)}});
    addInstances(builder, {{"TRANSLATION", builder.floats(translations, 3)}});
    Scene scene = builder.import(folder);
    finishScene(scene);
    EXPECT_EQ(gatherFacts(scene).triangles, places * triangles);
    EXPECT_EQ(flatten(scene, 0).triangleCount(), places * triangles);
    EXPECT_TRUE(scene.warnings.empty());
}

} // namespace
} // namespace kestrel::gltf_instancing_test
