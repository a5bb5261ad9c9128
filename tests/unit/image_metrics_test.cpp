#include "core/error.h"
#include "image/error_figures.h"
#include "image/metrics.h"
#include "support/message.h"
#include "support/pattern.h"
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace kestrel {
namespace {

using test::messageOf;
using test::pattern;
using testing::HasSubstr;

TEST(Metrics, MseOfConstantImagesIsTheSquaredDifference) {
    const Image a(5, 3, 3, 0.25F);
    const Image b(5, 3, 3, 0.75F);
    EXPECT_DOUBLE_EQ(meanSquaredError(a, b), 0.25);
    EXPECT_DOUBLE_EQ(meanSquaredError(b, a), 0.25);
    EXPECT_EQ(meanSquaredError(a, a), 0);
}

TEST(Metrics, MseIsAMeanOverPixelsAndChannels) {
    const Image a(2, 1, 3, 0);
    Image b = a;
    b.at(1, 0, 2) = 3; // one of six values differs by 3
    EXPECT_DOUBLE_EQ(meanSquaredError(a, b), 9.0 / 6.0);
}

TEST(Metrics, MseCountsOnlyPixelsOfTheMask) {
    const Image a(2, 2, 1, 0);
    Image b = a;
    b.at(0, 0) = 1;
    b.at(1, 1) = 2;
    Image mask(2, 2, 1, 0);
    mask.at(1, 1) = 1;
    mask.at(0, 1) = 0.51F;
    mask.at(0, 0) = 0.5F; // not greater than 0.5
    EXPECT_DOUBLE_EQ(meanSquaredError(a, b, &mask), 4.0 / 2.0);
    const Image everywhere(2, 2, 1, 1);
    EXPECT_DOUBLE_EQ(meanSquaredError(a, b, &everywhere), meanSquaredError(a, b));
}

TEST(Metrics, PsnrFollowsItsFormula) {
    EXPECT_DOUBLE_EQ(peakSignalToNoise(0.01), 20);
    EXPECT_DOUBLE_EQ(peakSignalToNoise(1), 0);
    EXPECT_DOUBLE_EQ(peakSignalToNoise(1, 10), 20);
    EXPECT_EQ(peakSignalToNoise(0), std::numeric_limits<double>::infinity());
}

TEST(Metrics, SsimOfEqualImagesIsOne) {
    for (const int size : {1, 2, 11, 40}) {
        const Image image = pattern(size, size + 3, 3);
        EXPECT_DOUBLE_EQ(structuralSimilarity(image, image), 1) << size;
    }
}

TEST(Metrics, SsimOfAConstantShiftFollowsItsFormula) {
    // Without variance only the luminance term remains: (2ab + C1) / (a^2 + b^2 + C1).
    const double a = 0.25;
    const double b = 0.75;
    const double c1 = 0.01 * 0.01;
    const double expected = (2 * a * b + c1) / (a * a + b * b + c1);
    EXPECT_NEAR(structuralSimilarity(Image(20, 9, 1, 0.25F), Image(20, 9, 1, 0.75F)), expected, 1e-6);
    // The dynamic range scales the constants: ten times the values on ten times the range.
    EXPECT_NEAR(structuralSimilarity(Image(4, 4, 1, 2.5F), Image(4, 4, 1, 7.5F), nullptr, 10), expected,
                1e-6);
}

TEST(Metrics, SsimOfOnePixelFollowsTheDefinitionDirectly) {
    // The definition evaluated at the centre of an 11x11 image, where the window is whole.
    const Image a = pattern(11, 11, 1, 3);
    const Image b = pattern(11, 11, 1, 4);
    double total = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
    for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 11; ++x) {
            const double weight = std::exp(-((x - 5) * (x - 5) + (y - 5) * (y - 5)) / (2 * 1.5 * 1.5));
            const double va = double{a.at(x, y)};
            const double vb = double{b.at(x, y)};
            total += weight;
            ma += weight * va;
            mb += weight * vb;
            aa += weight * va * va;
            bb += weight * vb * vb;
            ab += weight * va * vb;
        }
    ma /= total, mb /= total, aa /= total, bb /= total, ab /= total;
    const double c1 = 1e-4;
    const double c2 = 9e-4;
    const double expected = (2 * ma * mb + c1) * (2 * (ab - ma * mb) + c2) /
                            ((ma * ma + mb * mb + c1) * (aa - ma * ma + bb - mb * mb + c2));
    EXPECT_NEAR(double{structuralSimilarityMap(a, b).at(5, 5)}, expected, 1e-6);
}

TEST(Metrics, SsimIsSymmetricBoundedAndFallsWithNoise) {
    const Image a = pattern(40, 30, 1, 5);
    double before = 1;
    for (const float amount : {0.05F, 0.2F, 0.5F, 1.0F}) {
        Image b = a;
        const Image noise = pattern(40, 30, 1, 9);
        for (std::size_t i = 0; i < b.values.size(); ++i) b.values[i] += amount * (noise.values[i] - 0.5F);
        const double value = structuralSimilarity(a, b);
        EXPECT_DOUBLE_EQ(value, structuralSimilarity(b, a));
        EXPECT_LT(value, before);
        EXPECT_GE(value, -1);
        before = value;
    }
    Image inverse = a;
    for (float& value : inverse.values) value = 1 - value;
    EXPECT_LT(structuralSimilarity(a, inverse), 0);
}

TEST(Metrics, SsimIsPooledOverTheMask) {
    const Image a(30, 30, 1, 0.5F);
    Image b = a;
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 10; ++x) b.at(x, y) = 0.1F;
    Image right(30, 30, 1, 0);
    for (int y = 0; y < 30; ++y)
        for (int x = 15; x < 30; ++x) right.at(x, y) = 1; // no window of these reaches column 9
    EXPECT_DOUBLE_EQ(structuralSimilarity(a, b, &right), 1);
    EXPECT_LT(structuralSimilarity(a, b), 0.9);
}

TEST(Metrics, RefuseWhatCannotBeCompared) {
    const Image a(4, 3, 1, 0);
    EXPECT_EQ(messageOf([&] { requireComparable(a, Image(3, 4, 1), nullptr); }),
              "the reference has the size 4x3 and the test image 3x4: they must be equal");
    const Image smallMask(2, 2, 1, 1);
    EXPECT_EQ(messageOf([&] { requireComparable(a, a, &smallMask); }),
              "the mask has the size 2x2 and the images 4x3: they must be equal");
    const Image colorMask(4, 3, 3, 1);
    EXPECT_EQ(messageOf([&] { requireComparable(a, a, &colorMask); }),
              "the mask has 3 channels instead of 1");
    const Image emptyMask(4, 3, 1, 0.5F);
    EXPECT_EQ(messageOf([&] { requireComparable(a, a, &emptyMask); }), "the mask leaves no pixel to compare");
    Image broken = a;
    broken.at(2, 1) = std::numeric_limits<float>::infinity();
    EXPECT_EQ(messageOf([&] { requireComparable(a, broken, nullptr); }),
              "the test image has 1 value that is not finite; the first is inf at pixel (2, 1)");
    broken.at(3, 2) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(messageOf([&] { requireComparable(broken, a, nullptr); }),
                HasSubstr("the reference has 2 values that are not finite"));
    EXPECT_THAT(messageOf([&] { requireComparable({}, {}, nullptr); }), HasSubstr("empty"));
}

TEST(ErrorFigures, OfEqualImagesAreZeroAndInfinite) {
    const Image image = pattern(17, 13, 3);
    for (const bool hdr : {false, true}) {
        const ErrorFigures figures = measureError(image, image, {.hdr = hdr});
        EXPECT_EQ(figures.mse, 0);
        EXPECT_EQ(figures.rmse, 0);
        EXPECT_TRUE(std::isinf(figures.psnr));
        EXPECT_DOUBLE_EQ(figures.ssim, 1);
        EXPECT_EQ(figures.flip.mean, 0);
        EXPECT_EQ(figures.flip.max, 0);
        EXPECT_EQ(toJson(figures),
                  R"({"mse":0.0,"rmse":0.0,"psnr":null,"ssim":1.0,"flip":{"mean":0.0,"weighted_median":0.0,)"
                  R"("q1":0.0,"q3":0.0,"min":0.0,"max":0.0}})");
    }
}

TEST(ErrorFigures, DependOnTheRangeOfAnHdrReference) {
    Image reference(8, 8, 1, 1);
    reference.at(0, 0) = 10;
    Image test = reference;
    test.at(7, 7) = 2;
    const ErrorFigures hdr = measureError(reference, test, {.hdr = true});
    EXPECT_DOUBLE_EQ(hdr.mse, 1.0 / 64);
    EXPECT_DOUBLE_EQ(hdr.rmse, 1.0 / 8);
    EXPECT_DOUBLE_EQ(hdr.psnr, 10 * std::log10(100 * 64.0));
}

TEST(ErrorFigures, AreWithoutWhatNobodyAsksFor) {
    const Image reference = pattern(16, 16, 3, 2), test = pattern(16, 16, 3, 8);
    const ErrorFigures all = measureError(reference, test);
    const ErrorFigures squares = measureError(reference, test, {.ssim = false, .flip = false});
    EXPECT_EQ(squares.mse, all.mse);
    EXPECT_EQ(squares.rmse, all.rmse);
    EXPECT_EQ(squares.ssim, 0);
    EXPECT_EQ(squares.flip.mean, 0);
    EXPECT_EQ(measureError(reference, test, {.flip = false}).ssim, all.ssim);
    EXPECT_EQ(measureError(reference, test, {.ssim = false}).flip.mean, all.flip.mean);
}

TEST(ErrorFigures, TakeGreyForEqualColoursAndLeaveAlphaOut) {
    const Image grey = pattern(16, 16, 1, 2);
    const Image other = pattern(16, 16, 1, 8);
    Image color = convertChannels(other, 4);
    for (std::size_t i = 3; i < color.values.size(); i += 4) color.values[i] = 0.1F; // alpha
    Image map;
    const ErrorFigures a = measureError(grey, other, {}, &map);
    const ErrorFigures b = measureError(grey, color);
    EXPECT_NEAR(a.mse, b.mse, 1e-12);
    EXPECT_NEAR(a.ssim, b.ssim, 1e-5);
    EXPECT_NEAR(a.flip.mean, b.flip.mean, 1e-9);
    EXPECT_TRUE(map.sameSize(grey));
    EXPECT_NEAR(meanOverMask(map, nullptr), a.flip.mean, 1e-12);
}

} // namespace
} // namespace kestrel
