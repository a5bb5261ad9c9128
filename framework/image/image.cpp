#include "image/image.h"
#include "core/check.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

void applyToColor(Image& image, float (*transfer)(float)) {
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i < image.values.size(); ++i)
        if (i % channels != 3) image.values[i] = transfer(image.values[i]);
}

// One pixel of convertChannels.
void convertPixel(const float* from, int fromChannels, float* to, int toChannels) {
    if (fromChannels == 1) {
        std::fill_n(to, std::min(toChannels, 3), from[0]);
        if (toChannels == 4) to[3] = 1;
    } else if (toChannels == 1) {
        to[0] = fromChannels == 2 ? from[0] : luminance(from[0], from[1], from[2]);
    } else {
        for (int channel = 0; channel < toChannels; ++channel)
            to[channel] = channel < fromChannels ? from[channel] : (channel == 3 ? 1.0F : 0.0F);
    }
}

} // namespace

Image::Image(int imageWidth, int imageHeight, int imageChannels, float fill)
    : width(imageWidth)
    , height(imageHeight)
    , channels(imageChannels) {
    KESTREL_CHECK(width >= 0 && height >= 0);
    KESTREL_CHECK(channels >= 1 && channels <= 4);
    values.assign(pixelCount() * static_cast<std::size_t>(channels), fill);
}

std::string Image::sizeText() const { return fmt::format("{}x{}", width, height); }

Image crop(const Image& image, int x, int y, int width, int height) {
    KESTREL_CHECK(x >= 0 && y >= 0 && width >= 0 && height >= 0);
    KESTREL_CHECK_LE(width, image.width - x);
    KESTREL_CHECK_LE(height, image.height - y);
    Image part(width, height, image.channels);
    for (int row = 0; row < height; ++row)
        std::copy_n(image.values.begin() + static_cast<std::ptrdiff_t>(image.index(x, y + row)),
                    width * image.channels,
                    part.values.begin() + static_cast<std::ptrdiff_t>(part.index(0, row)));
    return part;
}

Image convertChannels(const Image& image, int channels) {
    if (channels == image.channels) return image;
    Image result(image.width, image.height, channels);
    const float* from = image.values.data();
    float* to = result.values.data();
    for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
        convertPixel(from, image.channels, to, channels);
        from += image.channels;
        to += channels;
    }
    return result;
}

float linearToSrgb(float value) {
    return value <= 0.0031308F ? 12.92F * value : 1.055F * std::pow(value, 1.0F / 2.4F) - 0.055F;
}

float srgbToLinear(float value) {
    return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

Image linearToSrgb(Image image) {
    applyToColor(image, [](float value) { return linearToSrgb(value); });
    return image;
}

Image srgbToLinear(Image image) {
    applyToColor(image, [](float value) { return srgbToLinear(value); });
    return image;
}

} // namespace kestrel
