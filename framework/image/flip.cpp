#include "image/flip.h"
#include "core/check.h"
#include "image/flip_ldr.h"
#include "image/metrics.h"
#include <algorithm>
#include <cmath>

namespace kestrel {
namespace {

using detail::FlipKernels;

// Works through bands of rows, each with the rows around it that its filters reach: no more memory than that.
template<class Prepare>
void raiseToError(Image& map, const Image& reference, const Image& test, const FlipKernels& kernels,
                  Prepare prepare) {
    constexpr int bandRows = 128;
    const int radius = kernels.radius();
    for (int begin = 0; begin < map.height; begin += bandRows) {
        const int end = std::min(begin + bandRows, map.height);
        const int from = std::max(begin - radius, 0);
        const int to = std::min(end + radius, map.height);
        const Image error = detail::flipOfLinear(prepare(crop(reference, 0, from, map.width, to - from)),
                                                 prepare(crop(test, 0, from, map.width, to - from)), kernels);
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < map.width; ++x) map.at(x, y) = std::max(map.at(x, y), error.at(x, y - from));
    }
}

Image linearOfLdr(const Image& image) {
    Image rgb = convertChannels(image, 3);
    for (float& value : rgb.values) value = srgbToLinear(std::clamp(value, 0.0F, 1.0F));
    return rgb;
}

// The fit of the ACES tone map by Narkowicz (2016), as a quotient of quadratics in x, its
// exposure of 0.6 undone.
struct Quadratic {
    double square, linear, constant;
    [[nodiscard]] double at(double x) const { return (square * x + linear) * x + constant; }
};
constexpr Quadratic acesNumerator{0.6 * 0.6 * 2.51, 0.6 * 0.03, 0};
constexpr Quadratic acesDenominator{0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

float toneMapped(float value, double gain) {
    const double x = std::max(double{value}, 0.0) * gain;
    return static_cast<float>(std::clamp(acesNumerator.at(x) / acesDenominator.at(x), 0.0, 1.0));
}

// The value that the tone map takes to `target`.
double toneMapInverse(double target) {
    const double a = acesNumerator.square - target * acesDenominator.square;
    const double b = acesNumerator.linear - target * acesDenominator.linear;
    const double c = acesNumerator.constant - target * acesDenominator.constant;
    return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

Image linearOfHdr(const Image& image, double gain) {
    Image rgb = convertChannels(image, 3);
    for (float& value : rgb.values) value = toneMapped(value, gain);
    return rgb;
}

} // namespace

FlipExposures flipExposures(const Image& reference) {
    const Image rgb = convertChannels(reference, 3);
    std::vector<float> luminances(rgb.pixelCount());
    for (std::size_t i = 0; i < luminances.size(); ++i)
        luminances[i] = luminance(rgb.values[3 * i], rgb.values[3 * i + 1], rgb.values[3 * i + 2]);
    const auto medianOf = [](std::vector<float>& values) {
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    };
    const float greatest = *std::max_element(luminances.begin(), luminances.end());
    if (!(greatest > 0)) return {0, 0, 2};
    float median = medianOf(luminances);
    if (!(median > 0)) {
        std::erase_if(luminances, [](float value) { return !(value > 0); });
        median = medianOf(luminances);
    }
    const double bright = toneMapInverse(0.85);
    FlipExposures exposures;
    exposures.start = std::log2(bright / double{greatest});
    exposures.stop = std::log2(bright / double{median});
    exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.stop - exposures.start)));
    return exposures;
}

FlipFigures poolFlip(const Image& map, const Image* mask) {
    KESTREL_CHECK_EQ(map.channels, 1);
    KESTREL_CHECK(mask == nullptr || mask->sameSize(map));
    std::vector<float> errors;
    for (std::size_t pixel = 0; pixel < map.pixelCount(); ++pixel)
        if (mask == nullptr || mask->values[pixel] > 0.5F) errors.push_back(map.values[pixel]);
    KESTREL_CHECK(!errors.empty());
    std::sort(errors.begin(), errors.end());
    double sum = 0;
    for (const float error : errors) sum += double{error};

    const auto weightedPercentile = [&](double part) {
        double running = 0;
        for (const float error : errors) {
            running += double{error};
            if (running > part * sum) return double{error};
        }
        return double{errors.back()}; // all errors are 0
    };
    FlipFigures figures;
    figures.mean = sum / static_cast<double>(errors.size());
    figures.weightedMedian = weightedPercentile(0.5);
    figures.q1 = weightedPercentile(0.25);
    figures.q3 = weightedPercentile(0.75);
    figures.min = double{errors.front()};
    figures.max = double{errors.back()};
    return figures;
}

FlipResult flip(const Image& reference, const Image& test, const FlipOptions& options, const Image* mask) {
    requireComparable(reference, test, mask);
    KESTREL_CHECK(options.pixelsPerDegree > 0 && options.pixelsPerDegree <= 1000);
    const FlipKernels kernels(options.pixelsPerDegree);
    FlipResult result;
    result.map = Image(reference.width, reference.height, 1);
    if (!options.hdr) {
        raiseToError(result.map, reference, test, kernels, linearOfLdr);
    } else {
        result.exposures = flipExposures(reference);
        const FlipExposures& exposures = result.exposures;
        const double step = (exposures.stop - exposures.start) / (exposures.count - 1);
        for (int i = 0; i < exposures.count; ++i) {
            const double gain = std::exp2(exposures.start + i * step);
            raiseToError(result.map, reference, test, kernels,
                         [gain](const Image& image) { return linearOfHdr(image, gain); });
            if (step == 0) break; // one exposure, counted twice by the published rule
        }
    }
    result.figures = poolFlip(result.map, mask);
    return result;
}

} // namespace kestrel
