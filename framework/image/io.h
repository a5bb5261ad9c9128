// Image files: PNG, HDR (Radiance RGBE) and EXR, chosen by the file's ending.
#pragma once
#include "image/image.h"
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kestrel {

enum class ImageFormat { Png, Hdr, Exr };

// How values become 8-bit code values when a PNG is written.
enum class Encoding {
    Srgb,   // values are linear light: the sRGB curve is applied (never to alpha)
    Linear, // values are written as they are: clamped to [0, 1] and scaled to 255
};

// The format that the file's ending names, upper or lower case. Throws InputError for any other ending.
ImageFormat imageFormat(const std::filesystem::path& file);

// Whether a file of this format holds linear values without an upper limit (HDR, EXR).
constexpr bool holdsHighDynamicRange(ImageFormat format) { return format != ImageFormat::Png; }

// Reads an image.
//   PNG: 8 or 16 bits; code values / 255 or / 65535, not decoded: who reads it knows what they mean.
//        Grey gives one channel, colour three, grey or colour with transparency four.
//   HDR: three channels, linear, divided by the exposures that the header names.
//   EXR: half or float, one part in scan lines, uncompressed or by RLE, ZIP, ZIPS or PIZ. Channels
//        R, G, B and A by name (in any order), or X, Y, Z, or one channel of any name; further
//        channels are left out with a warning.
// Throws InputError naming the file and the reason if it is missing, truncated, damaged, of an
// unknown kind, or beyond maxImageSide or maxImageValues.
Image readImage(const std::filesystem::path& file);

// The same from memory; `name` stands for the file in messages.
Image decodeImage(std::span<const std::byte> bytes, ImageFormat format, const std::string& name);

// Writes an image through a temporary name.
//   PNG: 8 bits; one channel as grey, two as RGB with blue 0, else RGB or RGBA. NaN is written as 0,
//        values outside [0, 1] (infinities too) as the nearer end.
//   HDR: RGB (alpha left out); negative values and NaN become 0, values beyond the format's range
//        its greatest. `encoding` is not used: values are linear.
//   EXR: float32, bit for bit; channels Y, or R, G, B, A. `encoding` is not used.
// Throws InputError naming the file if it cannot be written or its ending is unknown.
void writeImage(const std::filesystem::path& file, const Image& image, Encoding encoding);

// The bytes that writeImage writes.
std::vector<std::byte> encodeImage(const Image& image, ImageFormat format, Encoding encoding);

} // namespace kestrel
