#include "scene/texture_arrays.h"
#include <gtest/gtest.h>
#include <set>
#include <tuple>

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

TEST(TextureArrays, ShareLayersWhereThereAreMoreImagesThanLayers) {
    const TextureArrays plain = textureArrays(sceneOf(std::vector<std::pair<int, int>>(10, {4, 4})),
                                              TextureRole::Colour, {.layers = 10});
    EXPECT_FALSE(plain.tiled());
    const TextureArrays tiled = textureArrays(sceneOf(std::vector<std::pair<int, int>>(11, {4, 4})),
                                              TextureRole::Colour, {.layers = 10});
    EXPECT_TRUE(tiled.tiled());
    ASSERT_EQ(tiled.arrays.size(), 1u);
    EXPECT_EQ(tiled.arrays[0].side, 4u);
    EXPECT_EQ(tiled.arrays[0].layerSide(), 8u);
    EXPECT_EQ(tiled.arrays[0].layers(), 3u);
    EXPECT_EQ(tiled.places[5].layer, 1);
    EXPECT_EQ(tiled.places[5].x, 4u);
    EXPECT_EQ(tiled.places[5].y, 0u);
    EXPECT_EQ(tiled.places[10].layer, 2);
    // As many as anyone may have: no place is given twice.
    const TextureArrays many =
        textureArrays(sceneOf(std::vector<std::pair<int, int>>(20'000, {2, 2})), TextureRole::Colour);
    EXPECT_LE(many.arrays[0].layers(), 2048u);
    std::set<std::tuple<int, int, std::uint32_t, std::uint32_t>> places;
    for (const TextureArrays::Place& place : many.places) {
        EXPECT_LE(place.x + 2, many.arrays[static_cast<size_t>(place.array)].layerSide());
        EXPECT_LE(place.y + 2, many.arrays[static_cast<size_t>(place.array)].layerSide());
        EXPECT_TRUE(places.emplace(place.array, place.layer, place.x, place.y).second);
    }
}

TEST(TextureArrays, AreSplitWhereOneTakesTooMuchAndOthersAreFree) {
    std::vector<std::pair<int, int>> sizes(9, {64, 64});
    sizes.emplace_back(4, 4);
    const TextureArrays arrays =
        textureArrays(sceneOf(sizes), TextureRole::Colour, {.arrayTexels = 4 * 64 * 64});
    EXPECT_EQ(sides(arrays), (std::vector<std::uint32_t>{4, 64, 64, 64}));
    EXPECT_EQ(
        arrays.arrays[1].images.size() + arrays.arrays[2].images.size() + arrays.arrays[3].images.size(), 9u);
    for (size_t i = 0; i < 9; ++i) {
        const TextureArrays::Place place = arrays.places[i];
        EXPECT_EQ(arrays.arrays[static_cast<size_t>(place.array)].images[static_cast<size_t>(place.layer)],
                  static_cast<int>(i));
    }
    EXPECT_EQ(textureArrays(sceneOf({{64, 64}}), TextureRole::Colour, {.arrayTexels = 10}).arrays.size(), 1u)
        << "a single image is not split";
}

TEST(TextureArrays, AreReducedWhereAllTogetherTakeTooMuch) {
    const Scene scene = sceneOf({{64, 64}, {64, 10}, {8, 8}});
    EXPECT_EQ(textureArrays(scene, TextureRole::Colour, {.texels = 2 * 64 * 64 + 64}).side, maxTextureSide);
    const TextureArrays reduced = textureArrays(scene, TextureRole::Colour, {.texels = 2 * 64 * 64 + 63});
    EXPECT_EQ(reduced.side, 32u);
    EXPECT_EQ(reduced.wantedTexels, 2u * 64 * 64 + 64);
    EXPECT_EQ(sides(reduced), (std::vector<std::uint32_t>{8, 32}));
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
