// Image files put together byte by byte, right or wrong as a test wants them.
#pragma once
#include "image/io.h"
#include "support/message.h"
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel::test_files {

using Bytes = std::vector<std::byte>;
using Octets = std::vector<std::uint8_t>;

inline constexpr float infinity = std::numeric_limits<float>::infinity();
inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// What reading says on standard error.
inline std::string warningsOf(const Bytes& bytes, const std::string& layer = {}) {
    testing::internal::CaptureStderr();
    decodeImage(bytes, "file", layer);
    return testing::internal::GetCapturedStderr();
}

inline Bytes bytesOf(std::string_view text) {
    Bytes bytes;
    for (const char letter : text) bytes.push_back(static_cast<std::byte>(letter));
    return bytes;
}

inline Bytes bytesOf(const Octets& octets) {
    Bytes bytes;
    for (const std::uint8_t octet : octets) bytes.push_back(static_cast<std::byte>(octet));
    return bytes;
}

inline void append(Octets& to, const Octets& from) { to.insert(to.end(), from.begin(), from.end()); }

inline Octets bigEndian(std::uint32_t value) {
    return {static_cast<std::uint8_t>(value >> 24), static_cast<std::uint8_t>(value >> 16),
            static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)};
}

inline Octets littleEndian(std::uint64_t value, int count = 4) {
    Octets result;
    for (int i = 0; i < count; ++i) result.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return result;
}

inline Octets pngChunk(const std::string& type, const Octets& data) {
    Octets typed(type.begin(), type.end());
    append(typed, data);
    std::uint32_t crc = 0xffffffffU;
    for (const std::uint8_t octet : typed) {
        crc ^= octet;
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? 0xedb88320U ^ (crc >> 1) : crc >> 1;
    }
    Octets chunk = bigEndian(static_cast<std::uint32_t>(data.size()));
    append(chunk, typed);
    append(chunk, bigEndian(~crc));
    return chunk;
}

// A zlib stream of stored blocks.
inline Octets stored(const Octets& data) {
    Octets stream{0x78, 0x01};
    std::uint32_t a = 1;
    std::uint32_t b = 0;
    for (const std::uint8_t octet : data) {
        a = (a + octet) % 65521;
        b = (b + a) % 65521;
    }
    std::size_t at = 0;
    do {
        const std::size_t count = std::min<std::size_t>(data.size() - at, 65535);
        stream.push_back(at + count == data.size() ? 1 : 0);
        append(stream, littleEndian(count, 2));
        append(stream, littleEndian(~count, 2));
        stream.insert(stream.end(), data.begin() + static_cast<std::ptrdiff_t>(at),
                      data.begin() + static_cast<std::ptrdiff_t>(at + count));
        at += count;
    } while (at < data.size());
    append(stream, bigEndian(b << 16 | a));
    return stream;
}

// A PNG whose rows (filter bytes included) are `rows`.
inline Bytes png(std::uint32_t width, std::uint32_t height, std::uint8_t bits, std::uint8_t colorType,
                 const Octets& rows, const Octets& palette = {}, const Octets& transparency = {},
                 bool interlaced = false) {
    Octets file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    Octets header = bigEndian(width);
    append(header, bigEndian(height));
    append(header, {bits, colorType, 0, 0, static_cast<std::uint8_t>(interlaced ? 1 : 0)});
    append(file, pngChunk("IHDR", header));
    if (!palette.empty()) append(file, pngChunk("PLTE", palette));
    if (!transparency.empty()) append(file, pngChunk("tRNS", transparency));
    append(file, pngChunk("IDAT", stored(rows)));
    append(file, pngChunk("IEND", {}));
    return bytesOf(file);
}

// A scan-line EXR; each chunk is one line, uncompressed unless `chunk` gives the one chunk's data.
struct ExrBuilder {
    int height = 1;
    int minX = 0;
    int minY = 0;
    int lineOrder = 0; // 1: the last line first in the file
    std::uint32_t flags = 0;
    std::uint8_t compression = 0;
    std::uint32_t sampling = 1;
    std::optional<std::int32_t> chunkCount;
    std::optional<std::int32_t> claimedWidth;
    std::optional<std::int32_t> claimedHeight;
    Octets chunk;

    ExrBuilder& half(const std::string& name, const std::vector<std::uint16_t>& values) {
        Octets data;
        for (const std::uint16_t value : values) append(data, littleEndian(value, 2));
        return add(name, 1, data, values.size());
    }
    ExrBuilder& floats(const std::string& name, const std::vector<float>& values) {
        Octets data;
        for (const float value : values) append(data, littleEndian(std::bit_cast<std::uint32_t>(value)));
        return add(name, 2, data, values.size());
    }
    ExrBuilder& uints(const std::string& name, const std::vector<std::uint32_t>& values) {
        Octets data;
        for (const std::uint32_t value : values) append(data, littleEndian(value));
        return add(name, 0, data, values.size());
    }

    [[nodiscard]] Bytes bytes() const {
        Octets file = littleEndian(20000630);
        append(file, littleEndian(2 | flags));
        append(file, attribute("channels", "chlist", channelList()));
        append(file, attribute("compression", "compression", {compression}));
        Octets window;
        const int width = static_cast<int>(count_) / height;
        for (const std::int64_t edge :
             {std::int64_t{minX}, std::int64_t{minY}, std::int64_t{minX} + claimedWidth.value_or(width) - 1,
              std::int64_t{minY} + claimedHeight.value_or(height) - 1})
            append(window, littleEndian(static_cast<std::uint64_t>(edge)));
        append(file, attribute("dataWindow", "box2i", window));
        append(file, attribute("displayWindow", "box2i", window));
        append(file, attribute("lineOrder", "lineOrder", {static_cast<std::uint8_t>(lineOrder)}));
        append(file, attribute("pixelAspectRatio", "float", littleEndian(0x3f800000)));
        append(file, attribute("screenWindowCenter", "v2f", littleEndian(0, 8)));
        append(file, attribute("screenWindowWidth", "float", littleEndian(0x3f800000)));
        if (chunkCount)
            append(file,
                   attribute("chunkCount", "int", littleEndian(static_cast<std::uint32_t>(*chunkCount))));
        file.push_back(0);
        appendChunks(file);
        return bytesOf(file);
    }

private:
    struct Channel {
        int type;
        Octets data;
    };

    ExrBuilder& add(const std::string& name, int type, const Octets& data, std::size_t count) {
        channels_[name] = {type, data};
        count_ = count;
        return *this;
    }

    static Octets attribute(const std::string& name, const std::string& type, const Octets& data) {
        Octets result(name.begin(), name.end());
        result.push_back(0);
        result.insert(result.end(), type.begin(), type.end());
        result.push_back(0);
        append(result, littleEndian(data.size()));
        append(result, data);
        return result;
    }

    [[nodiscard]] Octets channelList() const {
        Octets list;
        for (const auto& [name, channel] : channels_) {
            list.insert(list.end(), name.begin(), name.end());
            list.push_back(0);
            append(list, littleEndian(static_cast<std::uint64_t>(channel.type)));
            append(list, littleEndian(0));
            append(list, littleEndian(sampling));
            append(list, littleEndian(sampling));
        }
        list.push_back(0);
        return list;
    }

    [[nodiscard]] Octets line(int y) const {
        Octets data;
        for (const auto& [name, channel] : channels_) {
            const std::size_t size = channel.data.size() / static_cast<std::size_t>(height);
            const auto begin =
                channel.data.begin() + static_cast<std::ptrdiff_t>(size * static_cast<std::size_t>(y));
            data.insert(data.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
        }
        return data;
    }

    void appendChunks(Octets& file) const {
        std::vector<Octets> chunks;
        for (int y = 0; y < height; ++y) {
            const Octets data = chunk.empty() ? line(y) : chunk;
            Octets whole = littleEndian(static_cast<std::uint64_t>(std::int64_t{minY} + y));
            append(whole, littleEndian(data.size()));
            append(whole, data);
            chunks.push_back(whole);
        }
        // All chunks of a builder have one size.
        const std::size_t begin = file.size() + 8 * chunks.size();
        for (std::size_t y = 0; y < chunks.size(); ++y) {
            const std::size_t place = lineOrder == 0 ? y : chunks.size() - 1 - y;
            append(file, littleEndian(begin + place * chunks[0].size(), 8));
        }
        if (lineOrder != 0) std::reverse(chunks.begin(), chunks.end());
        for (const Octets& whole : chunks) append(file, whole);
    }

    std::map<std::string, Channel> channels_; // the alphabet's order, as the format wants it
    std::size_t count_ = 0;
};

// 128 halves, the first 32 of them 0, the next 2^-24, and so on, compressed by PIZ.
inline ExrBuilder pizSample() {
    ExrBuilder exr;
    exr.half("Y", std::vector<std::uint16_t>(128));
    exr.compression = 4;
    exr.chunk = {0x00, 0x00, 0x00, 0x00, 0x0e, 0x1f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x04,
                 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x35, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                 0x00, 0x08, 0x20, 0xc2, 0x0c, 0x48, 0xfc, 0x47, 0xc1, 0x1f, 0xc8, 0xf8};
    return exr;
}

// What decoding says of `bytes`; "no error" where they are an image.
inline std::string decodeMessage(const Bytes& bytes) {
    return test::messageOf([&] { decodeImage(bytes, "file"); });
}

} // namespace kestrel::test_files
