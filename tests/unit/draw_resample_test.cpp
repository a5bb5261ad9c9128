#include "draw/resample.h"
#include "image/image.h"
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

namespace kestrel {
namespace {

TextureImage greyImage(int width, int height, const std::vector<int>& values) {
    TextureImage image{"grey", width, height, {}};
    for (const int value : values) {
        const auto byte = static_cast<std::uint8_t>(value);
        image.rgba.insert(image.rgba.end(), {byte, byte, byte, byte});
    }
    return image;
}

std::vector<int> channel(const std::vector<std::uint8_t>& rgba, size_t which) {
    std::vector<int> result;
    for (size_t i = which; i < rgba.size(); i += 4) result.push_back(rgba[i]);
    return result;
}

TEST(Resample, TheRightSizeComesBackAsItIs) {
    const TextureImage image = greyImage(2, 2, {1, 77, 200, 255});
    for (const bool srgb : {false, true})
        EXPECT_EQ(resampleToSquare(image, 2, srgb, ResampleFilter::Smooth), image.rgba);
}

TEST(Resample, AConstantStaysConstant) {
    for (const auto& [width, height] : {std::pair{3, 5}, std::pair{1, 7}, std::pair{9, 2}}) {
        const TextureImage image =
            greyImage(width, height, std::vector<int>(static_cast<size_t>(width * height), 93));
        for (const std::uint32_t side : {1U, 4U, 16U})
            for (const bool srgb : {false, true})
                EXPECT_EQ(resampleToSquare(image, side, srgb, ResampleFilter::Smooth),
                          std::vector<std::uint8_t>(size_t{4} * side * side, 93));
    }
}

TEST(Resample, HalvingWeighsNeighboursAsATriangle) {
    // Twice as wide as the step: around each pair (1 3 3 1) / 8, with the border repeated.
    const auto small = resampleToSquare(greyImage(4, 1, {0, 80, 160, 240}), 2, false, ResampleFilter::Smooth);
    EXPECT_EQ(channel(small, 0)[0], (0 * 1 + 0 * 3 + 80 * 3 + 160) / 8);
    EXPECT_EQ(channel(small, 0)[1], (80 + 160 * 3 + 240 * 3 + 240 * 1) / 8);
}

TEST(Resample, DoublingInterpolates) {
    const auto large = resampleToSquare(greyImage(2, 1, {0, 100}), 4, false, ResampleFilter::Smooth);
    EXPECT_EQ(channel(large, 0)[0], 0);
    EXPECT_EQ(channel(large, 0)[1], 25);
    EXPECT_EQ(channel(large, 0)[2], 75);
    EXPECT_EQ(channel(large, 0)[3], 100);
}

TEST(Resample, ColoursAreMixedInLinearLightAlphaIsNot) {
    const auto mean = resampleToSquare(greyImage(2, 1, {0, 255}), 1, true, ResampleFilter::Smooth);
    EXPECT_EQ(mean[0], std::lround(255 * linearToSrgb(0.5F)));
    EXPECT_EQ(mean[3], 128);
}

TEST(Resample, NearestKeepsHardBorders) {
    const auto large = resampleToSquare(greyImage(3, 1, {10, 20, 30}), 4, true, ResampleFilter::Nearest);
    for (size_t y = 0; y < 4; ++y)
        for (size_t x = 0; x < 4; ++x)
            EXPECT_EQ(large[4 * (4 * y + x)], std::vector<int>({10, 20, 20, 30})[x]);
}

TEST(Resample, AnEmptyImageIsWhite) {
    EXPECT_EQ(resampleToSquare({}, 1, true, ResampleFilter::Smooth), std::vector<std::uint8_t>(4, 255));
}

} // namespace
} // namespace kestrel
