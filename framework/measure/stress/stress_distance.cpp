#include "measure/stress/stress_distance.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace kestrel {

StressDistance stressDistance(const Image& a, const Image& b) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (!a.sameSize(b) || a.channels != b.channels) return {infinity, infinity};
    StressDistance distance;
    double sum = 0, squares = 0, own = 0, ownSquares = 0, most = 0;
    const auto channels = static_cast<size_t>(a.channels), width = static_cast<size_t>(a.width);
    for (size_t i = 0; i < a.values.size(); ++i) {
        const double u = double{a.values[i]}, v = double{b.values[i]}, d = std::abs(u - v);
        const double seen = std::isfinite(d) ? d : infinity;
        if (seen > most) {
            most = seen;
            distance.x = static_cast<int>(i / channels % width);
            distance.y = static_cast<int>(i / channels / width);
        }
        sum += seen;
        squares += seen * seen;
        own += std::abs(u);
        ownSquares += u * u;
    }
    // Of a black picture any difference is infinitely large.
    distance.mean = sum > 0 ? sum / own : 0;
    distance.rms = squares > 0 ? std::sqrt(squares / ownSquares) : 0;
    if (std::isnan(distance.mean) || std::isnan(distance.rms)) distance.mean = distance.rms = infinity;
    return distance;
}

double stressRatio(const StressDistance& distance, const StressDistance& seeds) {
    constexpr double slack = 1.25, share = 0.005;
    const double mean = std::max(slack * seeds.mean, share),
                 rms = std::max(slack * seeds.rms, std::sqrt(share));
    return std::max(distance.mean / mean, distance.rms / rms);
}

void StressMean::add(const Image& image) {
    const int colours = std::min(image.channels, 3);
    for (size_t i = 0; i < image.pixelCount(); ++i) {
        double value = 0;
        for (int c = 0; c < colours; ++c)
            value += double{image.values[i * static_cast<size_t>(image.channels) + static_cast<size_t>(c)]} /
                     colours;
        sum += value;
        squares += value * value;
        count += 1;
    }
}

double StressMean::error() const {
    if (count < 2) return 0;
    return std::sqrt(std::max(0.0, squares / count - mean() * mean()) / count);
}

Image mirrored(const Image& image) {
    Image result = image;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < image.channels; ++c) result.at(x, y, c) = image.at(image.width - 1 - x, y, c);
    return result;
}

} // namespace kestrel
