#include "core/error.h"
#include "image/flip.h"
#include "support/pattern.h"
#include "unit/image_flip_oracle.h"
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using test::pattern;

constexpr float defaultDensity = FlipOptions{}.pixelsPerDegree;

// Something like a rendered picture: shading, an edge, colours.
Image picture(int width, int height) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float u = static_cast<float>(x) / static_cast<float>(width);
            const float v = static_cast<float>(y) / static_cast<float>(height);
            image.at(x, y, 0) = 0.2F + 0.6F * u;
            image.at(x, y, 1) = x > y ? 0.7F : 0.3F * v;
            image.at(x, y, 2) = 0.5F + 0.4F * std::sin(9 * u * v);
        }
    return image;
}

Image noisy(const Image& image, float amount) {
    Image result = image;
    const Image noise = pattern(image.width, image.height, image.channels, 77);
    for (std::size_t i = 0; i < result.values.size(); ++i)
        result.values[i] = std::clamp(result.values[i] + amount * (noise.values[i] - 0.5F), 0.0F, 1.0F);
    return result;
}

double greatestDifference(const Image& a, const Image& b) {
    double greatest = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        greatest = std::max(greatest, std::abs(double{a.values[i]} - double{b.values[i]}));
    return greatest;
}

// The error of two constant greys by the formula: no features, no chroma, lightness alone.
double errorOfGreys(double lightnessDifference) {
    // CIELAB of the sRGB primaries green and blue, from the literature.
    const double greenL = 87.7347, greenA = -86.1827, greenB = 83.1793;
    const double blueL = 32.2970, blueA = 79.1875, blueB = -107.8602;
    const double da = 0.01 * (greenL * greenA - blueL * blueA);
    const double db = 0.01 * (greenL * greenB - blueL * blueB);
    const double greatest = std::pow(greenL - blueL + std::sqrt(da * da + db * db), 0.7);
    const double difference = std::pow(lightnessDifference, 0.7);
    const double knee = 0.4 * greatest;
    return difference < knee ? 0.95 * difference / knee
                             : 0.95 + 0.05 * (difference - knee) / (greatest - knee);
}

TEST(Flip, OfEqualImagesIsExactlyZero) {
    for (const bool hdr : {false, true}) {
        const FlipResult result = flip(picture(37, 21), picture(37, 21), {.hdr = hdr});
        EXPECT_TRUE(std::all_of(result.map.values.begin(), result.map.values.end(),
                                [](float value) { return value == 0; }));
        EXPECT_EQ(result.figures.max, 0);
        EXPECT_EQ(result.figures.weightedMedian, 0);
    }
}

TEST(Flip, OfConstantGreysFollowsTheFormula) {
    const FlipResult whole = flip(Image(30, 20, 1, 0), Image(30, 20, 1, 1));
    EXPECT_NEAR(whole.figures.mean, errorOfGreys(100), 1e-4);
    EXPECT_NEAR(whole.figures.min, whole.figures.max, 1e-5);
    // sRGB 0.5 is 0.21404 in linear light: L* = 116 * cbrt(0.21404) - 16.
    const FlipResult half = flip(Image(30, 20, 1, 0), Image(30, 20, 1, 0.5F));
    EXPECT_NEAR(half.figures.mean, errorOfGreys(116 * std::cbrt(0.2140411) - 16), 1e-4);
    EXPECT_NEAR(half.figures.weightedMedian, half.figures.mean, 1e-5);
}

TEST(Flip, OfGreenAgainstBlueIsOne) {
    Image green(16, 16, 3, 0);
    Image blue(16, 16, 3, 0);
    for (std::size_t i = 0; i < green.values.size(); i += 3) {
        green.values[i + 1] = 1;
        blue.values[i + 2] = 1;
    }
    EXPECT_NEAR(flip(green, blue).figures.min, 1, 2e-4); // the greatest difference of the gamut
}

TEST(Flip, EqualsThePlainFormOnASmallImage) {
    const Image reference = picture(26, 23);
    for (const Image& test : {noisy(reference, 0.6F), pattern(26, 23, 3, 4)})
        for (const float density : {defaultDensity, 30.0F})
            EXPECT_LT(greatestDifference(flip(reference, test, {.pixelsPerDegree = density}).map,
                                         test_oracle::plainFlip(reference, test, double{density})),
                      2e-4);
}

TEST(Flip, EqualsThePlainFormAcrossTheBandsOfItsWork) {
    const Image reference = pattern(3, 300, 3, 5);
    const Image test = noisy(reference, 0.5F);
    EXPECT_LT(greatestDifference(flip(reference, test).map,
                                 test_oracle::plainFlip(reference, test, double{defaultDensity})),
              2e-4);
}

TEST(Flip, IsSymmetricBoundedAndGrowsWithTheDifference) {
    const Image reference = picture(64, 40);
    double before = 0;
    for (const float amount : {0.02F, 0.1F, 0.4F, 1.0F}) {
        const Image test = noisy(reference, amount);
        const FlipResult there = flip(reference, test);
        const FlipResult back = flip(test, reference);
        EXPECT_EQ(there.map, back.map);
        EXPECT_GT(there.figures.mean, before);
        EXPECT_GE(there.figures.min, 0);
        EXPECT_LE(there.figures.max, 1);
        EXPECT_LE(there.figures.q1, there.figures.weightedMedian);
        EXPECT_LE(there.figures.weightedMedian, there.figures.q3);
        EXPECT_LE(there.figures.q3, there.figures.max);
        before = there.figures.mean;
    }
    double greys = 0;
    for (int i = 1; i <= 20; ++i) {
        const double error =
            flip(Image(4, 4, 1, 0), Image(4, 4, 1, static_cast<float>(i) / 20.0F)).figures.mean;
        EXPECT_GT(error, greys);
        greys = error;
    }
}

TEST(Flip, SeesFineNoiseLessFromFurtherAway) {
    const Image reference(64, 64, 1, 0.5F);
    Image checker = reference;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) checker.at(x, y) += (x + y) % 2 == 0 ? 0.1F : -0.1F;
    const double near = flip(reference, checker, {.pixelsPerDegree = 15}).figures.mean;
    const double far = flip(reference, checker, {.pixelsPerDegree = 120}).figures.mean;
    EXPECT_GT(near, 2 * far);
}

TEST(Flip, WorksOnEverySmallSize) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {17, 1}, {2, 3}}) {
        const FlipResult result = flip(Image(width, height, 1, 0), Image(width, height, 1, 1));
        EXPECT_NEAR(result.figures.mean, errorOfGreys(100), 1e-4);
    }
}

TEST(Flip, TakesGreyForEqualColoursAndClampsCodeValues) {
    const Image a = pattern(20, 20, 1, 1);
    const Image b = pattern(20, 20, 1, 2);
    EXPECT_EQ(flip(a, b).map, flip(convertChannels(a, 3), convertChannels(b, 4)).map);
    EXPECT_EQ(flip(Image(4, 4, 1, -2), Image(4, 4, 1, 9)).map,
              flip(Image(4, 4, 1, 0), Image(4, 4, 1, 1)).map);
}

TEST(Flip, MasksThePoolingNotTheFilters) {
    const Image reference(60, 20, 1, 0.2F);
    Image test = reference;
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) test.at(x, y) = 0.9F;
    Image right(60, 20, 1, 0);
    for (int y = 0; y < 20; ++y)
        for (int x = 35; x < 60; ++x) right.at(x, y) = 1; // further than the filters reach
    const FlipResult masked = flip(reference, test, {}, &right);
    EXPECT_EQ(masked.figures.max, 0);
    EXPECT_EQ(masked.map, flip(reference, test).map);
    Image left(60, 20, 1, 1);
    for (std::size_t i = 0; i < left.values.size(); ++i) left.values[i] -= right.values[i];
    EXPECT_GT(flip(reference, test, {}, &left).figures.mean, flip(reference, test).figures.mean);
    const Image none(60, 20, 1, 0);
    EXPECT_THROW(flip(reference, test, {}, &none), InputError);
    EXPECT_THROW(flip(reference, Image(60, 21, 1), {}), InputError);
}

TEST(FlipPooling, WeighsEachErrorByItself) {
    Image map(5, 1, 1);
    map.values = {0.5F, 0.125F, 0, 0.25F, 0.125F}; // sum 1; running over the sorted: 0, .125, .25, .5, 1
    const FlipFigures figures = poolFlip(map);
    EXPECT_DOUBLE_EQ(figures.mean, 0.2);
    EXPECT_DOUBLE_EQ(figures.q1, 0.25);            // .25 is not more than .25
    EXPECT_DOUBLE_EQ(figures.weightedMedian, 0.5); // .5 is not more than .5
    EXPECT_DOUBLE_EQ(figures.q3, 0.5);
    EXPECT_DOUBLE_EQ(figures.min, 0);
    EXPECT_DOUBLE_EQ(figures.max, 0.5);
    Image mask(5, 1, 1);
    mask.values = {0, 1, 0, 1, 1};
    const FlipFigures masked = poolFlip(map, &mask);
    EXPECT_DOUBLE_EQ(masked.mean, 0.5 / 3);
    EXPECT_DOUBLE_EQ(masked.weightedMedian, 0.25);
    EXPECT_DOUBLE_EQ(masked.min, 0.125);
}

// The tone map's inverse at 0.85, from the published coefficients.
double bright() {
    const double a = 0.36 * 2.51 - 0.85 * 0.36 * 2.43;
    const double b = 0.6 * 0.03 - 0.85 * 0.6 * 0.59;
    const double c = -0.85 * 0.14;
    return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

TEST(FlipHdr, ExposesFromTheBrightestPixelToTheMedian) {
    Image image(5, 1, 1);
    image.values = {1, 64, 2, 4, 0.5F}; // greatest 64, median 2: five stops apart
    const FlipExposures exposures = flipExposures(image);
    EXPECT_NEAR(exposures.start, std::log2(bright() / 64), 1e-6);
    EXPECT_NEAR(exposures.stop, std::log2(bright() / 2), 1e-6);
    EXPECT_EQ(exposures.count, 5);
    // Twice the light, one stop less.
    for (float& value : image.values) value *= 2;
    EXPECT_NEAR(flipExposures(image).start, exposures.start - 1, 1e-6);
}

TEST(FlipHdr, HasFiniteExposuresForEveryImage) {
    const FlipExposures black = flipExposures(Image(4, 4, 3, 0));
    EXPECT_EQ(black.start, 0);
    EXPECT_EQ(black.stop, 0);
    EXPECT_EQ(black.count, 2);
    Image mostlyBlack(5, 1, 1);
    mostlyBlack.values = {0, 0, 0, 8, 2};
    const FlipExposures some = flipExposures(mostlyBlack); // of 2 and 8 the upper median is 8
    EXPECT_NEAR(some.start, std::log2(bright() / 8), 1e-6);
    EXPECT_NEAR(some.stop, std::log2(bright() / 8), 1e-6);
    EXPECT_EQ(some.count, 2);
    EXPECT_GT(flip(mostlyBlack, Image(5, 1, 1, 0), {.hdr = true}).figures.mean, 0);
    EXPECT_EQ(flip(Image(4, 4, 3, 0), Image(4, 4, 3, 0), {.hdr = true}).figures.max, 0);
    Image extreme(3, 1, 1);
    extreme.values = {1e-38F, 1, 3e38F};
    const FlipResult result = flip(extreme, Image(3, 1, 1, 3e38F), {.hdr = true});
    EXPECT_GE(result.figures.min, 0);
    EXPECT_LE(result.figures.max, 1);
}

TEST(FlipHdr, IsTheMaximumOfLdrFlipOverTheExposures) {
    Image reference = picture(20, 16);
    for (float& value : reference.values) value *= value * 30;
    Image test = reference;
    for (int y = 4; y < 9; ++y)
        for (int x = 3; x < 11; ++x) test.at(x, y, 1) *= 1.7F;
    const FlipResult result = flip(reference, test, {.hdr = true});
    ASSERT_GE(result.exposures.count, 2);
    Image expected(20, 16, 1);
    for (int i = 0; i < result.exposures.count; ++i) {
        const double stops = result.exposures.start + i * (result.exposures.stop - result.exposures.start) /
                                                          (result.exposures.count - 1);
        const Image error =
            test_oracle::plainFlipOfLinear(test_oracle::exposed(reference, stops),
                                           test_oracle::exposed(test, stops), double{defaultDensity});
        for (std::size_t pixel = 0; pixel < expected.values.size(); ++pixel)
            expected.values[pixel] = std::max(expected.values[pixel], error.values[pixel]);
    }
    EXPECT_LT(greatestDifference(result.map, expected), 3e-4);
}

TEST(FlipHdr, DoesNotDependOnTheUnitOfLight) {
    Image reference = picture(24, 24);
    Image test = noisy(reference, 0.4F);
    const double error = flip(reference, test, {.hdr = true}).figures.mean;
    EXPECT_GT(error, 0.01);
    for (float& value : reference.values) value *= 1024;
    for (float& value : test.values) value *= 1024;
    EXPECT_NEAR(flip(reference, test, {.hdr = true}).figures.mean, error, 1e-5);
}

} // namespace
} // namespace kestrel
