// Errors between two images of one size: MSE, RMSE, PSNR, SSIM.
#pragma once
#include "image/image.h"
#include <string>

namespace kestrel {

// Throws InputError if a value is not finite, naming the file where there is one, `which` image it is
// ("reference"), how many values are so, and the first one's pixel.
void requireFinite(const Image& image, const std::string& which, const std::string& file = {});

// Throws InputError if the images differ in size (naming both sizes) or hold values that are not finite
// (naming the first pixel), or if the mask has another size, more than one channel, or no value above 0.5.
// `mask` may be null: every pixel counts. Else pixels count where it is greater than 0.5.
void requireComparable(const Image& reference, const Image& test, const Image* mask);

// Mean squared difference over all channels of the pixels that count. Both images must have the same
// channels. Throws InputError as requireComparable does.
double meanSquaredError(const Image& reference, const Image& test, const Image* mask = nullptr);

// Peak signal-to-noise ratio in dB, 10 log10(peak^2 / mse); infinity for mse = 0. `peak` > 0.
double peakSignalToNoise(double mse, double peak = 1);

// The structural similarity index of Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error
// Visibility to Structural Similarity" (IEEE TIP 2004), on luma (see convertChannels): Gaussian window of
// 11x11 with sigma 1.5, K1 = 0.01, K2 = 0.03, `range` > 0 the dynamic range L. In [-1, 1], 1 for equal
// images. At the border the window is cut off and its weights are normalized anew, so that each pixel has a
// value and images smaller than the window do too (the authors' program leaves a border of 5 pixels out
// instead). Returns the map (one channel).
Image structuralSimilarityMap(const Image& reference, const Image& test, double range = 1);
// The mean of the map over the pixels that count. Throws InputError as requireComparable does.
double structuralSimilarity(const Image& reference, const Image& test, const Image* mask = nullptr,
                            double range = 1);

// The mean of a one-channel image over the pixels that count.
double meanOverMask(const Image& image, const Image* mask);

} // namespace kestrel
