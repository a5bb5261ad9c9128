// An image in main memory, and the conversions between the forms in which images are stored.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace kestrel {

// Limits on what is read or made from an input: no side longer, no image with more values (1 GiB of float32).
inline constexpr int maxImageSide = 16384;
inline constexpr std::size_t maxImageValues = std::size_t{1} << 28;

// width x height pixels of 1 to 4 interleaved float32 channels, rows top to bottom. One channel is grey or a
// plain value, two are a vector (red, green), three are RGB, four RGB and alpha. What a value means (linear
// light, sRGB code value, a distance) is known to who made the image.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> values; // width * height * channels

    Image() = default;
    Image(int imageWidth, int imageHeight, int imageChannels, float fill = 0);

    [[nodiscard]] bool empty() const { return values.empty(); }
    [[nodiscard]] std::size_t pixelCount() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
    // Index of the first value of pixel (x, y), x to the right, y down from the top.
    [[nodiscard]] std::size_t index(int x, int y) const {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
               static_cast<std::size_t>(channels);
    }
    [[nodiscard]] float& at(int x, int y, int channel = 0) {
        return values[index(x, y) + static_cast<std::size_t>(channel)];
    }
    [[nodiscard]] float at(int x, int y, int channel = 0) const {
        return values[index(x, y) + static_cast<std::size_t>(channel)];
    }
    [[nodiscard]] bool sameSize(const Image& other) const {
        return width == other.width && height == other.height;
    }
    // "640x360", for messages.
    [[nodiscard]] std::string sizeText() const;

    friend bool operator==(const Image&, const Image&) = default;
};

// The part of `image` that begins at (x, y); it must lie inside.
Image crop(const Image& image, int x, int y, int width, int height);

// The image with `channels` channels. From one channel the value is repeated (alpha 1); to one channel RGB
// becomes luma with the weights of Rec. 709 (alpha ignored) and a vector its first component; otherwise
// channels are cut off, or added as 0 (blue) and 1 (alpha).
Image convertChannels(const Image& image, int channels);

// Luma or luminance with the weights of Rec. 709.
constexpr float luminance(float r, float g, float b) { return 0.2126F * r + 0.7152F * g + 0.0722F * b; }

// The transfer function of sRGB (IEC 61966-2-1) and its inverse, on [0, 1]; values outside
// follow the curve's outer pieces.
float linearToSrgb(float value);
float srgbToLinear(float value);
// As above for a whole image; alpha (the fourth channel) stays.
Image linearToSrgb(Image image);
Image srgbToLinear(Image image);

} // namespace kestrel
