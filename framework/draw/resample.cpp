#include "draw/resample.h"
#include "core/check.h"
#include "image/image.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace kestrel {
namespace {

// What one target texel takes of a row or column: weights of the source texels from `first` on, summing to 1.
struct Taps {
    int first = 0;
    std::vector<float> weights;
};

std::vector<Taps> tapsOf(int source, int target, ResampleFilter filter) {
    std::vector<Taps> taps(static_cast<size_t>(target));
    const double step = double(source) / target;
    const double radius = std::max(1.0, step); // of the triangle, in source texels
    for (int i = 0; i < target; ++i) {
        Taps& tap = taps[static_cast<size_t>(i)];
        const double centre = (i + 0.5) * step - 0.5; // in indices of source texels
        if (filter == ResampleFilter::Nearest) {
            tap = {std::clamp(static_cast<int>(std::floor(centre + 0.5)), 0, source - 1), {1.0F}};
            continue;
        }
        const int first = static_cast<int>(std::ceil(centre - radius));
        const int last = static_cast<int>(std::floor(centre + radius));
        tap.first = std::clamp(first, 0, source - 1);
        tap.weights.assign(static_cast<size_t>(std::clamp(last, 0, source - 1) - tap.first + 1), 0.0F);
        double sum = 0;
        for (int j = first; j <= last; ++j) sum += std::max(0.0, 1 - std::abs(j - centre) / radius);
        for (int j = first; j <= last; ++j) {
            const double weight = std::max(0.0, 1 - std::abs(j - centre) / radius) / sum;
            tap.weights[static_cast<size_t>(std::clamp(j, 0, source - 1) - tap.first)] +=
                static_cast<float>(weight);
        }
    }
    return taps;
}

using Texel = std::array<float, 4>;

// The float values of the 256 code values.
std::array<float, 256> decoder(bool srgb) {
    std::array<float, 256> table{};
    for (size_t i = 0; i < table.size(); ++i) {
        const float value = static_cast<float>(i) / 255.0F;
        table[i] = srgb ? srgbToLinear(value) : value;
    }
    return table;
}

std::uint8_t encode(float value, bool srgb) {
    const float code = srgb ? linearToSrgb(std::max(value, 0.0F)) : value;
    return static_cast<std::uint8_t>(std::lround(std::clamp(code, 0.0F, 1.0F) * 255.0F));
}

} // namespace

std::vector<std::uint8_t> resampleToSquare(const TextureImage& image, std::uint32_t side, bool srgb,
                                           ResampleFilter filter) {
    const auto target = static_cast<int>(side);
    const size_t texels = size_t{side} * side;
    if (image.width <= 0 || image.height <= 0) return std::vector<std::uint8_t>(4 * texels, 255);
    KESTREL_CHECK_EQ(image.rgba.size(),
                     size_t{4} * static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
    if (image.width == target && image.height == target) return image.rgba;

    const std::array<float, 256> colours = decoder(srgb);
    const std::array<float, 256> plain = decoder(false);
    const std::vector<Taps> columns = tapsOf(image.width, target, filter);
    const std::vector<Taps> rows = tapsOf(image.height, target, filter);

    // First along rows: image.height rows of `side` texels.
    std::vector<Texel> narrowed(static_cast<size_t>(image.height) * side);
    for (int y = 0; y < image.height; ++y) {
        const std::uint8_t* row =
            image.rgba.data() + size_t{4} * static_cast<size_t>(y) * static_cast<size_t>(image.width);
        for (size_t x = 0; x < side; ++x) {
            Texel sum{};
            for (size_t k = 0; k < columns[x].weights.size(); ++k) {
                const std::uint8_t* texel = row + 4 * (static_cast<size_t>(columns[x].first) + k);
                const float weight = columns[x].weights[k];
                for (size_t c = 0; c < 3; ++c) sum[c] += weight * colours[texel[c]];
                sum[3] += weight * plain[texel[3]];
            }
            narrowed[static_cast<size_t>(y) * side + x] = sum;
        }
    }
    std::vector<std::uint8_t> result(4 * texels);
    for (size_t y = 0; y < side; ++y) {
        for (size_t x = 0; x < side; ++x) {
            Texel sum{};
            for (size_t k = 0; k < rows[y].weights.size(); ++k) {
                const Texel& texel = narrowed[(static_cast<size_t>(rows[y].first) + k) * side + x];
                for (size_t c = 0; c < 4; ++c) sum[c] += rows[y].weights[k] * texel[c];
            }
            for (size_t c = 0; c < 4; ++c) result[4 * (y * side + x) + c] = encode(sum[c], srgb && c < 3);
        }
    }
    return result;
}

} // namespace kestrel
