#include "image/flip_ldr.h"
#include "image/flip_color.h"
#include "image/plane.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kestrel::detail {
namespace {

Plane filtered(const Plane& plane, const Kernel& along, const Kernel& down) {
    return convolveColumns(convolveRows(plane, along), down);
}

struct Opponent {
    Plane y, cx, cz;
    explicit Opponent(const Image& rgb)
        : y(rgb.width, rgb.height)
        , cx(rgb.width, rgb.height)
        , cz(rgb.width, rgb.height) {
        for (int row = 0; row < rgb.height; ++row) {
            const float* from = &rgb.values[rgb.index(0, row)];
            for (int column = 0; column < rgb.width; ++column, from += 3) {
                const Color color = opponentFromRgb({from[0], from[1], from[2]});
                y.row(row)[column] = color.x;
                cx.row(row)[column] = color.y;
                cz.row(row)[column] = color.z;
            }
        }
    }
};

// What the eye resolves of the colours, in CIELAB with the Hunt effect, as three planes.
Opponent perceived(const Opponent& image, const SpatialKernels& kernels) {
    Opponent result = image;
    result.y = filtered(image.y, kernels.luminance, kernels.luminance);
    result.cx = filtered(image.cx, kernels.redGreen, kernels.redGreen);
    result.cz = filtered(image.cz, kernels.blueYellow[0], kernels.blueYellow[0]);
    const Plane second = filtered(image.cz, kernels.blueYellow[1], kernels.blueYellow[1]);
    for (int row = 0; row < image.y.height; ++row)
        for (int column = 0; column < image.y.width; ++column) {
            float& y = result.y.row(row)[column];
            float& cx = result.cx.row(row)[column];
            float& cz = result.cz.row(row)[column];
            Color rgb = rgbFromOpponent({y, cx, cz + second.row(row)[column]});
            rgb = {std::clamp(rgb.x, 0.0F, 1.0F), std::clamp(rgb.y, 0.0F, 1.0F),
                   std::clamp(rgb.z, 0.0F, 1.0F)};
            const Color lab = huntLabFromRgb(rgb);
            y = lab.x;
            cx = lab.y;
            cz = lab.z;
        }
    return result;
}

// Lengths of the responses of the edge and the point detector.
struct Features {
    Plane edge, point;
    Features(const Plane& lightness, const FeatureKernels& kernels)
        : edge(convolveColumns(convolveRows(lightness, kernels.edge), kernels.smooth))
        , point(convolveColumns(convolveRows(lightness, kernels.point), kernels.smooth)) {
        const Plane smooth = convolveRows(lightness, kernels.smooth);
        const Plane edgeDown = convolveColumns(smooth, kernels.edge);
        const Plane pointDown = convolveColumns(smooth, kernels.point);
        for (std::size_t i = 0; i < edge.values.size(); ++i) {
            edge.values[i] =
                std::sqrt(edge.values[i] * edge.values[i] + edgeDown.values[i] * edgeDown.values[i]);
            point.values[i] =
                std::sqrt(point.values[i] * point.values[i] + pointDown.values[i] * pointDown.values[i]);
        }
    }
};

// The responses scale as 1/sqrt(2) to [0, 1]; q_f = 0.5 is a square root.
float featureError(float edgeDifference, float pointDifference) {
    return std::sqrt(std::max(edgeDifference, pointDifference) / std::numbers::sqrt2_v<float>);
}

// Lightness in [0, 1] for the detectors.
Plane unitLightness(Plane y) {
    for (float& value : y.values) value = (value + 16) / 116;
    return y;
}

} // namespace

Image flipOfLinear(const Image& reference, const Image& test, const FlipKernels& kernels) {
    const Opponent referenceColors(reference);
    const Opponent testColors(test);
    const Opponent a = perceived(referenceColors, kernels.spatial);
    const Opponent b = perceived(testColors, kernels.spatial);
    const Features fa(unitLightness(referenceColors.y), kernels.feature);
    const Features fb(unitLightness(testColors.y), kernels.feature);
    Image map(reference.width, reference.height, 1);
    for (int row = 0; row < map.height; ++row)
        for (int column = 0; column < map.width; ++column) {
            const auto color = [&](const Opponent& image) {
                return Color{image.y.row(row)[column], image.cx.row(row)[column], image.cz.row(row)[column]};
            };
            const float feature =
                featureError(std::abs(fa.edge.row(row)[column] - fb.edge.row(row)[column]),
                             std::abs(fa.point.row(row)[column] - fb.point.row(row)[column]));
            map.at(column, row) = std::pow(colorError(hyab(color(a), color(b))), 1 - feature);
        }
    return map;
}

} // namespace kestrel::detail
