// What later versions, extensions and careless exporters put into files: used where it can be, with a
// warning.
#include "scene/gltf_import.h"
#include "support/gltf_builder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel::gltf_additions_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::importMessage;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

GltfBuilder withMaterial(const json& material, bool used) {
    GltfBuilder builder = test::triangleFile();
    builder.document["materials"] = {material};
    if (used) builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    return builder;
}

json colour(double red) { return {{"pbrMetallicRoughness", {{"baseColorFactor", {red, 1, 1, 1}}}}}; }

TEST(GltfRounding, AFactorBeyondItsRangeByARoundingIsClampedWithAWarning) {
    const TemporaryFolder folder;
    for (const auto& [written, read] : {std::pair(1.0000001192092896, 1.0f), std::pair(1.00016, 1.0f),
                                        std::pair(1.001, 1.0f), std::pair(-1e-9, 0.0f)}) {
        const Scene scene = withMaterial(colour(written), true).import(folder);
        EXPECT_EQ(scene.materials[0].baseColour.r, read) << written;
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_THAT(scene.warnings[0], HasSubstr("materials[0].pbrMetallicRoughness.baseColorFactor[0] is "));
        EXPECT_THAT(scene.warnings[0], HasSubstr("which is out of range, and is read as "));
    }
}

TEST(GltfRounding, AFactorFarBeyondIsAnErrorWhereItIsUsedAndClampedWhereNot) {
    EXPECT_THAT(
        importMessage(withMaterial(colour(1.0011), true)),
        HasSubstr("materials[0].pbrMetallicRoughness.baseColorFactor[0] is 1.0011, not within 0 to 1"));
    const TemporaryFolder folder;
    const Scene scene = withMaterial(colour(5), false).import(folder);
    EXPECT_EQ(scene.materials[0].baseColour.r, 1);
    EXPECT_THAT(scene.warnings,
                ElementsAre("materials[0].pbrMetallicRoughness.baseColorFactor[0] is 5, which is out "
                            "of range, and is read as 1"));
}

TEST(GltfRounding, EveryRangeHasTheSameSlack) {
    const TemporaryFolder folder;
    GltfBuilder builder = withMaterial(json::parse(R"({"pbrMetallicRoughness": {"metallicFactor": 1.0005,
        "roughnessFactor": -0.0005}, "alphaCutoff": -1e-6, "emissiveFactor": [-1e-6, 0, 0],
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1.0000001}}})"),
                                       true);
    builder.document["extensions"]["KHR_lights_punctual"]["lights"] =
        json::parse(R"([{"type": "point", "intensity": -1e-5}])");
    const Scene scene = builder.import(folder);
    EXPECT_EQ(scene.materials[0].metallic, 1);
    EXPECT_EQ(scene.materials[0].roughness, 0);
    EXPECT_EQ(scene.materials[0].alphaCutoff, 0);
    EXPECT_EQ(scene.materials[0].emission.r, 0);
    EXPECT_EQ(scene.materials[0].transmission, 1);
    EXPECT_EQ(scene.warnings.size(), 6u);
}

TEST(GltfRounding, WeightsAndTimesJustBelowZeroAreZero) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    auto& attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
    attributes["WEIGHTS_0"] = builder.floats({1, -1e-4f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
    attributes["JOINTS_0"] =
        builder.accessor<std::uint8_t>({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 4, test::UnsignedByte);
    const size_t times = builder.floats({-1e-4f, 1}, 1), moves = builder.floats({0, 0, 0, 1, 1, 1}, 3);
    builder.document["animations"] = {
        {{"samplers", {{{"input", times}, {"output", moves}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    const Scene scene = builder.import(folder);
    EXPECT_EQ(scene.meshes[0].primitives[0].weights[0], glm::vec4(1, 0, 0, 0));
    EXPECT_EQ(scene.animations[0].channels[0].times[0], 0);
    EXPECT_THAT(scene.warnings,
                ElementsAre("meshes[0].primitives[0].WEIGHTS_0 has weights below 0, which are read as 0",
                            "animations[0].channels[0] input begins at -0.0001, which is read as 0"));
}

TEST(GltfAdditions, CamerasAndLightsOfUnknownTypesAreLeftOut) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    builder.document["cameras"] = json::parse(R"([{"type": "panorama", "panorama": {}},
        {"type": "perspective", "name": "usual", "perspective": {"yfov": 1, "znear": 0.1}}])");
    builder.document["extensions"]["KHR_lights_punctual"]["lights"] =
        json::parse(R"([{"type": "point", "intensity": 2}, {"type": "disk", "radius": 3}])");
    builder.document["nodes"] = json::parse(R"([{"mesh": 0}, {"camera": 0}, {"camera": 1},
        {"extensions": {"KHR_lights_punctual": {"light": 1}}}, {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"extras": {"KESTREL_area_light": {"kind": "disk", "half_size": [1, 1]}}}])");
    builder.document["scenes"][0]["nodes"] = {0, 1, 2, 3, 4, 5};
    const Scene scene = builder.import(folder);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "usual");
    EXPECT_EQ(scene.cameras[0].node, 2);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].node, 4);
    EXPECT_THAT(
        scene.warnings,
        ElementsAre("cameras[0] is of the type 'panorama', which Kestrel does not know, and is ignored",
                    "lights[1] is of the type 'disk', which Kestrel does not know, and is ignored",
                    "nodes[5] has an area light of the kind 'disk', which Kestrel does not know, and is "
                    "ignored"));
}

TEST(GltfAdditions, WhatNobodyNeedsMayBeOfAnyKind) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    json& primitive = builder.document["meshes"][0]["primitives"][0];
    // Half floats and an element type of a later version: one that nothing uses, and ones that can be missed.
    builder.document["accessors"].push_back(
        {{"bufferView", 0}, {"componentType", 5131}, {"count", 3}, {"type", "VEC3"}});
    builder.document["accessors"].push_back(
        {{"bufferView", 0}, {"componentType", test::Float}, {"count", 3}, {"type", "VEC8"}});
    primitive["attributes"]["NORMAL"] = 2;
    primitive["attributes"]["COLOR_0"] = 3;
    primitive["targets"] = {{{"POSITION", 0}, {"NORMAL", 2}}};
    builder.document["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 9}});
    builder.document["materials"] = {{{"alphaMode", "DITHER"}}};
    const Scene scene = builder.import(folder);
    EXPECT_EQ(scene.meshes[0].primitives.size(), 1u);
    EXPECT_TRUE(scene.meshes[0].primitives[0].normals.empty());
    EXPECT_TRUE(scene.meshes[0].primitives[0].colours.empty());
    EXPECT_EQ(scene.materials[0].alphaMode, AlphaMode::Opaque);
    EXPECT_THAT(
        scene.warnings,
        ElementsAre(
            "materials[0] has the alpha mode 'DITHER', which Kestrel does not know, and is opaque",
            "meshes[0].primitives[0].NORMAL is of the component type 5131, which Kestrel does not know, and "
            "is ignored",
            "meshes[0].primitives[0].COLOR_0 is of the type 'VEC8', which Kestrel does not know, and is "
            "ignored",
            "primitives of mode 9, which Kestrel does not know, are not drawn"));
}

TEST(GltfAdditions, WhatIsNeededMustBeReadable) {
    GltfBuilder builder = test::triangleFile();
    builder.document["accessors"][0]["componentType"] = 5131;
    EXPECT_THAT(importMessage(builder),
                HasSubstr("accessors[0] (meshes[0].primitives[0].POSITION) is of the component "
                          "type 5131, which Kestrel does not know"));
    builder = test::triangleFile();
    builder.document["accessors"][1]["componentType"] = 5132;
    EXPECT_THAT(importMessage(builder),
                HasSubstr("(meshes[0].primitives[0].indices) is of the component type 5132"));
    builder = test::triangleFile();
    builder.document["asset"]["minVersion"] = "2.1";
    EXPECT_THAT(importMessage(builder), HasSubstr("needs a reader of glTF 2.1; version 2.0 is read"));
    builder.document["asset"]["minVersion"] = "2.0";
    builder.document["asset"]["version"] = "2.7";
    EXPECT_EQ(importMessage(builder), "no error");
}

TEST(GltfAdditions, AnimationsOfUnknownKindsAreIgnored) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    const size_t times = builder.floats({0, 1}, 1), moves = builder.floats({0, 0, 0, 1, 1, 1}, 3);
    builder.document["accessors"].push_back(
        {{"bufferView", 0}, {"componentType", 5131}, {"count", 2}, {"type", "VEC3"}});
    const size_t half = builder.document["accessors"].size() - 1;
    builder.document["animations"] = {{{"samplers",
                                        {{{"input", times}, {"output", moves}},
                                         {{"input", times}, {"output", moves}, {"interpolation", "BEZIER"}},
                                         {{"input", times}, {"output", half}}}},
                                       {"channels",
                                        {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
                                         {{"sampler", 1}, {"target", {{"node", 0}, {"path", "scale"}}}},
                                         {{"sampler", 2}, {"target", {{"node", 0}, {"path", "scale"}}}},
                                         {{"sampler", 0}, {"target", {{"path", "translation"}}}}}}}};
    const Scene scene = builder.import(folder);
    ASSERT_EQ(scene.animations.size(), 1u);
    EXPECT_EQ(scene.animations[0].channels.size(), 1u);
    EXPECT_THAT(
        scene.warnings,
        ElementsAre("animations of what is no node are ignored",
                    "animations with the interpolation 'BEZIER' are ignored",
                    "accessors[" + std::to_string(half) +
                        "] is of the component type 5131, which Kestrel does not know: animations by it are "
                        "ignored"));
}

TEST(GltfAdditions, AccessorsWithoutABufferViewAreZeros) {
    const TemporaryFolder folder;
    GltfBuilder builder = test::triangleFile();
    json& primitive = builder.document["meshes"][0]["primitives"][0];
    builder.document["accessors"].push_back({{"componentType", test::Float}, {"count", 3}, {"type", "VEC2"}});
    primitive["attributes"]["TEXCOORD_0"] = 2;
    builder.document["accessors"].push_back(
        {{"componentType", test::UnsignedShort},
         {"count", 3},
         {"type", "SCALAR"},
         {"sparse",
          {{"count", 2},
           {"indices",
            {{"bufferView", builder.view(std::vector<std::uint8_t>{1, 2})}, {"componentType", 5121}}},
           {"values", {{"bufferView", builder.view(std::vector<std::uint16_t>{1, 2})}}}}}});
    primitive["indices"] = 3;
    const Scene scene = builder.import(folder);
    EXPECT_THAT(scene.meshes[0].primitives[0].texCoords, testing::Each(glm::vec2(0)));
    EXPECT_THAT(scene.meshes[0].primitives[0].indices, ElementsAre(0, 1, 2));
    EXPECT_TRUE(scene.warnings.empty());
}

} // namespace
} // namespace kestrel::gltf_additions_test
