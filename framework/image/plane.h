// One channel of an image in the form that filters want, and separable convolution.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace kestrel::detail {

// The columns that a convolution makes together; the compiler keeps their sums in registers.
inline constexpr std::size_t lanes = 16;

// width x height floats; rows are padded to whole lanes, the padding's values mean nothing.
struct Plane {
    int width = 0;
    int height = 0;
    std::size_t stride = 0;
    std::vector<float> values;

    Plane(int planeWidth, int planeHeight);
    [[nodiscard]] float* row(int y) { return &values[static_cast<std::size_t>(y) * stride]; }
    [[nodiscard]] const float* row(int y) const { return &values[static_cast<std::size_t>(y) * stride]; }
};

// Convolves along the rows or the columns: result(i) = sum over k of kernel[k] * plane(i + k - radius), where
// the kernel has 2 * radius + 1 weights. Beyond the border the nearest pixel is taken.
Plane convolveRows(const Plane& plane, std::span<const float> kernel);
Plane convolveColumns(const Plane& plane, std::span<const float> kernel);

} // namespace kestrel::detail
