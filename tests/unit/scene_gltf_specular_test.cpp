// KHR_materials_pbrSpecularGlossiness: the surface that comes out is the one that went in.
#include "scene/gltf_import.h"
#include "scene/gltf_specular.h"
#include "support/gltf_builder.h"
#include "support/png.h"
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel::gltf_specular_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::pngOf;
using test::TemporaryFolder;
using testing::ElementsAre;

// What metallic-roughness means: diffuse colour and reflectance at normal incidence.
glm::vec3 diffuseOf(const MetallicSurface& s) { return s.baseColour * (1 - s.metallic); }
glm::vec3 reflectanceOf(const MetallicSurface& s) {
    return glm::mix(glm::vec3(0.04f), s.baseColour, s.metallic);
}

void expectNear(const glm::vec3& a, const glm::vec3& b, float tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

TEST(SpecularGlossiness, GreySurfacesAndMetalsComeBackExactly) {
    for (const float metallic : {0.0f, 0.1f, 0.5f, 0.9f, 1.0f})
        for (const float base : {0.05f, 0.3f, 0.8f, 1.0f}) {
            SCOPED_TRACE(testing::Message() << "metallic " << metallic << ", base " << base);
            const MetallicSurface source{glm::vec3(base), metallic};
            const MetallicSurface surface = metallicSurface(diffuseOf(source), reflectanceOf(source));
            expectNear(diffuseOf(surface), diffuseOf(source), 1e-4f);
            expectNear(reflectanceOf(surface), reflectanceOf(source), 1e-4f);
        }
    const MetallicSurface gold = metallicSurface(glm::vec3(0), {1, 0.77f, 0.34f});
    EXPECT_NEAR(gold.metallic, 1, 1e-6f);
    expectNear(gold.baseColour, {1, 0.77f, 0.34f}, 1e-6f);
    const MetallicSurface paint = metallicSurface({0.8f, 0.1f, 0.3f}, glm::vec3(0.04f));
    EXPECT_EQ(paint.metallic, 0);
    expectNear(paint.baseColour, {0.8f, 0.1f, 0.3f}, 1e-6f);
    const MetallicSurface black = metallicSurface(glm::vec3(0), glm::vec3(0));
    expectNear(black.baseColour, glm::vec3(0), 0);
}

TEST(SpecularGlossiness, TintedDielectricsAreNear) {
    // A metalness can't be tinted: what is between stays within a few hundredths.
    const MetallicSurface surface = metallicSurface({0.4f, 0.3f, 0.2f}, {0.06f, 0.05f, 0.04f});
    expectNear(diffuseOf(surface), {0.4f, 0.3f, 0.2f}, 0.01f);
    expectNear(reflectanceOf(surface), {0.06f, 0.05f, 0.04f}, 0.02f);
}

GltfBuilder fileWith(const json& extension) {
    GltfBuilder builder = test::triangleFile();
    builder.document["materials"] = {{{"extensions", {{"KHR_materials_pbrSpecularGlossiness", extension}}}}};
    builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    builder.document["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
    return builder;
}

void addTexture(GltfBuilder& builder, const std::vector<std::uint8_t>& rgba, int width, int height) {
    builder.document["images"].push_back({{"bufferView", builder.view(pngOf(rgba, width, height))}});
    builder.document["textures"].push_back({{"source", builder.document["images"].size() - 1}});
}

const char* const converted = "specular-glossiness materials are converted to metallic-roughness";

TEST(SpecularGlossiness, FactorsAreConvertedWithAWarning) {
    const TemporaryFolder folder;
    const Scene scene = fileWith({{"diffuseFactor", {0.5, 0.25, 0.125, 0.75}},
                                  {"specularFactor", {0.04, 0.04, 0.04}},
                                  {"glossinessFactor", 0.25}})
                            .import(folder);
    const Material& material = scene.materials[0];
    expectNear(glm::vec3(material.baseColour), glm::vec3(0.48f, 0.24f, 0.12f), 1e-5f);
    EXPECT_EQ(material.baseColour.a, 0.75f);
    EXPECT_EQ(material.metallic, 0);
    EXPECT_EQ(material.roughness, 0.75f);
    EXPECT_THAT(scene.warnings, ElementsAre(converted));
    // By itself the extension means a white, smooth mirror.
    const Material mirror = fileWith(json::object()).import(folder).materials[0];
    expectNear(glm::vec3(mirror.baseColour), glm::vec3(1), 1e-6f);
    EXPECT_NEAR(mirror.metallic, 1, 1e-6f);
    EXPECT_EQ(mirror.roughness, 0);
}

TEST(SpecularGlossiness, ABlendedMaterialIsAsClearAsItsFallbackSays) {
    const TemporaryFolder folder;
    for (const float fallback : {0.12f, 0.9f}) {
        GltfBuilder builder =
            fileWith({{"diffuseFactor", {0.5, 0.25, 0.125, 0.5}}, {"specularFactor", {0.04, 0.04, 0.04}}});
        json& material = builder.document["materials"][0];
        material["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 1, 1, fallback}}};
        EXPECT_EQ(builder.import(folder).materials[0].baseColour.a, 0.5f) << "opaque";
        material["alphaMode"] = "BLEND";
        EXPECT_EQ(builder.import(folder).materials[0].baseColour.a, std::min(fallback, 0.5f));
    }
}

TEST(SpecularGlossiness, TexturesAreCombinedPixelByPixel) {
    const TemporaryFolder folder;
    GltfBuilder builder = fileWith(json::parse(R"({"diffuseTexture": {"index": 0, "extensions":
        {"KHR_texture_transform": {"scale": [2, 3]}}}, "specularGlossinessTexture": {"index": 1, "extensions":
        {"KHR_texture_transform": {"scale": [2, 3]}}}})"));
    // A white, half transparent wall and gold: diffuse white, then black; specular 0.04 (56 of 255), then
    // gold.
    addTexture(builder, {255, 255, 255, 128, 0, 0, 0, 255}, 2, 1);
    addTexture(builder, {56, 56, 56, 51, 255, 226, 158, 204}, 2, 1);
    const Scene scene = builder.import(folder);
    const Material& material = scene.materials[0];
    EXPECT_EQ(material.baseColour, glm::vec4(1));
    EXPECT_EQ(material.metallic, 1);
    EXPECT_EQ(material.roughness, 1);
    EXPECT_EQ(material.baseColourTexture.scale, glm::vec2(2, 3));
    EXPECT_EQ(material.metallicRoughnessTexture.scale, glm::vec2(2, 3));
    const TextureImage& base = scene.images.at(static_cast<size_t>(material.baseColourTexture.image));
    const TextureImage& surface =
        scene.images.at(static_cast<size_t>(material.metallicRoughnessTexture.image));
    // The wall reflects 4 %, so that 96 % of white are diffuse: 251 of 255 in sRGB.
    EXPECT_THAT(base.rgba, ElementsAre(251, 251, 251, 128, 255, 226, 158, 255));
    EXPECT_THAT(surface.rgba, ElementsAre(255, 204, testing::Le(2), 255, 255, 51, 255, 255));
    EXPECT_THAT(scene.warnings, ElementsAre(converted));
}

TEST(SpecularGlossiness, APlainDielectricKeepsItsTexture) {
    const TemporaryFolder folder;
    GltfBuilder builder =
        fileWith(json::parse(R"({"diffuseTexture": {"index": 0}, "specularFactor": [0, 0, 0]})"));
    addTexture(builder, {10, 20, 30, 255}, 1, 1);
    const Scene scene = builder.import(folder);
    EXPECT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.materials[0].baseColourTexture.image, 0);
    EXPECT_EQ(scene.materials[0].baseColour, glm::vec4(1));
    EXPECT_FALSE(scene.materials[0].metallicRoughnessTexture.present());
}

TEST(SpecularGlossiness, EqualMaterialsShareTheirImagesAndDifferentPlacementIsTold) {
    const TemporaryFolder folder;
    GltfBuilder builder = fileWith(
        json::parse(R"({"diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1}})"));
    addTexture(builder, {10, 20, 30, 255, 40, 50, 60, 255}, 2, 1);
    addTexture(builder, {70, 70, 70, 70}, 1, 1);
    builder.document["materials"].push_back(builder.document["materials"][0]);
    builder.document["materials"].push_back(builder.document["materials"][0]);
    builder.document["materials"][2]["name"] = "apart";
    builder.document["materials"][2]["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseTexture"]
                    ["texCoord"] = 1;
    const Scene scene = builder.import(folder);
    EXPECT_EQ(scene.materials[0].baseColourTexture, scene.materials[1].baseColourTexture);
    EXPECT_EQ(scene.images.size(), 2u + 2u + 2u);
    EXPECT_THAT(scene.warnings,
                ElementsAre(converted, "the two textures of the specular-glossiness material 'apart' "
                                       "are placed differently: of the second one its mean counts"));
}

} // namespace
} // namespace kestrel::gltf_specular_test
