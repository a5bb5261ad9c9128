#include "image/metrics.h"
#include "core/check.h"
#include "core/error.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace kestrel {
void requireFinite(const Image& image, const std::string& which, const std::string& file) {
    const auto first = std::find_if(image.values.begin(), image.values.end(),
                                    [](float value) { return !std::isfinite(value); });
    if (first == image.values.end()) return;
    const auto count =
        std::count_if(first, image.values.end(), [](float value) { return !std::isfinite(value); });
    const std::size_t pixel =
        static_cast<std::size_t>(first - image.values.begin()) / static_cast<std::size_t>(image.channels);
    throw InputError(
        Location{file},
        fmt::format("the {} has {} value{} that {} not finite; the first is {} at pixel ({}, {})", which,
                    count, count == 1 ? "" : "s", count == 1 ? "is" : "are", *first,
                    pixel % static_cast<std::size_t>(image.width),
                    pixel / static_cast<std::size_t>(image.width)));
}

namespace {

bool counts(const Image* mask, std::size_t pixel) { return mask == nullptr || mask->values[pixel] > 0.5F; }

constexpr int windowRadius = 5;

std::array<double, 2 * windowRadius + 1> windowWeights() {
    constexpr double sigma = 1.5;
    std::array<double, 2 * windowRadius + 1> weights{};
    for (int i = -windowRadius; i <= windowRadius; ++i)
        weights[static_cast<std::size_t>(i + windowRadius)] = std::exp(-i * i / (2 * sigma * sigma));
    return weights;
}

// The first and second moments of a pair of values in a window.
struct Moments {
    double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    void add(double weight, const Moments& other) {
        x += weight * other.x;
        y += weight * other.y;
        xx += weight * other.xx;
        yy += weight * other.yy;
        xy += weight * other.xy;
    }
};

// The part of the window around `center` that lies in [0, count), with weights that sum to 1 over it.
template<class Visit>
void visitWindow(int center, int count, Visit visit) {
    static const auto weights = windowWeights();
    const int first = std::max(center - windowRadius, 0);
    const int last = std::min(center + windowRadius, count - 1);
    double total = 0;
    for (int k = first; k <= last; ++k) total += weights[static_cast<std::size_t>(k - center + windowRadius)];
    for (int k = first; k <= last; ++k)
        visit(k, weights[static_cast<std::size_t>(k - center + windowRadius)] / total);
}

// The moments of one row, filtered along it.
void filterRow(const float* x, const float* y, std::vector<Moments>& row) {
    const int width = static_cast<int>(row.size());
    for (int i = 0; i < width; ++i) {
        Moments sum;
        visitWindow(i, width, [&](int k, double weight) {
            const double a = x[k];
            const double b = y[k];
            sum.add(weight, {a, b, a * a, b * b, a * b});
        });
        row[static_cast<std::size_t>(i)] = sum;
    }
}

double similarity(const Moments& m, double c1, double c2) {
    const double varianceX = m.xx - m.x * m.x;
    const double varianceY = m.yy - m.y * m.y;
    const double covariance = m.xy - m.x * m.y;
    return (2 * m.x * m.y + c1) * (2 * covariance + c2) /
           ((m.x * m.x + m.y * m.y + c1) * (varianceX + varianceY + c2));
}

} // namespace

void requireComparable(const Image& reference, const Image& test, const Image* mask) {
    if (!reference.sameSize(test))
        throw InputError(
            fmt::format("the reference has the size {} and the test image {}: they must be equal",
                        reference.sizeText(), test.sizeText()));
    if (reference.empty()) throw InputError("the images are empty");
    requireFinite(reference, "reference");
    requireFinite(test, "test image");
    if (mask == nullptr) return;
    if (!mask->sameSize(reference))
        throw InputError(fmt::format("the mask has the size {} and the images {}: they must be equal",
                                     mask->sizeText(), reference.sizeText()));
    if (mask->channels != 1)
        throw InputError(fmt::format("the mask has {} channels instead of 1", mask->channels));
    if (std::none_of(mask->values.begin(), mask->values.end(), [](float value) { return value > 0.5F; }))
        throw InputError("the mask leaves no pixel to compare");
}

double meanSquaredError(const Image& reference, const Image& test, const Image* mask) {
    requireComparable(reference, test, mask);
    KESTREL_CHECK_EQ(reference.channels, test.channels);
    const auto channels = static_cast<std::size_t>(reference.channels);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t pixel = 0; pixel < reference.pixelCount(); ++pixel) {
        if (!counts(mask, pixel)) continue;
        ++count;
        for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
            const double difference = double{reference.values[i]} - double{test.values[i]};
            sum += difference * difference;
        }
    }
    return sum / static_cast<double>(count * channels);
}

double peakSignalToNoise(double mse, double peak) {
    KESTREL_CHECK(peak > 0);
    if (mse == 0) return std::numeric_limits<double>::infinity();
    return 10 * std::log10(peak * peak / mse);
}

Image structuralSimilarityMap(const Image& reference, const Image& test, double range) {
    requireComparable(reference, test, nullptr);
    KESTREL_CHECK(range > 0);
    const Image x = convertChannels(reference, 1);
    const Image y = convertChannels(test, 1);
    const double c1 = 0.01 * range * 0.01 * range;
    const double c2 = 0.03 * range * 0.03 * range;
    Image map(x.width, x.height, 1);
    // Only the filtered rows that the window still covers are kept.
    constexpr int kept = 2 * windowRadius + 1;
    std::vector<std::vector<Moments>> rows(kept, std::vector<Moments>(static_cast<std::size_t>(x.width)));
    std::vector<Moments> window(static_cast<std::size_t>(x.width));
    int next = 0;
    for (int line = 0; line < x.height; ++line) {
        for (; next <= std::min(line + windowRadius, x.height - 1); ++next)
            filterRow(&x.values[x.index(0, next)], &y.values[y.index(0, next)],
                      rows[static_cast<std::size_t>(next % kept)]);
        std::fill(window.begin(), window.end(), Moments{});
        visitWindow(line, x.height, [&](int k, double weight) {
            const std::vector<Moments>& row = rows[static_cast<std::size_t>(k % kept)];
            for (std::size_t i = 0; i < row.size(); ++i) window[i].add(weight, row[i]);
        });
        for (int i = 0; i < x.width; ++i)
            map.at(i, line) = static_cast<float>(similarity(window[static_cast<std::size_t>(i)], c1, c2));
    }
    return map;
}

double structuralSimilarity(const Image& reference, const Image& test, const Image* mask, double range) {
    requireComparable(reference, test, mask);
    return meanOverMask(structuralSimilarityMap(reference, test, range), mask);
}

double meanOverMask(const Image& image, const Image* mask) {
    KESTREL_CHECK_EQ(image.channels, 1);
    KESTREL_CHECK(mask == nullptr || mask->sameSize(image));
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
        if (!counts(mask, pixel)) continue;
        sum += double{image.values[pixel]};
        ++count;
    }
    KESTREL_CHECK_NE(count, std::size_t{0});
    return sum / static_cast<double>(count);
}

} // namespace kestrel
