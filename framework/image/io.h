// Image files: PNG, HDR (Radiance RGBE) and EXR. What is read is told by its first bytes, what is written by
// the file's ending.
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
// The format that the first bytes tell. Throws InputError whose location is `name` for any other, and says
// what kind of picture it is where that is known.
ImageFormat imageFormat(std::span<const std::byte> bytes, const std::string& name);

// Whether a file of this format holds linear values without an upper limit (HDR, EXR).
constexpr bool holdsHighDynamicRange(ImageFormat format) { return format != ImageFormat::Png; }

// A picture as a command line or a graph names it: a file, and, behind a colon, a layer of it.
struct ImageName {
    std::filesystem::path file;
    std::string layer; // of an EXR: a layer, a part or a channel; empty: the one that decodeImage chooses
};
// Splits "file.exr:beauty" at the last colon before which a file's name stands. A file whose own name has a
// colon is found first, with as many colons as its name has.
ImageName imageName(const std::filesystem::path& text);

// A picture and what kind of file it came from, for whoever must know what its values mean.
struct Picture {
    Image image;
    ImageFormat format = ImageFormat::Png;
};

// Reads a picture; `name` is a file, or a file and a layer (see imageName).
//   PNG: 8 or 16 bits; code values / 255 or / 65535, not decoded: who reads it knows what they mean.
//        Grey gives one channel, colour three, grey or colour with transparency four. What a PNG says of
//        its gamma or colour profile is not used.
//   HDR: three channels, linear, of Rec. 709, divided by the exposures and colour corrections that the
//        header names; all eight orientations, run lengths old and new or none, RGBE and XYZE. Pictures of
//        other primaries are converted. A warning says what was done.
//   EXR: scan lines and tiles (the full level), one part or several, every compression of OpenEXR; half,
//        float and whole numbers (exact up to 2^24). The picture is the display window: 0 (alpha too)
//        outside of the data window. Channels of a layer, a part or a channel by its name, else of the
//        only layer with colours: R, G, B and A by name (upper or lower case, in any order), else R, G,
//        or X, Y, Z, or X, Y, or Y, or one channel of any name; luminance with chroma (Y, RY, BY) becomes
//        RGB, in the precision of half. Colours of other chromaticities than those of Rec. 709 are
//        converted. A warning says what was chosen, left out or converted.
// Throws InputError naming the file and the reason if it is missing, truncated, damaged, of a kind that is
// not read (deep data), holds several layers of which none is named, or is beyond maxImageSide or
// maxImageValues.
Picture readPicture(const std::filesystem::path& name);
Picture readPicture(const ImageName& name);
Image readImage(const std::filesystem::path& name);

// The same from memory; `name` stands for the file in messages.
Picture decodePicture(std::span<const std::byte> bytes, const std::string& name,
                      const std::string& layer = {});
Image decodeImage(std::span<const std::byte> bytes, const std::string& name, const std::string& layer = {});

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
