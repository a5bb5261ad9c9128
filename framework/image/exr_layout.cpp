#include "image/exr_layout.h"
#include "image/formats.h"
#include <algorithm>
#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <optional>
#include <string_view>

namespace kestrel::detail {
namespace {

struct Compression {
    std::string_view name;
    int linesPerChunk; // 0: not read
};
// By the number that stands in the file.
constexpr std::array<Compression, 10> compressions{{{"none", 1},
                                                    {"RLE", 1},
                                                    {"ZIPS", 1},
                                                    {"ZIP", 16},
                                                    {"PIZ", 32},
                                                    {"PXR24", 0},
                                                    {"B44", 0},
                                                    {"B44A", 0},
                                                    {"DWAA", 0},
                                                    {"DWAB", 0}}};

class ExrScanner {
public:
    ExrScanner(std::span<const std::byte> bytes, const std::string& name)
        : bytes_(bytes)
        , name_(name) {}

    ExrLayout scan() {
        readVersion();
        readAttributes();
        checkHeader();
        checkChunks();
        return layout_;
    }

private:
    struct Window {
        std::int32_t minX, minY, maxX, maxY;
    };

    [[noreturn]] void damaged(const std::string& how) const { failImage(name_, "is a damaged EXR: " + how); }
    [[noreturn]] void unread(const std::string& what) const {
        failImage(name_, fmt::format("is an EXR with {}, which is not read", what));
    }

    // The little-endian integer at `at`.
    template<class T>
    T integer(std::size_t at) const {
        if (at > bytes_.size() || bytes_.size() - at < sizeof(T)) failImage(name_, "is a truncated EXR");
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i)
            value |= std::to_integer<std::uint64_t>(bytes_[at + i]) << (8 * i);
        return static_cast<T>(value);
    }

    // The text up to the next zero byte before `end`; moves past it.
    std::string text(std::size_t& at, std::size_t end) const {
        constexpr std::size_t longest = 255;
        std::string result;
        while (true) {
            if (at >= end) failImage(name_, "is a truncated EXR");
            const char letter = static_cast<char>(bytes_[at++]);
            if (letter == 0) return result;
            if (result.size() == longest) damaged("a name of more than 255 letters");
            result += letter;
        }
    }

    void readVersion() {
        if (bytes_.size() < 4 || integer<std::uint32_t>(0) != 20000630) failImage(name_, "is not an EXR");
        const auto version = integer<std::uint32_t>(4);
        if ((version & 0xff) != 2) unread(fmt::format("version {}", version & 0xff));
        if ((version & 0x200) != 0) unread("tiles");
        if ((version & 0x800) != 0) unread("deep data");
        if ((version & 0x1000) != 0) unread("several parts");
    }

    void readAttributes() {
        std::size_t at = 8;
        for (int count = 0;; ++count) {
            const std::string attribute = text(at, bytes_.size());
            if (attribute.empty()) break;
            if (count == 1000) damaged("more than 1000 attributes"); // the decoder stops at 1024
            const std::string type = text(at, bytes_.size());
            const auto size = integer<std::int32_t>(at);
            at += 4;
            if (size <= 0) damaged(fmt::format("the attribute '{}' is empty", attribute));
            if (static_cast<std::size_t>(size) > bytes_.size() - at) failImage(name_, "is a truncated EXR");
            readAttribute(attribute, at, static_cast<std::size_t>(size));
            at += static_cast<std::size_t>(size);
        }
        chunkTable_ = at;
    }

    void readAttribute(const std::string& attribute, std::size_t at, std::size_t size) {
        if (attribute == "channels") readChannels(at, at + size);
        if (attribute == "compression") {
            if (size != 1) damaged("its compression is not one byte");
            compression_ = integer<std::uint8_t>(at);
        }
        if (attribute == "dataWindow") {
            if (size != 16) damaged("its data window is not a box");
            window_ = Window{integer<std::int32_t>(at), integer<std::int32_t>(at + 4),
                             integer<std::int32_t>(at + 8), integer<std::int32_t>(at + 12)};
        }
        if (attribute == "chunkCount") {
            if (size != 4) damaged("its chunk count is not an integer");
            chunkCount_ = integer<std::int32_t>(at);
        }
        if (attribute == "tiles") unread("tiles");
    }

    void readChannels(std::size_t at, std::size_t end) {
        if (!layout_.channels.empty()) damaged("two lists of channels");
        constexpr std::size_t most = 1024;
        while (true) {
            const std::string channel = text(at, end);
            if (channel.empty()) break;
            if (end - at < 17) damaged("its list of channels is cut off"); // 16 bytes and the list's end
            const auto type = integer<std::int32_t>(at);
            if (type < 0 || type > 2) damaged(fmt::format("the channel '{}' has a type {}", channel, type));
            if (integer<std::int32_t>(at + 8) != 1 || integer<std::int32_t>(at + 12) != 1)
                unread("subsampled channels");
            if (layout_.channels.size() == most) damaged("more than 1024 channels");
            layout_.channels.push_back({channel, static_cast<ExrPixelType>(type)});
            at += 16;
        }
        if (at != end) damaged("its list of channels goes on after its end");
    }

    void checkHeader() {
        if (layout_.channels.empty()) damaged("it has no channels");
        if (!compression_) damaged("it names no compression");
        if (!window_) damaged("it has no data window");
        if (*compression_ >= compressions.size()) damaged(fmt::format("the compression {}", *compression_));
        if (compressions[*compression_].linesPerChunk == 0)
            unread(fmt::format("the compression {} (PIZ, ZIP, ZIPS, RLE and none are)",
                               compressions[*compression_].name));
        const auto width = std::int64_t{window_->maxX} - window_->minX + 1;
        const auto height = std::int64_t{window_->maxY} - window_->minY + 1;
        requireImageSize(width, height, static_cast<std::int64_t>(layout_.channels.size()), name_);
        constexpr std::int32_t farthest = 1 << 20; // the decoder takes lines beyond twice this for damage
        if (window_->minY < -farthest || window_->maxY > farthest || window_->minX < -farthest ||
            window_->maxX > farthest)
            damaged("its data window is far from the origin");
        layout_.width = static_cast<int>(width);
        layout_.height = static_cast<int>(height);
        layout_.piz = compressions[*compression_].name == "PIZ";
    }

    void checkChunks() const {
        const int lines = compressions[*compression_].linesPerChunk;
        const int count = (layout_.height + lines - 1) / lines;
        if (chunkCount_ && *chunkCount_ != count)
            damaged(fmt::format("it counts {} chunks instead of {}", *chunkCount_, count));
        std::size_t pixelBytes = 0;
        for (const ExrChannel& channel : layout_.channels)
            pixelBytes += channel.type == ExrPixelType::Half ? 2 : 4;

        for (int chunk = 0; chunk < count; ++chunk) {
            const auto offset = integer<std::uint64_t>(chunkTable_ + static_cast<std::size_t>(chunk) * 8);
            if (offset == 0 || offset > bytes_.size()) failImage(name_, "is a truncated EXR");
            const auto at = static_cast<std::size_t>(offset);
            const int firstLine = chunk * lines;
            if (integer<std::int32_t>(at) != window_->minY + firstLine) damaged("a chunk of other lines");
            const auto size = integer<std::int32_t>(at + 4);
            const std::size_t plain = static_cast<std::size_t>(layout_.width) * pixelBytes *
                                      static_cast<std::size_t>(std::min(lines, layout_.height - firstLine));
            // What does not shrink is stored as it is, so no chunk is larger than its pixels.
            if (size <= 0 || static_cast<std::size_t>(size) > plain ||
                (*compression_ == 0 && static_cast<std::size_t>(size) != plain))
                damaged("a chunk of an impossible size");
            if (static_cast<std::size_t>(size) > bytes_.size() - at - 8)
                failImage(name_, "is a truncated EXR");
        }
    }

    std::span<const std::byte> bytes_;
    const std::string& name_;
    ExrLayout layout_;
    std::optional<std::uint8_t> compression_;
    std::optional<Window> window_;
    std::optional<std::int32_t> chunkCount_;
    std::size_t chunkTable_ = 0;
};

} // namespace

ExrLayout scanExr(std::span<const std::byte> bytes, const std::string& name) {
    return ExrScanner(bytes, name).scan();
}

} // namespace kestrel::detail
