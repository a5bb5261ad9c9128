#include "image/io.h"
#include "core/check.h"
#include "core/error.h"
#include "core/files.h"
#include "image/formats.h"
#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <string_view>

namespace kestrel {
namespace detail {

void failImage(const std::string& name, const std::string& message) {
    throw InputError(Location{name}, printable(message));
}

std::string printable(std::string text) {
    for (char& letter : text)
        if (std::iscntrl(static_cast<unsigned char>(letter)) != 0) letter = '?';
    return text;
}

void requireImageSize(long long width, long long height, long long channels, const std::string& name) {
    if (width < 1 || height < 1) failImage(name, fmt::format("has the size {}x{}", width, height));
    if (width > maxImageSide || height > maxImageSide)
        failImage(name, fmt::format("has the size {}x{}; at most {} pixels a side are read", width, height,
                                    maxImageSide));
    if (channels < 1 || static_cast<std::size_t>(channels) > maxImageValues /
                                                                 static_cast<std::size_t>(width) /
                                                                 static_cast<std::size_t>(height))
        failImage(name, fmt::format("has {}x{} pixels of {} channels; at most {} values are read", width,
                                    height, channels, maxImageValues));
}

void appendBytes(void* context, void* data, int size) {
    auto& bytes = *static_cast<std::vector<std::byte>*>(context);
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
}

} // namespace detail

namespace {

struct Beginning {
    std::string_view bytes;
    std::string_view kind;
};
using namespace std::string_view_literals;
// Kinds of pictures that people have, by how their files begin.
constexpr std::array<Beginning, 12> others{{{"\xff\xd8\xff"sv, "a JPEG picture"},
                                            {"GIF8"sv, "a GIF picture"},
                                            {"II*\0"sv, "a TIFF picture"},
                                            {"MM\0*"sv, "a TIFF picture"},
                                            {"BM"sv, "a BMP picture"},
                                            {"RIFF"sv, "a WebP picture or another RIFF file"},
                                            {"PF\n"sv, "a PFM picture"},
                                            {"Pf\n"sv, "a PFM picture"},
                                            {"P6"sv, "a PPM picture"},
                                            {"P5"sv, "a PGM picture"},
                                            {"DDS "sv, "a DDS texture"},
                                            {"8BPS"sv, "a Photoshop document"}}};

std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return text;
}

bool isFile(const std::string& name) {
    if (name == "-") return true; // standard input
    std::error_code failure;
    const auto type = std::filesystem::status(name, failure).type();
    return type != std::filesystem::file_type::not_found && type != std::filesystem::file_type::none &&
           type != std::filesystem::file_type::directory;
}

// Whether `name` ends as the files do that have layers.
bool endsAsExr(const std::string& name) { return lowerCase(name).ends_with(".exr"); }

} // namespace

ImageFormat imageFormat(const std::filesystem::path& file) {
    const std::string ending = lowerCase(file.extension().string());
    if (ending == ".png") return ImageFormat::Png;
    if (ending == ".hdr") return ImageFormat::Hdr;
    if (ending == ".exr") return ImageFormat::Exr;
    detail::failImage(file.string(), ending.empty() ? "needs the ending .png, .hdr or .exr"
                                                    : fmt::format("the ending '{}' is not .png, .hdr or .exr",
                                                                  file.extension().string()));
}

ImageFormat imageFormat(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.empty()) detail::failImage(name, "is empty");
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\x89PNG")) return ImageFormat::Png;
    if (text.starts_with("#?")) return ImageFormat::Hdr;
    if (text.starts_with("\x76\x2f\x31\x01")) return ImageFormat::Exr;
    for (const Beginning& other : others)
        if (text.starts_with(other.bytes))
            detail::failImage(name, fmt::format("is {}; PNG, HDR and EXR are read", other.kind));
    detail::failImage(name, "does not begin as a PNG, HDR or EXR picture does");
}

ImageName imageName(const std::filesystem::path& text) {
    const std::string name = text.string();
    if (isFile(name)) return {text, {}};
    for (std::size_t colon = name.rfind(':'); colon != std::string::npos && colon > 0;
         colon = name.rfind(':', colon - 1))
        if (isFile(name.substr(0, colon))) return {name.substr(0, colon), name.substr(colon + 1)};
    // No such file: the message about it names what was meant.
    for (std::size_t colon = name.find(':'); colon != std::string::npos; colon = name.find(':', colon + 1))
        if (endsAsExr(name.substr(0, colon))) return {name.substr(0, colon), name.substr(colon + 1)};
    return {text, {}};
}

Picture decodePicture(std::span<const std::byte> bytes, const std::string& name, const std::string& layer) {
    const ImageFormat format = imageFormat(bytes, name);
    if (!layer.empty() && format != ImageFormat::Exr)
        detail::failImage(name, fmt::format("is no EXR, so it has no layer '{}'", layer));
    switch (format) {
    case ImageFormat::Png:
        return {detail::decodePng(bytes, name), format};
    case ImageFormat::Hdr:
        return {detail::decodeHdr(bytes, name), format};
    case ImageFormat::Exr:
        return {detail::decodeExr(bytes, name, layer), format};
    }
    KESTREL_CHECK(false);
    return {};
}

Image decodeImage(std::span<const std::byte> bytes, const std::string& name, const std::string& layer) {
    return decodePicture(bytes, name, layer).image;
}

Picture readPicture(const ImageName& name) {
    // The greatest image that is read, uncompressed, and as much again for what else a file may hold.
    constexpr std::uintmax_t limit = 2 * sizeof(float) * maxImageValues - 1;
    return decodePicture(readGivenBytes(name.file, limit), name.file.string(), name.layer);
}

Picture readPicture(const std::filesystem::path& name) { return readPicture(imageName(name)); }

Image readImage(const std::filesystem::path& name) { return readPicture(name).image; }

std::vector<std::byte> encodeImage(const Image& image, ImageFormat format, Encoding encoding) {
    KESTREL_CHECK(!image.empty());
    switch (format) {
    case ImageFormat::Png:
        return detail::encodePng(image, encoding);
    case ImageFormat::Hdr:
        return detail::encodeHdr(image);
    case ImageFormat::Exr:
        return detail::encodeExr(image);
    }
    KESTREL_CHECK(false);
    return {};
}

void writeImage(const std::filesystem::path& file, const Image& image, Encoding encoding) {
    writeFile(file, encodeImage(image, imageFormat(file), encoding));
}

} // namespace kestrel
