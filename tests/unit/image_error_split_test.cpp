// The error taken apart, on images whose parts are known.
#include "core/error.h"
#include "image/error_split.h"
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace kestrel {
namespace {

constexpr int side = 256;

// A truth with a representation that is off by `bias` x a wave, and an algorithm that is off by `off` x the
// same wave plus one at a right angle to it, with noise of these deviations.
struct Case {
    double bias, along, across, technique, exact, reference;
};

struct Halves {
    ImageHalves technique, exact, reference;
};

Halves halvesOf(const Case& c, int channels = 1) {
    Halves made;
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (size_t half = 0; half < 2; ++half) {
        for (Image* image : {&made.technique[half], &made.exact[half], &made.reference[half]})
            *image = Image(side, side, channels);
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const double turn = 2 * std::numbers::pi / side;
                const double wave = std::numbers::sqrt2 * std::sin(4 * turn * x);
                const double other = std::numbers::sqrt2 * std::cos(6 * turn * y);
                const double truth = 0.5 + 0.2 * std::sin(turn * (x + y));
                for (int k = 0; k < channels; ++k) {
                    const size_t i = (static_cast<size_t>(y) * side + x) * channels + k;
                    const double exact = truth + c.bias * wave;
                    // The technique and the exact tracing of a half share a part of their noise.
                    const double shared = normal(random);
                    made.reference[half].values[i] = static_cast<float>(truth + c.reference * normal(random));
                    made.exact[half].values[i] = static_cast<float>(exact + c.exact * shared);
                    made.technique[half].values[i] =
                        static_cast<float>(exact + c.along * wave + c.across * other +
                                           c.technique * (0.6 * shared + 0.8 * normal(random)));
                }
            }
    }
    return made;
}

TEST(ErrorSplit, FindsEachPartThroughTheNoise) {
    // Noise of three times the error that is looked for.
    const Case c{0.05, 0.03, 0.04, 0.15, 0.1, 0.05};
    for (const int channels : {1, 3}) {
        const Halves h = halvesOf(c, channels);
        const ErrorSplit split = splitError(h.technique, h.exact, h.reference);
        EXPECT_NEAR(split.representation, c.bias * c.bias, 0.0002);
        EXPECT_NEAR(split.algorithm, c.along * c.along + c.across * c.across, 0.0003);
        EXPECT_NEAR(split.cross, 2 * c.bias * c.along, 0.0004);
        EXPECT_NEAR(split.sampling, c.technique * c.technique, 0.0005);
        EXPECT_NEAR(split.referenceNoise, c.reference * c.reference, 0.0001);
        EXPECT_NEAR(split.sum(), split.mse, 0.01 * split.mse);
    }
}

TEST(ErrorSplit, WhatMakesUpForEachOtherHasACrossTermBelowZero) {
    const Halves h = halvesOf({0.08, -0.08, 0, 0, 0, 0});
    const ErrorSplit split = splitError(h.technique, h.exact, h.reference);
    EXPECT_NEAR(split.representation, 0.0064, 1e-6);
    EXPECT_NEAR(split.algorithm, 0.0064, 1e-6);
    EXPECT_NEAR(split.cross, -0.0128, 1e-6);
    EXPECT_NEAR(split.mse, 0, 1e-9);
    EXPECT_NEAR(split.sum(), 0, 1e-9);
}

TEST(ErrorSplit, AddsUpExactlyWhereTheReferenceHasNoNoise) {
    const Halves h = halvesOf({0.05, 0.02, 0.01, 0.2, 0.1, 0});
    const ErrorSplit split = splitError(h.technique, h.exact, h.reference);
    EXPECT_NEAR(split.sum(), split.mse, 1e-9);
}

TEST(ErrorSplit, OnlyPixelsOfTheMaskCount) {
    Halves h = halvesOf({0.05, 0, 0, 0, 0, 0});
    Image mask(side, side, 1);
    for (size_t i = 0; i < mask.values.size(); ++i) mask.values[i] = i % side < side / 2 ? 1.0F : 0.0F;
    for (size_t i = 0; i < mask.values.size(); ++i)
        if (mask.values[i] == 0) h.technique[0].values[i] = 100;
    const ErrorSplit split = splitError(h.technique, h.exact, h.reference, &mask);
    EXPECT_NEAR(split.mse, 0.0025, 1e-5);
    EXPECT_NEAR(split.algorithm, 0, 1e-9);
    EXPECT_THROW(static_cast<void>(splitError(h.technique, h.exact, {Image(2, 2, 1), Image(2, 2, 1)})),
                 InputError);
}

} // namespace
} // namespace kestrel
