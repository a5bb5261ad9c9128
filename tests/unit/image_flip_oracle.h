// FLIP word for word from the papers: two-dimensional kernels, double precision, no separation, no speed. It
// shares no code with the library's form.
#pragma once
#include "image/image.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kestrel::test_oracle {

struct Triple {
    double x, y, z;
};
using Field = std::vector<double>; // width * height values
constexpr double pi = std::numbers::pi;

inline Triple toXyz(Triple c) {
    return {(10135552 * c.x + 8788810 * c.y + 4435075 * c.z) / 24577794,
            (2613072 * c.x + 8788810 * c.y + 887015 * c.z) / 12288897,
            (1425312 * c.x + 8788810 * c.y + 70074185 * c.z) / 73733382};
}

inline Triple white() { return toXyz({1, 1, 1}); }

// The published inverse, to nine places.
inline Triple fromXyz(Triple c) {
    return {3.241003275 * c.x - 1.537398934 * c.y - 0.498615861 * c.z,
            -0.969224334 * c.x + 1.875930071 * c.y + 0.041554224 * c.z,
            0.055639423 * c.x - 0.204011202 * c.y + 1.057148933 * c.z};
}

inline double labF(double t) {
    const double delta = 6.0 / 29;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
}

inline Triple huntLab(Triple linear) {
    const Triple xyz = toXyz(linear);
    const double fx = labF(xyz.x / white().x);
    const double fy = labF(xyz.y / white().y);
    const double fz = labF(xyz.z / white().z);
    const double l = 116 * fy - 16;
    return {l, 0.01 * l * 500 * (fx - fy), 0.01 * l * 200 * (fy - fz)};
}

inline double hyabPower(Triple a, Triple b) {
    return std::pow(std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z), 0.7);
}

// sum over the kernel of weight(dx, dy) * field, the border pixel repeated.
template<class Weight>
Field convolve(const Field& field, int width, int height, int radius, Weight weight) {
    Field result(field.size());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            for (int dy = -radius; dy <= radius; ++dy)
                for (int dx = -radius; dx <= radius; ++dx)
                    sum += weight(dx, dy) *
                           field[static_cast<std::size_t>(std::clamp(y + dy, 0, height - 1) * width +
                                                          std::clamp(x + dx, 0, width - 1))];
            result[static_cast<std::size_t>(y * width + x)] = sum;
        }
    return result;
}

// A kernel as a table, its positive weights scaled to the sum 1 and its negative ones to -1.
template<class Weight>
Field normalizedKernel(int radius, Weight weight) {
    Field kernel;
    double positive = 0;
    double negative = 0;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
            kernel.push_back(weight(x, y));
            (kernel.back() > 0 ? positive : negative) += kernel.back();
        }
    for (double& value : kernel) value = value > 0 ? value / positive : value < 0 ? -value / negative : 0;
    return kernel;
}

template<class Weight>
Field filter(const Field& field, int width, int height, int radius, Weight weight) {
    const Field kernel = normalizedKernel(radius, weight);
    return convolve(field, width, height, radius, [&](int dx, int dy) {
        return kernel[static_cast<std::size_t>((dy + radius) * (2 * radius + 1) + dx + radius)];
    });
}

struct Stages {
    std::vector<Triple> lab; // after the contrast sensitivity functions
    Field edge, point;       // lengths of the detectors' responses
};

inline Stages stages(const Image& linear, double density) {
    const int w = linear.width;
    const int h = linear.height;
    Field y;
    Field cx;
    Field cz;
    Field unit;
    for (std::size_t i = 0; i < linear.pixelCount(); ++i) {
        const Triple xyz = toXyz({double{linear.values[3 * i]}, double{linear.values[3 * i + 1]},
                                  double{linear.values[3 * i + 2]}});
        const double yn = xyz.y / white().y;
        y.push_back(116 * yn - 16);
        cx.push_back(500 * (xyz.x / white().x - yn));
        cz.push_back(200 * (yn - xyz.z / white().z));
        unit.push_back(yn);
    }
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * density));
    const auto sensitivity = [density](double a1, double b1, double a2, double b2) {
        return [=](int dx, int dy) {
            const double square = (dx * dx + dy * dy) / (density * density);
            return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * square / b1) +
                   a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * square / b2);
        };
    };
    y = filter(y, w, h, radius, sensitivity(1, 0.0047, 0, 1e-5));
    cx = filter(cx, w, h, radius, sensitivity(1, 0.0053, 0, 1e-5));
    cz = filter(cz, w, h, radius, sensitivity(34.1, 0.04, 13.5, 0.025));
    Stages result;
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double yn = (y[i] + 16) / 116;
        Triple rgb =
            fromXyz({(yn + cx[i] / 500) * white().x, yn * white().y, (yn - cz[i] / 200) * white().z});
        rgb = {std::clamp(rgb.x, 0.0, 1.0), std::clamp(rgb.y, 0.0, 1.0), std::clamp(rgb.z, 0.0, 1.0)};
        result.lab.push_back(huntLab(rgb));
    }
    const double sd = 0.5 * 0.082 * density;
    const int reach = static_cast<int>(std::ceil(3 * sd));
    const auto gauss = [sd](int dx, int dy) { return std::exp(-(dx * dx + dy * dy) / (2 * sd * sd)); };
    const auto length = [&](auto along, auto down) {
        Field a = filter(unit, w, h, reach, along);
        const Field b = filter(unit, w, h, reach, down);
        for (std::size_t i = 0; i < a.size(); ++i) a[i] = std::hypot(a[i], b[i]);
        return a;
    };
    result.edge = length([&](int x, int yy) { return -x * gauss(x, yy); },
                         [&](int x, int yy) { return -yy * gauss(x, yy); });
    result.point = length([&](int x, int yy) { return (x * x / (sd * sd) - 1) * gauss(x, yy); },
                          [&](int x, int yy) { return (yy * yy / (sd * sd) - 1) * gauss(x, yy); });
    return result;
}

// Linear RGB in [0, 1].
inline Image plainFlipOfLinear(const Image& reference, const Image& test, double density) {
    const Stages a = stages(reference, density);
    const Stages b = stages(test, density);
    const double greatest = hyabPower(huntLab({0, 1, 0}), huntLab({0, 0, 1}));
    Image map(reference.width, reference.height, 1);
    for (std::size_t i = 0; i < map.values.size(); ++i) {
        double color = hyabPower(a.lab[i], b.lab[i]);
        const double knee = 0.4 * greatest;
        color = color < knee ? 0.95 / knee * color : 0.95 + (color - knee) / (greatest - knee) * 0.05;
        const double feature = std::sqrt(
            std::max(std::abs(a.edge[i] - b.edge[i]), std::abs(a.point[i] - b.point[i])) / std::sqrt(2.0));
        map.values[i] = static_cast<float>(std::pow(color, 1 - feature));
    }
    return map;
}

// sRGB code values.
inline Image plainFlip(const Image& reference, const Image& test, double density) {
    return plainFlipOfLinear(srgbToLinear(reference), srgbToLinear(test), density);
}

// The image after `stops` and the ACES tone map, in [0, 1].
inline Image exposed(const Image& image, double stops) {
    Image result = image;
    for (float& value : result.values) {
        const double x = double{value} * std::exp2(stops) * 0.6;
        value =
            static_cast<float>(std::clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0));
    }
    return result;
}

} // namespace kestrel::test_oracle
