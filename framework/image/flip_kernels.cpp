#include "image/flip_kernels.h"
#include <cmath>
#include <numbers>

namespace kestrel::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double featureWidthDegrees = 0.082; // w of section 4.2

// The contrast sensitivity functions as sums of Gaussians a sqrt(pi/b) exp(-pi^2 x^2 / b),
// x in degrees (table 1).
struct Gaussian {
    double a, b;
};
constexpr Gaussian luminanceSensitivity{1, 0.0047};
constexpr Gaussian redGreenSensitivity{1, 0.0053};
constexpr std::array<Gaussian, 2> blueYellowSensitivity{{{34.1, 0.04}, {13.5, 0.025}}};

int spatialRadius(float pixelsPerDegree) {
    const double widest = blueYellowSensitivity[0].b;
    return static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * pixelsPerDegree));
}

// One dimension of `gaussian` such that the product of two is it, not normalized.
std::vector<double> halfOf(Gaussian gaussian, float pixelsPerDegree) {
    const int radius = spatialRadius(pixelsPerDegree);
    std::vector<double> weights;
    for (int i = -radius; i <= radius; ++i) {
        const double degrees = i / double{pixelsPerDegree};
        weights.push_back(std::sqrt(gaussian.a * std::sqrt(pi / gaussian.b)) *
                          std::exp(-pi * pi * degrees * degrees / gaussian.b));
    }
    return weights;
}

double sumOf(const std::vector<double>& weights) {
    double sum = 0;
    for (const double weight : weights) sum += weight;
    return sum;
}

Kernel scaled(const std::vector<double>& weights, double factor) {
    Kernel kernel;
    for (const double weight : weights) kernel.push_back(static_cast<float>(weight * factor));
    return kernel;
}

// Scales the positive weights to the sum 1 and the negative ones to -1.
Kernel balanced(const std::vector<double>& weights) {
    double positive = 0;
    double negative = 0;
    for (const double weight : weights) (weight > 0 ? positive : negative) += weight;
    Kernel kernel;
    for (const double weight : weights)
        kernel.push_back(static_cast<float>(weight > 0   ? weight / positive
                                            : weight < 0 ? -weight / negative
                                                         : 0));
    return kernel;
}

} // namespace

SpatialKernels::SpatialKernels(float pixelsPerDegree) {
    const auto y = halfOf(luminanceSensitivity, pixelsPerDegree);
    const auto cx = halfOf(redGreenSensitivity, pixelsPerDegree);
    const auto cz1 = halfOf(blueYellowSensitivity[0], pixelsPerDegree);
    const auto cz2 = halfOf(blueYellowSensitivity[1], pixelsPerDegree);
    luminance = scaled(y, 1 / sumOf(y));
    redGreen = scaled(cx, 1 / sumOf(cx));
    // Both together have to sum to 1 in two dimensions.
    const double both = std::sqrt(sumOf(cz1) * sumOf(cz1) + sumOf(cz2) * sumOf(cz2));
    blueYellow = {scaled(cz1, 1 / both), scaled(cz2, 1 / both)};
}

FeatureKernels::FeatureKernels(float pixelsPerDegree) {
    const double deviation = 0.5 * featureWidthDegrees * double{pixelsPerDegree};
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    std::vector<double> g;
    std::vector<double> dg;
    std::vector<double> ddg;
    for (int i = -radius; i <= radius; ++i) {
        g.push_back(std::exp(-i * i / (2 * deviation * deviation)));
        dg.push_back(-i * g.back());
        ddg.push_back((i * i / (deviation * deviation) - 1) * g.back());
    }
    smooth = scaled(g, 1 / sumOf(g));
    edge = balanced(dg);
    point = balanced(ddg);
}

} // namespace kestrel::detail
