#include "image/io.h"
#include "core/check.h"
#include "core/error.h"
#include "core/files.h"
#include "image/formats.h"
#include <algorithm>
#include <cctype>
#include <fmt/format.h>

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

ImageFormat imageFormat(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    if (ending == ".png") return ImageFormat::Png;
    if (ending == ".hdr") return ImageFormat::Hdr;
    if (ending == ".exr") return ImageFormat::Exr;
    detail::failImage(file.string(), ending.empty() ? "needs the ending .png, .hdr or .exr"
                                                    : fmt::format("the ending '{}' is not .png, .hdr or .exr",
                                                                  file.extension().string()));
}

Image decodeImage(std::span<const std::byte> bytes, ImageFormat format, const std::string& name) {
    if (bytes.empty()) detail::failImage(name, "is empty");
    switch (format) {
    case ImageFormat::Png:
        return detail::decodePng(bytes, name);
    case ImageFormat::Hdr:
        return detail::decodeHdr(bytes, name);
    case ImageFormat::Exr:
        return detail::decodeExr(bytes, name);
    }
    KESTREL_CHECK(false);
    return {};
}

Image readImage(const std::filesystem::path& file) {
    const ImageFormat format = imageFormat(file);
    // The greatest image that is read, uncompressed, and as much again for what else a file may hold.
    constexpr std::uintmax_t limit = 2 * sizeof(float) * maxImageValues - 1;
    return decodeImage(readBytes(file, limit), format, file.string());
}

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
