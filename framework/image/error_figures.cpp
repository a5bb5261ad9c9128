#include "image/error_figures.h"
#include "image/metrics.h"
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace kestrel {
namespace {

// Both images without alpha and with the same channels.
std::pair<Image, Image> comparableColors(const Image& reference, const Image& test) {
    const bool alike = reference.channels == test.channels && reference.channels < 4;
    const int channels = alike ? reference.channels : 3;
    return {convertChannels(reference, channels), convertChannels(test, channels)};
}

double greatestValue(const Image& image) {
    const double greatest = double{*std::max_element(image.values.begin(), image.values.end())};
    return greatest > 0 ? greatest : 1;
}

} // namespace

ErrorFigures measureError(const Image& reference, const Image& test, const ErrorOptions& options,
                          Image* flipMap) {
    requireComparable(reference, test, options.mask);
    const auto [expected, actual] = comparableColors(reference, test);
    const double range = options.hdr ? greatestValue(expected) : 1;
    ErrorFigures figures;
    figures.mse = meanSquaredError(expected, actual, options.mask);
    figures.rmse = std::sqrt(figures.mse);
    figures.psnr = peakSignalToNoise(figures.mse, range);
    if (options.ssim) figures.ssim = structuralSimilarity(expected, actual, options.mask, range);
    if (!options.flip) return figures;
    FlipResult result = flip(expected, actual,
                             {.pixelsPerDegree = options.pixelsPerDegree, .hdr = options.hdr}, options.mask);
    figures.flip = result.figures;
    if (flipMap != nullptr) *flipMap = std::move(result.map);
    return figures;
}

std::string toJson(const ErrorFigures& figures) {
    nlohmann::ordered_json flip{{"mean", figures.flip.mean}, {"weighted_median", figures.flip.weightedMedian},
                                {"q1", figures.flip.q1},     {"q3", figures.flip.q3},
                                {"min", figures.flip.min},   {"max", figures.flip.max}};
    nlohmann::ordered_json json{{"mse", figures.mse}, {"rmse", figures.rmse}, {"psnr", nullptr}};
    if (std::isfinite(figures.psnr)) json["psnr"] = figures.psnr;
    json["ssim"] = figures.ssim;
    json["flip"] = std::move(flip);
    return json.dump();
}

} // namespace kestrel
