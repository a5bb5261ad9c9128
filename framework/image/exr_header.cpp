#include "image/exr_header.h"
#include "core/error.h"
#include "image/exr_stream.h"
#include "image/formats.h"
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>
#include <algorithm>
#include <cstdint>
#include <exception>
#include <fmt/format.h>
#include <new>

namespace kestrel::detail {
namespace {

constexpr std::size_t mostChannels = 4096;
constexpr std::size_t mostParts = 1024;
constexpr int farthest = 1 << 28; // of a window's edge from the origin; OpenEXR reads a little more

std::size_t linesTogether(Imf::Compression compression) {
    switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
        return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
        return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
        return 32;
    default: // DWAB; the most of all
        return 256;
    }
}

class ExrHeaderReader {
public:
    ExrHeaderReader(std::span<const std::byte> bytes, const std::string& name)
        : bytes_(bytes)
        , name_(name) {}

    std::vector<Imf::Header> read() {
        const std::uint32_t version = readVersion();
        const std::size_t parts = countParts((version & Imf::MULTI_PART_FILE_FLAG) != 0);
        std::vector<Imf::Header> headers(parts);
        ExrInput stream(bytes_);
        stream.seekg(8);
        for (Imf::Header& header : headers) try {
                int number = static_cast<int>(version);
                header.readFrom(stream, number);
                check(header,
                      header.hasType() ? header.type() == Imf::TILEDIMAGE : (version & Imf::TILED_FLAG) != 0);
            } catch (const Error&) {
                throw;
            } catch (const std::bad_alloc&) {
                throw;
            } catch (const std::exception& problem) {
                if (stream.ranOut()) truncated();
                damaged(exrReason(problem));
            }
        return headers;
    }

private:
    [[noreturn]] void truncated() const { failImage(name_, "is a truncated EXR"); }
    [[noreturn]] void damaged(const std::string& how) const { failImage(name_, "is a damaged EXR: " + how); }
    [[noreturn]] void unread(const std::string& what) const {
        failImage(name_, fmt::format("is an EXR with {}, which is not read", what));
    }

    [[nodiscard]] std::uint32_t integer(std::size_t at) const {
        if (at > bytes_.size() || bytes_.size() - at < 4) truncated();
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < 4; ++i)
            value |= std::to_integer<std::uint32_t>(bytes_[at + i]) << (8 * i);
        return value;
    }

    std::uint32_t readVersion() const {
        const std::uint32_t version = integer(4);
        if ((version & 0xff) != 2) unread(fmt::format("version {}", version & 0xff));
        if (!Imf::supportsFlags(Imf::getFlags(static_cast<int>(version))))
            unread(fmt::format("the flags {:#x}", version & 0xffffff00U));
        return version;
    }

    // Past the text that ends with a zero byte; whether it was empty.
    bool skipText(std::size_t& at) const {
        const std::size_t begin = at;
        while (true) {
            if (at >= bytes_.size()) truncated();
            if (bytes_[at++] == std::byte{0}) return at - begin == 1;
        }
    }

    // OpenEXR sets aside as much memory as an attribute claims to have bytes: no attribute may claim more
    // than the file has.
    [[nodiscard]] std::size_t countParts(bool several) const {
        std::size_t at = 8;
        for (std::size_t parts = 0;; ++parts) {
            if (parts > mostParts) unread(fmt::format("more than {} parts", mostParts));
            for (bool first = true;; first = false) {
                if (skipText(at)) { // the end of a header; an empty one ends all of several
                    if (first && several) return parts;
                    if (first) damaged("it has no header");
                    break;
                }
                skipText(at);
                const std::uint32_t size = integer(at);
                at += 4;
                if (size > bytes_.size() - at) truncated();
                at += size;
            }
            if (!several) return 1;
        }
    }

    void check(const Imf::Header& header, bool tiled) const {
        if (header.compression() >= Imf::NUM_COMPRESSION_METHODS) unread("an unknown compression");
        if (header.hasType() && !Imf::isSupportedType(header.type()))
            unread(fmt::format("parts of the type '{}'", header.type()));
        checkWindow(header.displayWindow(), "");
        checkWindow(header.dataWindow(), "a data window of ");
        std::size_t channels = 0;
        for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
            checkSampling(header, channel.name(), channel.channel());
            ++channels;
        }
        if (channels == 0) damaged("it has no channels");
        if (channels > mostChannels) unread(fmt::format("more than {} channels", mostChannels));
        if (tiled)
            checkTiles(header, channels);
        else
            checkBlocks(header, channels);
    }

    void checkWindow(const Imath::Box2i& window, const char* what) const {
        for (const int edge : {window.min.x, window.min.y, window.max.x, window.max.y})
            if (edge < -farthest || edge > farthest)
                failImage(name_, fmt::format("has {}its edge at {}; edges are read to {} from the origin",
                                             what, edge, farthest));
        const int width = window.max.x - window.min.x + 1;
        const int height = window.max.y - window.min.y + 1;
        if (*what != 0 && (width > maxImageSide || height > maxImageSide))
            failImage(name_, fmt::format("has {}{}x{} pixels; at most {} pixels a side are read", what, width,
                                         height, maxImageSide));
        requireImageSize(width, height, 1, name_);
    }

    // OpenEXR reads windows that begin and end with whole steps of every channel.
    void checkSampling(const Imf::Header& header, const char* name, const Imf::Channel& channel) const {
        const Imath::Box2i& window = header.dataWindow();
        const auto whole = [](int step, int first, int last) {
            return step > 0 && first % step == 0 && (last - first + 1) % step == 0;
        };
        if (!whole(channel.xSampling, window.min.x, window.max.x) ||
            !whole(channel.ySampling, window.min.y, window.max.y))
            unread(fmt::format("the channel '{}' subsampled {}x{} in a data window that this does not divide",
                               name, channel.xSampling, channel.ySampling));
    }

    // OpenEXR holds all channels of the lines that are compressed together, however few lines there are.
    void checkBlocks(const Imf::Header& header, std::size_t channels) const {
        const auto width =
            static_cast<std::size_t>(std::int64_t{header.dataWindow().max.x} - header.dataWindow().min.x + 1);
        const std::size_t lines = linesTogether(header.compression());
        if (width * channels * lines > maxImageValues)
            failImage(name_, fmt::format("has blocks of {}x{} pixels and {} channels; at most {} values are "
                                         "read",
                                         width, lines, channels, maxImageValues));
    }

    // OpenEXR holds a tile of all channels, and a row of tiles of those that are read.
    void checkTiles(const Imf::Header& header, std::size_t channels) const {
        if (!header.hasTileDescription()) damaged("it names no size of its tiles");
        const Imf::TileDescription& tiles = header.tileDescription();
        if (tiles.xSize == 0 || tiles.ySize == 0) damaged("it has tiles without pixels");
        if (tiles.xSize > static_cast<unsigned>(maxImageSide) ||
            tiles.ySize > static_cast<unsigned>(maxImageSide))
            failImage(name_, fmt::format("has tiles of {}x{}; at most {} pixels a side are read", tiles.xSize,
                                         tiles.ySize, maxImageSide));
        if (std::size_t{tiles.xSize} * tiles.ySize * channels > maxImageValues)
            failImage(name_, fmt::format("has tiles of {}x{} pixels and {} channels; at most {} values are "
                                         "read",
                                         tiles.xSize, tiles.ySize, channels, maxImageValues));
    }

    std::span<const std::byte> bytes_;
    const std::string& name_;
};

} // namespace

std::vector<Imf::Header> readExrHeaders(std::span<const std::byte> bytes, const std::string& name) {
    return ExrHeaderReader(bytes, name).read();
}

bool isDeep(const Imf::Header& header) { return header.hasType() && Imf::isDeepData(header.type()); }

std::string exrReason(const std::exception& problem) {
    std::string text = problem.what();
    // 'Error reading pixel data from image file "". Bad Huffman code.' says no more than its end.
    if (const std::size_t named = text.find("\"\". "); named != std::string::npos) text.erase(0, named + 4);
    text.erase(std::find(text.begin(), text.end(), '\n'), text.end());
    while (text.ends_with('.') || text.ends_with(' ')) text.pop_back();
    if (!text.empty() && text.size() > 1 && text[1] >= 'a' && text[0] >= 'A' && text[0] <= 'Z')
        text[0] = static_cast<char>(text[0] - 'A' + 'a');
    return text.empty() ? "the decoder gives no reason" : text;
}

} // namespace kestrel::detail
