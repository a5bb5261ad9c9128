#include "scene/texture_arrays.h"
#include <gtest/gtest.h>

namespace kestrel {
namespace {

Scene sceneOf(const std::vector<std::pair<int, int>>& sizes) {
    Scene scene;
    for (const auto& [width, height] : sizes) {
        TextureImage image;
        image.width = width;
        image.height = height;
        scene.images.push_back(image);
        Material material;
        material.baseColourTexture.image = static_cast<int>(scene.images.size()) - 1;
        scene.materials.push_back(material);
    }
    return scene;
}

std::vector<std::uint32_t> sides(const TextureArrays& arrays) {
    std::vector<std::uint32_t> result;
    for (const auto& array : arrays.arrays) result.push_back(array.side);
    return result;
}

TEST(TextureArrays, AreTheLongerSideRoundedUp) {
    const TextureArrays arrays =
        textureArrays(sceneOf({{100, 30}, {64, 64}, {65, 1}, {1, 128}, {1, 1}}), TextureRole::Colour);
    EXPECT_EQ(sides(arrays), (std::vector<std::uint32_t>{1, 64, 128}));
    EXPECT_EQ(arrays.arrays[2].images, (std::vector<int>{0, 2, 3}));
    EXPECT_EQ(arrays.places[2].array, 2);
    EXPECT_EQ(arrays.places[2].layer, 1);
    EXPECT_EQ(arrays.places[4].array, 0);
}

TEST(TextureArrays, NeverMoreThanShadersTakeAndJoinTheCheapest) {
    // Joining 1 with 2 costs 3 texels, every other pair more.
    const TextureArrays arrays =
        textureArrays(sceneOf({{1, 1}, {2, 2}, {64, 64}, {256, 256}, {1024, 1024}}), TextureRole::Colour);
    EXPECT_EQ(sides(arrays), (std::vector<std::uint32_t>{2, 64, 256, 1024}));
    EXPECT_EQ(arrays.arrays[0].images, (std::vector<int>{0, 1}));
    std::vector<std::pair<int, int>> every;
    for (int side = 1; side <= 8192; side *= 2) every.emplace_back(side, side);
    const TextureArrays many = textureArrays(sceneOf(every), TextureRole::Colour);
    EXPECT_EQ(many.arrays.size(), size_t{maxTextureArrays});
    EXPECT_EQ(many.arrays.back().side, maxTextureSide);
    for (const auto& place : many.places) EXPECT_GE(place.layer, 0);
}

TEST(TextureArrays, HoldWhatTheRoleUses) {
    Scene scene = sceneOf({{4, 4}, {8, 8}});
    scene.materials[1].baseColourTexture.image = -1;
    scene.materials[1].normalTexture.image = 1;
    scene.materials[0].metallicRoughnessTexture.image = 0; // as colour and as data
    EXPECT_EQ(sides(textureArrays(scene, TextureRole::Colour)), (std::vector<std::uint32_t>{4}));
    EXPECT_EQ(sides(textureArrays(scene, TextureRole::Data)), (std::vector<std::uint32_t>{4, 8}));
    EXPECT_EQ(textureArrays(scene, TextureRole::Colour).places[1].array, -1);
    EXPECT_TRUE(textureArrays(Scene(), TextureRole::Data).arrays.empty());
}

} // namespace
} // namespace kestrel
