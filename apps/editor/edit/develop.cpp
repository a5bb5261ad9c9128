#include "edit/develop.h"
#include "image/colormap.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace kestrel::edit {
namespace {

using Colour = std::array<std::uint8_t, 4>;
constexpr Colour notANumber{255, 0, 255, 255}, infinite{0, 255, 255, 255}, negative{255, 255, 0, 255};

std::uint8_t code(float value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

// The channels that a mode shows; a single channel stands for all.
std::array<float, 3> shown(const Image& image, int x, int y, Development::Mode mode) {
    const auto channel = [&](int wanted) {
        if (image.channels == 1 && wanted < 3) return image.at(x, y);
        return wanted < image.channels ? image.at(x, y, wanted) : wanted == 3 ? 1.0f : 0.0f;
    };
    switch (mode) {
    case Development::Mode::Red:
        return {channel(0), channel(0), channel(0)};
    case Development::Mode::Green:
        return {channel(1), channel(1), channel(1)};
    case Development::Mode::Blue:
        return {channel(2), channel(2), channel(2)};
    case Development::Mode::Alpha:
        return {channel(3), channel(3), channel(3)};
    default:
        return {channel(0), channel(1), channel(2)};
    }
}

float heatOf(const Image& image, const std::array<float, 3>& values) {
    return image.channels >= 3 ? luminance(values[0], values[1], values[2]) : values[0];
}

const Colour* markOf(const std::array<float, 3>& values) {
    const auto any = [&](auto test) { return std::any_of(values.begin(), values.end(), test); };
    if (any([](float v) { return std::isnan(v); })) return &notANumber;
    if (any([](float v) { return std::isinf(v); })) return &infinite;
    if (any([](float v) { return v < 0; })) return &negative;
    return nullptr;
}

} // namespace

std::vector<std::uint8_t> develop(const Image& image, const Development& development) {
    using Mode = Development::Mode;
    std::vector<std::uint8_t> pixels(image.pixelCount() * 4, 255);
    if (image.empty()) return pixels;
    const bool display = development.mode == Mode::Display;
    const float scale = display ? 1 : std::exp2(development.exposure);
    const float extent = std::max(development.high - development.low, 1e-30f);
    const auto ranged = [&](float value) { return (value * scale - development.low) / extent; };
    Image heat;
    if (development.mode == Mode::Heat) {
        Image values(image.width, image.height, 1);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                values.at(x, y) =
                    std::clamp(ranged(heatOf(image, shown(image, x, y, Mode::Colour))), 0.0f, 1.0f);
        heat = heatMap(values);
    }
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            std::uint8_t* pixel =
                &pixels[(static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x)) *
                        4];
            const std::array<float, 3> values = shown(image, x, y, development.mode);
            const Colour* mark = development.marks ? markOf(values) : nullptr;
            // What lies below 0 is no mistake where the range reaches below it.
            if (mark == &negative && development.low < 0) mark = nullptr;
            for (int c = 0; c < 3; ++c) {
                const auto at = static_cast<size_t>(c);
                if (mark != nullptr)
                    pixel[c] = (*mark)[at];
                else if (development.mode == Mode::Heat)
                    pixel[c] = code(heat.at(x, y, c));
                else
                    pixel[c] =
                        code(display ? values[at] : linearToSrgb(std::clamp(ranged(values[at]), 0.0f, 1.0f)));
            }
        }
    return pixels;
}

void automaticRange(const Image& image, Development& development) {
    std::vector<float> values;
    const float scale = std::exp2(development.exposure);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const std::array<float, 3> at = shown(image, x, y, development.mode);
            const bool three = development.mode == Development::Mode::Colour && image.channels >= 3;
            for (int c = 0; c < (three ? 3 : 1); ++c) {
                const float value = development.mode == Development::Mode::Heat ? heatOf(image, at)
                                                                                : at[static_cast<size_t>(c)];
                if (std::isfinite(value)) values.push_back(value * scale);
            }
        }
    development.low = 0;
    development.high = 1;
    if (values.empty()) return;
    const auto at = [&](double share) {
        const auto place =
            values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), place, values.end());
        return *place;
    };
    const float low = at(0.01), high = at(0.99);
    if (development.mode != Development::Mode::Colour) development.low = low;
    development.high = high > development.low ? high : development.low + 1;
}

std::string pixelText(const Image& image, int x, int y) {
    std::string text;
    for (int c = 0; c < image.channels; ++c)
        text += fmt::format("{}{} {:.6g}", c > 0 ? "\n" : "", "rgba"[c], image.at(x, y, c));
    return text;
}

std::string neighboursText(const Image& image, int x, int y, int channel) {
    std::string text;
    for (int row = y - 1; row <= y + 1; ++row) {
        for (int column = x - 1; column <= x + 1; ++column) {
            const bool inside = row >= 0 && column >= 0 && row < image.height && column < image.width;
            text +=
                fmt::format("{:>11}", inside ? fmt::format("{:.4g}", image.at(column, row, channel)) : "-");
        }
        text += row <= y ? "\n" : "";
    }
    return text;
}

} // namespace kestrel::edit
