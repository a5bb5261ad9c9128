#include "image/flip_color.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace kestrel::detail {
namespace {

// Section 4.1.3 of the paper.
constexpr float colorExponent = 0.7F;   // q_c
constexpr float colorKnee = 0.4F;       // p_c, as a part of the greatest colour difference
constexpr float colorKneeError = 0.95F; // p_t

// Linear sRGB to CIE XYZ, D65; the rational form makes the white point exact.
constexpr std::array<std::array<double, 3>, 3> xyzFromRgb{
    {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
     {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
     {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}}};

using Matrix = std::array<std::array<float, 3>, 3>;

constexpr double whitePoint(std::size_t row) {
    return xyzFromRgb[row][0] + xyzFromRgb[row][1] + xyzFromRgb[row][2];
}

// Linear RGB to XYZ relative to white: (1, 1, 1) becomes (1, 1, 1).
constexpr Matrix relativeXyzFromRgb = [] {
    Matrix matrix{};
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            matrix[row][column] = static_cast<float>(xyzFromRgb[row][column] / whitePoint(row));
    return matrix;
}();

// The inverse, by cofactors.
constexpr Matrix rgbFromRelativeXyz = [] {
    const auto m = [](std::size_t row, std::size_t column) {
        return xyzFromRgb[row % 3][column % 3] / whitePoint(row % 3);
    };
    const auto cofactor = [&](std::size_t row, std::size_t column) {
        return m(row + 1, column + 1) * m(row + 2, column + 2) -
               m(row + 1, column + 2) * m(row + 2, column + 1);
    };
    const double determinant = m(0, 0) * cofactor(0, 0) + m(0, 1) * cofactor(0, 1) + m(0, 2) * cofactor(0, 2);
    Matrix matrix{};
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            matrix[row][column] = static_cast<float>(cofactor(column, row) / determinant);
    return matrix;
}();

Color multiply(const Matrix& m, Color c) {
    return {m[0][0] * c.x + m[0][1] * c.y + m[0][2] * c.z, m[1][0] * c.x + m[1][1] * c.y + m[1][2] * c.z,
            m[2][0] * c.x + m[2][1] * c.y + m[2][2] * c.z};
}

} // namespace

Color opponentFromRgb(Color rgb) {
    const Color xyz = multiply(relativeXyzFromRgb, rgb);
    return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

Color rgbFromOpponent(Color opponent) {
    const float y = (opponent.x + 16) / 116;
    return multiply(rgbFromRelativeXyz, {y + opponent.y / 500, y, y - opponent.z / 200});
}

float labCurve(float value) {
    constexpr float delta = 6.0F / 29.0F;
    return value > delta * delta * delta ? std::cbrt(value) : value / (3 * delta * delta) + 4.0F / 29.0F;
}

Color huntLabFromRgb(Color rgb) {
    const Color xyz = multiply(relativeXyzFromRgb, rgb);
    const float x = labCurve(xyz.x);
    const float y = labCurve(xyz.y);
    const float z = labCurve(xyz.z);
    const float lightness = 116 * y - 16;
    return {lightness, 0.01F * lightness * 500 * (x - y), 0.01F * lightness * 200 * (y - z)};
}

float hyab(Color a, Color b) {
    const float dy = a.y - b.y;
    const float dz = a.z - b.z;
    return std::abs(a.x - b.x) + std::sqrt(dy * dy + dz * dz);
}

// The greatest colour difference of the gamut: between green and blue.
float greatestColorDifference() {
    static const float greatest =
        std::pow(hyab(huntLabFromRgb({0, 1, 0}), huntLabFromRgb({0, 0, 1})), colorExponent);
    return greatest;
}

float colorError(float distance) {
    const float difference = std::pow(distance, colorExponent);
    const float knee = colorKnee * greatestColorDifference();
    if (difference < knee) return colorKneeError / knee * difference;
    return std::min(colorKneeError +
                        (difference - knee) / (greatestColorDifference() - knee) * (1 - colorKneeError),
                    1.0F);
}

} // namespace kestrel::detail
