#include "image/colormap.h"
#include "image/image.h"
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace kestrel {
namespace {

TEST(Image, KeepsRowsTopToBottomWithInterleavedChannels) {
    Image image(3, 2, 2);
    image.at(2, 1, 1) = 7;
    EXPECT_EQ(image.values.size(), 12U);
    EXPECT_EQ(image.values[11], 7);
    EXPECT_EQ(image.index(1, 1), 8U);
    EXPECT_EQ(image.sizeText(), "3x2");
}

TEST(Image, CropsAPart) {
    Image image(4, 3, 1);
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = static_cast<float>(i);
    const Image part = crop(image, 1, 1, 2, 2);
    EXPECT_EQ(part.values, (std::vector<float>{5, 6, 9, 10}));
    EXPECT_EQ(crop(image, 0, 0, 4, 3), image);
}

TEST(Image, ConvertsBetweenAllNumbersOfChannels) {
    const auto converted = [](std::vector<float> pixel, int channels) {
        Image image(1, 1, static_cast<int>(pixel.size()));
        image.values = std::move(pixel);
        return convertChannels(image, channels).values;
    };
    using Values = std::vector<float>;
    EXPECT_EQ(converted({0.5F}, 3), (Values{0.5F, 0.5F, 0.5F}));
    EXPECT_EQ(converted({0.5F}, 4), (Values{0.5F, 0.5F, 0.5F, 1}));
    EXPECT_EQ(converted({0.5F}, 2), (Values{0.5F, 0.5F}));
    EXPECT_EQ(converted({0.25F, 0.5F}, 1), (Values{0.25F}));
    EXPECT_EQ(converted({0.25F, 0.5F}, 3), (Values{0.25F, 0.5F, 0}));
    EXPECT_EQ(converted({0.25F, 0.5F}, 4), (Values{0.25F, 0.5F, 0, 1}));
    EXPECT_EQ(converted({1, 2, 3, 0.5F}, 3), (Values{1, 2, 3}));
    EXPECT_EQ(converted({1, 2, 3}, 4), (Values{1, 2, 3, 1}));
    EXPECT_FLOAT_EQ(converted({1, 0, 0}, 1)[0], 0.2126F);
    EXPECT_FLOAT_EQ(converted({0, 1, 0, 0}, 1)[0], 0.7152F);
    EXPECT_FLOAT_EQ(converted({0, 0, 1}, 1)[0], 0.0722F);
}

TEST(Image, KnowsTheCurveOfSrgb) {
    EXPECT_EQ(linearToSrgb(0.0F), 0.0F);
    EXPECT_NEAR(linearToSrgb(1.0F), 1.0F, 1e-6);
    EXPECT_NEAR(linearToSrgb(0.5F), 0.735357F, 1e-5);  // 1.055 * 0.5^(1/2.4) - 0.055
    EXPECT_NEAR(srgbToLinear(0.5F), 0.214041F, 1e-5);  // ((0.5 + 0.055) / 1.055)^2.4
    EXPECT_NEAR(linearToSrgb(0.001F), 0.01292F, 1e-7); // the linear piece
    EXPECT_NEAR(srgbToLinear(0.02F), 0.02F / 12.92F, 1e-7);
    for (int i = 0; i <= 1000; ++i) {
        const float value = static_cast<float>(i) / 1000.0F;
        EXPECT_NEAR(srgbToLinear(linearToSrgb(value)), value, 2e-5F);
    }
}

TEST(Image, LeavesAlphaUnencoded) {
    Image image(1, 1, 4, 0.5F);
    const Image encoded = linearToSrgb(image);
    EXPECT_NEAR(encoded.at(0, 0, 0), 0.735357F, 1e-5);
    EXPECT_EQ(encoded.at(0, 0, 3), 0.5F);
    EXPECT_NEAR(srgbToLinear(encoded).at(0, 0, 2), 0.5F, 1e-5);
}

TEST(ColorMap, HasThePublishedEnds) {
    const auto code = [](ColorMap map, float value) {
        const auto color = colorOf(map, value);
        return std::array<int, 3>{static_cast<int>(std::lround(color[0] * 255)),
                                  static_cast<int>(std::lround(color[1] * 255)),
                                  static_cast<int>(std::lround(color[2] * 255))};
    };
    using Code = std::array<int, 3>;
    EXPECT_EQ(code(ColorMap::Magma, 0), (Code{0, 0, 4}));
    EXPECT_EQ(code(ColorMap::Magma, 1), (Code{252, 253, 191}));
    EXPECT_EQ(code(ColorMap::Magma, 0.5F), (Code{183, 55, 121}));
    EXPECT_EQ(code(ColorMap::Viridis, 0), (Code{68, 1, 84}));
    EXPECT_EQ(code(ColorMap::Viridis, 1), (Code{253, 231, 37}));
    EXPECT_EQ(code(ColorMap::Magma, -3), code(ColorMap::Magma, 0));
    EXPECT_EQ(code(ColorMap::Magma, 3), code(ColorMap::Magma, 1));
    EXPECT_EQ(code(ColorMap::Magma, std::numeric_limits<float>::quiet_NaN()), code(ColorMap::Magma, 1));
}

TEST(ColorMap, GrowsLighterWithTheError) {
    for (const ColorMap map : {ColorMap::Magma, ColorMap::Viridis}) {
        float before = -1;
        for (int i = 0; i < 256; ++i) {
            const auto color = colorOf(map, static_cast<float>(i) / 255.0F);
            // Equal steps of lightness; rounding to 8 bits may undo a step.
            const float light =
                luminance(srgbToLinear(color[0]), srgbToLinear(color[1]), srgbToLinear(color[2]));
            EXPECT_GT(light, before - 2e-3F) << i;
            before = light;
        }
    }
}

TEST(ColorMap, MapsAnImage) {
    Image error(2, 1, 1);
    error.values = {0, 1};
    const Image colors = heatMap(error);
    ASSERT_EQ(colors.channels, 3);
    EXPECT_EQ(colors.at(0, 0, 2), 4.0F / 255.0F);
    EXPECT_EQ(colors.at(1, 0, 0), 252.0F / 255.0F);
}

} // namespace
} // namespace kestrel
