#include "core/check.h"
#include "image/formats.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <stb_image.h>
#include <stb_image_write.h>

namespace kestrel::detail {
namespace {

constexpr std::array<unsigned char, 8> signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

// The checksum of PNG chunks (ISO 3309, polynomial 0xedb88320 reflected).
std::uint32_t crc32(std::span<const unsigned char> bytes) {
    static const std::array<std::uint32_t, 256> table = [] {
        std::array<std::uint32_t, 256> entries{};
        for (std::uint32_t i = 0; i < 256; ++i) {
            std::uint32_t entry = i;
            for (int bit = 0; bit < 8; ++bit)
                entry = (entry & 1U) != 0 ? 0xedb88320U ^ (entry >> 1) : entry >> 1;
            entries[i] = entry;
        }
        return entries;
    }();
    std::uint32_t crc = 0xffffffffU;
    for (const unsigned char byte : bytes) crc = table[(crc ^ byte) & 0xffU] ^ (crc >> 8);
    return crc ^ 0xffffffffU;
}

std::uint32_t bigEndian(const unsigned char* bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 |
           bytes[3];
}

// What has to be known of a PNG before it is safe to decode it.
struct PngLayout {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t bitsPerPixel = 0;
    std::vector<unsigned char> compressed; // the IDAT chunks together
};

void readHeaderChunk(std::span<const unsigned char> data, PngLayout& layout, const std::string& name) {
    if (data.size() != 13) failImage(name, "is a damaged PNG: its header has the wrong length");
    layout.width = bigEndian(data.data());
    layout.height = bigEndian(data.data() + 4);
    const std::uint32_t bits = data[8];
    const std::uint32_t colorType = data[9];
    const std::uint32_t channels = colorType == 2 ? 3 : colorType == 4 ? 2 : colorType == 6 ? 4 : 1;
    if (bits > 16) failImage(name, fmt::format("is a damaged PNG: {} bits a channel", bits));
    layout.bitsPerPixel = bits * channels;
    requireImageSize(layout.width, layout.height, colorType == 0 ? 1 : colorType == 2 ? 3 : 4, name);
}

// Walks the chunks: stb checks neither checksums nor the file's end.
PngLayout scanChunks(std::span<const unsigned char> bytes, const std::string& name) {
    if (bytes.size() < signature.size() || !std::equal(signature.begin(), signature.end(), bytes.begin()))
        failImage(name, "is not a PNG");
    PngLayout layout;
    std::size_t at = signature.size();
    for (bool first = true;; first = false) {
        if (bytes.size() - at < 12) failImage(name, "is a truncated PNG");
        const std::size_t length = bigEndian(&bytes[at]);
        if (length > bytes.size() - at - 12) failImage(name, "is a truncated PNG");
        const auto typeAndData = bytes.subspan(at + 4, 4 + length);
        const std::string_view type(reinterpret_cast<const char*>(typeAndData.data()), 4);
        if (crc32(typeAndData) != bigEndian(&bytes[at + 8 + length]))
            failImage(name, "is a damaged PNG: a checksum does not fit");
        const auto data = typeAndData.subspan(4);
        if (first != (type == "IHDR")) failImage(name, "is a damaged PNG: its header is not its first chunk");
        if (first) readHeaderChunk(data, layout, name);
        if (type == "IDAT") layout.compressed.insert(layout.compressed.end(), data.begin(), data.end());
        if (type == "tRNS") requireImageSize(layout.width, layout.height, 4, name); // becomes RGBA
        if (type == "IEND") return layout;
        at += 12 + length;
    }
}

// A small file can inflate to a thousand times its size. Where that would be much more than the pixels need,
// inflate into a buffer of the size that they may need first.
void requireBoundedInflation(const PngLayout& layout, const std::string& name) {
    constexpr std::size_t greatestRatio = 1032; // of deflate
    constexpr std::size_t harmless = std::size_t{1} << 28;
    if (layout.compressed.size() < harmless / greatestRatio) return;
    const std::size_t rowBytes = (std::size_t{layout.width} * layout.bitsPerPixel + 7) / 8 + 1;
    const std::size_t needed = rowBytes * layout.height * 2 + 64; // interlacing adds less than half
    if (needed > std::numeric_limits<int>::max() ||
        layout.compressed.size() > std::numeric_limits<int>::max())
        failImage(name, "is a PNG of more bytes than are read");
    const auto buffer = std::make_unique_for_overwrite<char[]>(needed);
    if (stbi_zlib_decode_buffer(buffer.get(), static_cast<int>(needed),
                                reinterpret_cast<const char*>(layout.compressed.data()),
                                static_cast<int>(layout.compressed.size())) < 0)
        failImage(name, "is a damaged PNG: its data do not fit its size");
}

// Code values as floats. `fileChannels` counts as stb does: 2 is grey with alpha, which becomes RGBA here,
// because two channels are a vector everywhere else.
template<class Code>
Image toImage(const Code* codes, int width, int height, int fileChannels) {
    const float scale = static_cast<float>(std::numeric_limits<Code>::max());
    Image image(width, height, fileChannels == 2 ? 4 : fileChannels);
    for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel)
        for (int channel = 0; channel < image.channels; ++channel) {
            const int from = fileChannels == 2 ? channel / 3 : channel;
            image.values[pixel * static_cast<std::size_t>(image.channels) +
                         static_cast<std::size_t>(channel)] =
                static_cast<float>(
                    codes[pixel * static_cast<std::size_t>(fileChannels) + static_cast<std::size_t>(from)]) /
                scale;
        }
    return image;
}

unsigned char codeValue(float value, bool encode) {
    if (!(value > 0)) return 0; // NaN too
    if (value >= 1) return 255;
    return static_cast<unsigned char>((encode ? linearToSrgb(value) : value) * 255.0F + 0.5F);
}

} // namespace

Image decodePng(std::span<const std::byte> bytes, const std::string& name) {
    const std::span<const unsigned char> file(reinterpret_cast<const unsigned char*>(bytes.data()),
                                              bytes.size());
    requireBoundedInflation(scanChunks(file, name), name);
    if (file.size() > std::numeric_limits<int>::max())
        failImage(name, "is a PNG of more bytes than are read");
    const int size = static_cast<int>(file.size());

    int width = 0;
    int height = 0;
    int channels = 0;
    using Pixels = std::unique_ptr<void, decltype(&stbi_image_free)>;
    const bool wide = stbi_is_16_bit_from_memory(file.data(), size) != 0;
    const Pixels pixels(
        wide ? static_cast<void*>(stbi_load_16_from_memory(file.data(), size, &width, &height, &channels, 0))
             : stbi_load_from_memory(file.data(), size, &width, &height, &channels, 0),
        stbi_image_free);
    if (!pixels) failImage(name, fmt::format("is a damaged PNG: {}", stbi_failure_reason()));
    return wide ? toImage(static_cast<const std::uint16_t*>(pixels.get()), width, height, channels)
                : toImage(static_cast<const std::uint8_t*>(pixels.get()), width, height, channels);
}

std::vector<std::byte> encodePng(const Image& image, Encoding encoding) {
    if (image.channels == 2) return encodePng(convertChannels(image, 3), encoding);
    std::vector<unsigned char> codes(image.values.size());
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const bool alpha = image.channels == 4 && i % 4 == 3;
        codes[i] = codeValue(image.values[i], encoding == Encoding::Srgb && !alpha);
    }
    std::vector<std::byte> bytes;
    const int written = stbi_write_png_to_func(appendBytes, &bytes, image.width, image.height, image.channels,
                                               codes.data(), image.width * image.channels);
    KESTREL_CHECK_NE(written, 0);
    return bytes;
}

} // namespace kestrel::detail
