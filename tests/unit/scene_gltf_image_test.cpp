// Images of glTF files: encodings, which one a texture shows, and what is done with too much of them.
#include "scene/gltf_image.h"
#include "scene/gltf_import.h"
#include "support/gltf_builder.h"
#include "support/png.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#ifdef KESTREL_HAS_WEBP
#include <webp/encode.h>
#endif

namespace kestrel::gltf_image_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::importMessage;
using test::pngOf;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

// A smooth picture with alpha.
std::vector<std::uint8_t> pixels(int width, int height) {
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int value : {255 * x / width, 255 * y / height, 128, 255 - 100 * x / width})
                rgba.push_back(static_cast<std::uint8_t>(value));
    return rgba;
}

// A triangle whose material shows texture 0; images are put in by the caller.
GltfBuilder textured() {
    GltfBuilder builder = test::triangleFile();
    builder.document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder.document["meshes"][0]["primitives"][0]["material"] = 0;
    builder.document["textures"] = {{{"source", 0}}};
    return builder;
}

void addImage(GltfBuilder& builder, const std::vector<std::uint8_t>& bytes, const char* type = "image/png") {
    builder.document["images"].push_back({{"bufferView", builder.view(bytes)}, {"mimeType", type}});
}

Scene import(const GltfBuilder& builder, const GltfLimits& limits) {
    const TemporaryFolder folder;
    writeFile(folder / "i.gltf", builder.text());
    return importGltf(folder / "i.gltf", {}, limits);
}

#ifdef KESTREL_HAS_WEBP

std::vector<std::uint8_t> webpOf(const std::vector<std::uint8_t>& rgba, int width, int height,
                                 bool lossless) {
    std::uint8_t* bytes = nullptr;
    const size_t size = lossless ? WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &bytes)
                                 : WebPEncodeRGBA(rgba.data(), width, height, 4 * width, 95, &bytes);
    std::vector<std::uint8_t> result(bytes, bytes + size);
    WebPFree(bytes);
    return result;
}

GltfBuilder webpFile(const std::vector<std::uint8_t>& webp) {
    GltfBuilder builder = textured();
    addImage(builder, webp, "image/webp");
    builder.document["textures"] = json::parse(R"([{"extensions": {"EXT_texture_webp": {"source": 0}}}])");
    builder.document["extensionsRequired"] = {"EXT_texture_webp"};
    return builder;
}

TEST(GltfImages, WebpGivesThePictureOfThePng) {
    const TemporaryFolder folder;
    const std::vector<std::uint8_t> rgba = pixels(40, 24);
    const Scene exact = webpFile(webpOf(rgba, 40, 24, true)).import(folder);
    EXPECT_TRUE(exact.warnings.empty());
    ASSERT_EQ(exact.images.size(), 1u);
    EXPECT_EQ(exact.images[0].rgba, rgba);
    EXPECT_TRUE(exact.materials[0].baseColourTexture.present());
    const Scene lossy = webpFile(webpOf(rgba, 40, 24, false)).import(folder);
    ASSERT_EQ(lossy.images[0].rgba.size(), rgba.size());
    double sum = 0;
    for (size_t i = 0; i < rgba.size(); ++i) sum += std::abs(int(lossy.images[0].rgba[i]) - int(rgba[i]));
    EXPECT_LT(sum / static_cast<double>(rgba.size()), 3) << "mean difference at quality 95, of 255";
}

TEST(GltfImages, TheWebpIsTakenRatherThanItsFallback) {
    const TemporaryFolder folder;
    GltfBuilder builder = webpFile(webpOf(pixels(8, 8), 8, 8, true));
    addImage(builder, pngOf(pixels(4, 4), 4, 4));
    builder.document["textures"][0]["source"] = 1;
    builder.document.erase("extensionsRequired");
    const Scene scene = builder.import(folder);
    ASSERT_EQ(scene.images.size(), 1u) << "the fallback is not decoded";
    EXPECT_EQ(scene.images[0].width, 8);
}

TEST(GltfImages, EveryTruncationOfAWebpIsAnErrorAndAnyMutationIsSurvived) {
    for (const bool lossless : {true, false}) {
        const std::vector<std::uint8_t> whole = webpOf(pixels(16, 16), 16, 16, lossless);
        for (size_t size = 16; size < whole.size(); size += 7)
            EXPECT_THAT(
                importMessage(webpFile({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)})),
                HasSubstr("images[0] is a broken image"))
                << size << " of " << whole.size();
        std::mt19937 random(1);
        for (int round = 0; round < 200; ++round) {
            std::vector<std::uint8_t> bent = whole;
            for (int i = 0; i < 3; ++i) bent[random() % bent.size()] = static_cast<std::uint8_t>(random());
            EXPECT_EQ(importMessage(webpFile(bent), {.decodedPixels = 1 << 20}).find('\n'),
                      std::string::npos);
        }
    }
}

#endif

TEST(GltfImages, BasisTexturesAreLeftOutForTheirFallbackOrWithAWarning) {
    const TemporaryFolder folder;
    const std::vector<std::uint8_t> ktx = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
    GltfBuilder builder = textured();
    addImage(builder, ktx, "image/ktx2");
    addImage(builder, pngOf(pixels(4, 4), 4, 4));
    builder.document["textures"] =
        json::parse(R"([{"source": 1, "extensions": {"KHR_texture_basisu": {"source": 0}}}])");
    const Scene fallback = builder.import(folder);
    EXPECT_EQ(fallback.images.at(0).width, 4);
    EXPECT_THAT(fallback.warnings, ElementsAre("the extension KHR_texture_basisu is ignored"));
    builder.document["textures"][0].erase("source");
    const Scene without = builder.import(folder);
    EXPECT_FALSE(without.materials[0].baseColourTexture.present());
    EXPECT_THAT(without.warnings, ElementsAre("the extension KHR_texture_basisu is ignored",
                                              "textures[0] has no image that can be read and is ignored"));
    builder.document["extensionsRequired"] = {"KHR_texture_basisu"};
    EXPECT_THAT(importMessage(builder),
                HasSubstr("requires extensions that Kestrel lacks: KHR_texture_basisu (no decoder "
                          "is packaged: store the textures as PNG, JPEG or WebP)"));
    builder = textured();
    addImage(builder, ktx);
    EXPECT_THAT(builder.import(folder).warnings,
                ElementsAre("images[0] is KTX 2, for which no decoder is packaged, and is ignored"));
}

TEST(GltfImages, WhatNoTextureShowsIsNotRead) {
    const TemporaryFolder folder;
    GltfBuilder builder = textured();
    addImage(builder, pngOf(pixels(4, 4), 4, 4));
    builder.document["images"].push_back({{"uri", "not-there.png"}});
    EXPECT_EQ(builder.import(folder).images.size(), 1u);
}

TEST(GltfImages, TooManyPixelsAreReducedWithAWarningThatNamesFigureAndLimit) {
    GltfBuilder builder = textured();
    builder.document["textures"] = builder.document["materials"] = json::array();
    // 64 x 64 + 32 x 8 + 1 x 1: 4353 pixels.
    for (const auto& [width, height] : {std::pair(64, 64), std::pair(32, 8), std::pair(1, 1)}) {
        addImage(builder, pngOf(pixels(width, height), width, height));
        const size_t index = builder.document["images"].size() - 1;
        builder.document["textures"].push_back({{"source", index}});
        builder.document["materials"].push_back({{"normalTexture", {{"index", index}}}});
    }
    EXPECT_TRUE(import(builder, {.pixels = 4353}).warnings.empty());
    const Scene reduced = import(builder, {.pixels = 1300});
    EXPECT_THAT(reduced.warnings,
                ElementsAre("the images have 4353 pixels in all, at most 1300 are kept: they are "
                            "reduced to 32 a side"));
    ASSERT_EQ(reduced.images.size(), 3u);
    EXPECT_EQ(reduced.images[0].width, 32);
    EXPECT_EQ(reduced.images[1].width, 32);
    EXPECT_EQ(reduced.images[1].height, 8);
    EXPECT_EQ(reduced.images[2].width, 1);
    // The mean of two by two: 255 * x / 64 of x = 2 and 3.
    EXPECT_NEAR(reduced.images[0].rgba[4], 255 * 2.5 / 64, 1);
    EXPECT_THAT(importMessage(builder, {.pixels = 2}), HasSubstr("has 3 images; at most 2 pixels are kept"));
    EXPECT_THAT(
        importMessage(builder, {.decodedPixels = 4352}),
        HasSubstr("images[2] has 1 x 1 pixels; at most 16384 to a side and 4352 in all images are decoded"));
}

} // namespace
} // namespace kestrel::gltf_image_test
