// Radiance pictures (Ward, "Real Pixels", Graphics Gems II, 1991; "The RADIANCE File Formats"). Read here
// rather than by stb, which takes missing bytes at the end of a file for zeros and knows one orientation.
#include "core/check.h"
#include "core/log.h"
#include "image/formats.h"
#include "image/primaries.h"
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <stb_image_write.h>
#include <string_view>

namespace kestrel::detail {
namespace {

// What Radiance takes for granted where no primaries are stated. Its white is called white here too, so
// pictures of these primaries are not converted: that is how every program treats them.
constexpr Primaries radiancePrimaries{{0.640, 0.330}, {0.290, 0.600}, {0.150, 0.060}, {0.333, 0.333}};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    return text.substr(0, text.find_last_not_of(blanks) + 1);
}

// The numbers of a line, separated by blanks; nothing if anything else stands there.
std::optional<std::vector<double>> numbers(std::string_view text) {
    std::vector<double> result;
    for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
        if (text.starts_with('+')) text.remove_prefix(1);
        double value = 0;
        const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
        const auto used = static_cast<std::size_t>(end - text.data());
        if (failure != std::errc{} || !std::isfinite(value)) return std::nullopt;
        text.remove_prefix(used);
        if (!text.empty() && text[0] != ' ' && text[0] != '\t') return std::nullopt;
        result.push_back(value);
    }
    return result;
}

class HdrReader {
public:
    HdrReader(std::span<const std::byte> bytes, const std::string& name)
        : bytes_(bytes)
        , name_(name) {}

    Image read() {
        readHeader();
        readResolution();
        Image image = columns_ ? Image(lines_, length_, 3) : Image(length_, lines_, 3);
        std::vector<std::uint8_t> row(static_cast<std::size_t>(length_) * 4);
        for (int line = 0; line < lines_; ++line) {
            readRow(row);
            const int outer = lineBackward_ ? lines_ - 1 - line : line;
            for (int i = 0; i < length_; ++i) {
                const int inner = backward_ ? length_ - 1 - i : i;
                decodePixel(&row[static_cast<std::size_t>(i) * 4],
                            columns_ ? &image.at(outer, inner) : &image.at(inner, outer));
            }
        }
        convertColours(image);
        return image;
    }

private:
    [[noreturn]] void truncated() const { failImage(name_, "is a truncated HDR picture"); }
    [[noreturn]] void damaged(const std::string& how) const {
        failImage(name_, "is a damaged HDR picture: " + how);
    }

    std::uint8_t byte() {
        if (at_ == bytes_.size()) truncated();
        return std::to_integer<std::uint8_t>(bytes_[at_++]);
    }

    // A line of the header without its end.
    std::string_view line() {
        constexpr std::size_t longest = 4096;
        const std::size_t begin = at_;
        while (byte() != '\n')
            if (at_ - begin > longest) damaged("a header line without end");
        std::string_view text(reinterpret_cast<const char*>(&bytes_[begin]), at_ - 1 - begin);
        if (text.ends_with('\r')) text.remove_suffix(1);
        return text;
    }

    void readHeader() {
        if (!line().starts_with("#?")) failImage(name_, "is not an HDR picture");
        // Lines that begin with a blank tell of pictures that this one was made from.
        for (std::string_view text = line(); !text.empty(); text = line()) {
            if (text.starts_with("FORMAT=")) readFormat(trimmed(text.substr(7)));
            if (text.starts_with("EXPOSURE=")) readFactors(text.substr(9), 1, "exposure");
            if (text.starts_with("COLORCORR=")) readFactors(text.substr(10), 3, "colour correction");
            if (text.starts_with("PRIMARIES=")) readPrimaries(text.substr(10));
        }
        if (factors_ != glm::dvec3(1))
            logWarning("{}: divided by the exposure and colour correction of its header, ({:.6g}, {:.6g}, "
                       "{:.6g})",
                       name_, factors_.r, factors_.g, factors_.b);
    }

    void readFormat(std::string_view format) {
        xyz_ = format == "32-bit_rle_xyze";
        if (!xyz_ && format != "32-bit_rle_rgbe")
            failImage(name_, fmt::format("is an HDR picture of the kind '{}', which is not read", format));
    }

    // What the pixels were multiplied by: lines of one kind add up.
    void readFactors(std::string_view text, std::size_t count, const char* what) {
        const auto values = numbers(text);
        const bool usable = values && values->size() == count &&
                            std::all_of(values->begin(), values->end(), [](double v) { return v > 0; });
        if (!usable)
            damaged(fmt::format("the {} '{}' is not {}", what, trimmed(text),
                                count == 1 ? "a positive number" : "three positive numbers"));
        for (int channel = 0; channel < 3; ++channel) {
            factors_[channel] *= (*values)[count == 1 ? 0 : static_cast<std::size_t>(channel)];
            if (!(factors_[channel] > 1e-100 && factors_[channel] < 1e100))
                damaged(fmt::format("its {}s multiply to no usable number", what));
        }
    }

    void readPrimaries(std::string_view text) {
        const auto values = numbers(text);
        if (!values || values->size() != 8) {
            logWarning("{}: its primaries '{}' are not eight numbers and are not used", name_,
                       printable(std::string(trimmed(text))));
            return;
        }
        const std::vector<double>& v = *values;
        primaries_ = {{v[0], v[1]}, {v[2], v[3]}, {v[4], v[5]}, {v[6], v[7]}};
    }

    // Two axes: that of the lines first, then that along a line; y counts upward.
    void readResolution() {
        const std::string text(line());
        std::array<char, 4> axis{};
        long long lines = 0;
        long long length = 0;
        int used = 0;
        const int found = std::sscanf(text.c_str(), "%c%c %9lld %c%c %9lld %n", &axis[0], &axis[1], &lines,
                                      &axis[2], &axis[3], &length, &used);
        const auto isAxis = [](char sign, char letter) {
            return (sign == '+' || sign == '-') && (letter == 'X' || letter == 'Y');
        };
        if (found != 6 || static_cast<std::size_t>(used) != text.size() || !isAxis(axis[0], axis[1]) ||
            !isAxis(axis[2], axis[3]) || axis[1] == axis[3])
            damaged(fmt::format("the resolution '{}' is not of the form '-Y height +X width', in any of its "
                                "eight orders and signs",
                                text));
        columns_ = axis[1] == 'X';
        lineBackward_ = axis[0] == (columns_ ? '-' : '+');
        backward_ = axis[2] == (columns_ ? '+' : '-');
        requireImageSize(columns_ ? lines : length, columns_ ? length : lines, 3, name_);
        lines_ = static_cast<int>(lines);
        length_ = static_cast<int>(length);
        requireBytes();
    }

    // No pixel is allocated for less than the fewest bytes that can stand for a line: four a pixel, or runs
    // of 127, or a pixel and one or two repeats of the old kind.
    void requireBytes() const {
        const auto length = static_cast<std::size_t>(length_);
        const std::size_t old = length == 1 ? 4 : length <= 256 ? 8 : 12;
        const std::size_t least = std::min({length * 4, 4 + 8 * ((length + 126) / 127), old});
        if ((bytes_.size() - at_) / least < static_cast<std::size_t>(lines_)) truncated();
    }

    void readRow(std::vector<std::uint8_t>& row) {
        const std::array<std::uint8_t, 4> start{byte(), byte(), byte(), byte()};
        const bool runs = length_ >= 8 && length_ < 32768 && start[0] == 2 && start[1] == 2 && start[2] < 128;
        if (!runs) return readOldRow(row, start);
        if (start[2] * 256 + start[3] != length_) damaged("a row of another width");
        for (std::size_t component = 0; component < 4; ++component) readRuns(row, component);
    }

    // Pixels one after the other; one with the mantissas 1, 1, 1 repeats the pixel before it as often as its
    // exponent says, and 256 times as often for each repeat that it follows.
    void readOldRow(std::vector<std::uint8_t>& row, std::array<std::uint8_t, 4> pixel) {
        int shift = 0;
        for (int x = 0;;) {
            if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
                if (x == 0) damaged("a repeat without a pixel before it");
                const std::int64_t count = shift > 16 ? -1 : std::int64_t{pixel[3]} << shift;
                if (count < 0 || count > length_ - x) damaged("a run beyond its row");
                for (std::int64_t i = 0; i < count; ++i, ++x)
                    std::copy_n(&row[static_cast<std::size_t>(x - 1) * 4], 4,
                                &row[static_cast<std::size_t>(x) * 4]);
                shift += 8;
            } else {
                std::copy(pixel.begin(), pixel.end(), &row[static_cast<std::size_t>(x) * 4]);
                ++x;
                shift = 0;
            }
            if (x == length_) return;
            pixel = {byte(), byte(), byte(), byte()};
        }
    }

    // One component of a row: counts above 128 repeat a byte count - 128 times, others copy count bytes.
    void readRuns(std::vector<std::uint8_t>& row, std::size_t component) {
        for (int x = 0; x < length_;) {
            int count = byte();
            const bool repeat = count > 128;
            if (repeat) count -= 128;
            if (count == 0 || count > length_ - x) damaged("a run beyond its row");
            std::uint8_t value = 0;
            for (int i = 0; i < count; ++i, ++x) {
                if (!repeat || i == 0) value = byte();
                row[static_cast<std::size_t>(x) * 4 + component] = value;
            }
        }
    }

    void decodePixel(const std::uint8_t* rgbe, float* rgb) const {
        const double scale = rgbe[3] == 0 ? 0.0 : std::ldexp(1.0, rgbe[3] - 136);
        constexpr double greatest = std::numeric_limits<float>::max();
        for (int channel = 0; channel < 3; ++channel)
            rgb[channel] = static_cast<float>(std::min(rgbe[channel] * scale / factors_[channel], greatest));
    }

    void convertColours(Image& image) const {
        const bool stated =
            primaries_ && !alike(*primaries_, rec709) && !alike(*primaries_, radiancePrimaries);
        if (!xyz_ && !stated) return;
        const Primaries& from = xyz_ ? cieXyz : *primaries_;
        if (const auto matrix = toRec709(from)) {
            transformColours(image, *matrix);
            logWarning("{}: converted to the primaries of Rec. 709 from {}", name_,
                       xyz_ ? "CIE XYZ" : describe(from));
        } else if (from != Primaries{{0, 0}, {0, 0}, {0, 0}, {0, 0}}) { // zeros: a program that states none
            logWarning("{}: its primaries span no colours and are not used: {}", name_, describe(from));
        }
    }

    std::span<const std::byte> bytes_;
    const std::string& name_;
    std::size_t at_ = 0;
    bool xyz_ = false;
    glm::dvec3 factors_{1};
    std::optional<Primaries> primaries_;
    int lines_ = 0;
    int length_ = 0;
    bool columns_ = false;      // a line of the file is a column of the picture
    bool lineBackward_ = false; // the lines come from the bottom, or from the right
    bool backward_ = false;     // along a line the pixels come from the right, or from the bottom
};

} // namespace

Image decodeHdr(std::span<const std::byte> bytes, const std::string& name) {
    return HdrReader(bytes, name).read();
}

std::vector<std::byte> encodeHdr(const Image& image) {
    // The greatest mantissa at the greatest exponent: 255/256 * 2^127.
    const float greatest = std::ldexp(255.0F, 119);
    Image color = convertChannels(image, 3);
    for (float& value : color.values) value = value > 0 ? std::min(value, greatest) : 0.0F;
    std::vector<std::byte> bytes;
    const int written =
        stbi_write_hdr_to_func(appendBytes, &bytes, color.width, color.height, 3, color.values.data());
    KESTREL_CHECK_NE(written, 0);
    return bytes;
}

} // namespace kestrel::detail
