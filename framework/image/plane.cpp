#include "image/plane.h"
#include <algorithm>

namespace kestrel::detail {

Plane::Plane(int planeWidth, int planeHeight)
    : width(planeWidth)
    , height(planeHeight)
    , stride((static_cast<std::size_t>(planeWidth) + lanes - 1) / lanes * lanes)
    , values(stride * static_cast<std::size_t>(planeHeight)) {}

Plane convolveRows(const Plane& plane, std::span<const float> kernel) {
    const std::size_t radius = kernel.size() / 2;
    const auto width = static_cast<std::size_t>(plane.width);
    Plane result(plane.width, plane.height);
    std::vector<float> padded(plane.stride + 2 * radius);
    for (int y = 0; y < plane.height; ++y) {
        const float* from = plane.row(y);
        float* to = result.row(y);
        std::fill_n(padded.begin(), radius, from[0]);
        std::copy_n(from, width, padded.begin() + static_cast<std::ptrdiff_t>(radius));
        std::fill(padded.begin() + static_cast<std::ptrdiff_t>(radius + width), padded.end(),
                  from[width - 1]);
        for (std::size_t x = 0; x < plane.stride; x += lanes) {
            float sums[lanes] = {};
            for (std::size_t k = 0; k < kernel.size(); ++k)
                for (std::size_t lane = 0; lane < lanes; ++lane)
                    sums[lane] += kernel[k] * padded[x + k + lane];
            std::copy_n(sums, lanes, to + x);
        }
    }
    return result;
}

Plane convolveColumns(const Plane& plane, std::span<const float> kernel) {
    const int radius = static_cast<int>(kernel.size() / 2);
    Plane result(plane.width, plane.height);
    std::vector<const float*> rows(kernel.size());
    for (int y = 0; y < plane.height; ++y) {
        for (std::size_t k = 0; k < kernel.size(); ++k)
            rows[k] = plane.row(std::clamp(y + static_cast<int>(k) - radius, 0, plane.height - 1));
        float* to = result.row(y);
        for (std::size_t x = 0; x < plane.stride; x += lanes) {
            float sums[lanes] = {};
            for (std::size_t k = 0; k < kernel.size(); ++k)
                for (std::size_t lane = 0; lane < lanes; ++lane) sums[lane] += kernel[k] * rows[k][x + lane];
            std::copy_n(sums, lanes, to + x);
        }
    }
    return result;
}

} // namespace kestrel::detail
