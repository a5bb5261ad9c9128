// Radiance RGBE pictures (Ward, "Real Pixels", Graphics Gems II, 1991). Read here rather than by stb, which
// takes missing bytes at the end of a file for zeros.
#include "core/check.h"
#include "image/formats.h"
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>
#include <limits>
#include <stb_image_write.h>
#include <string_view>

namespace kestrel::detail {
namespace {

class HdrReader {
public:
    HdrReader(std::span<const std::byte> bytes, const std::string& name)
        : bytes_(bytes)
        , name_(name) {}

    Image read() {
        readHeader();
        readResolution();
        Image image(width_, height_, 3);
        std::vector<std::uint8_t> row(static_cast<std::size_t>(width_) * 4);
        for (int y = 0; y < height_; ++y) {
            readRow(row);
            for (int x = 0; x < width_; ++x)
                decodePixel(&row[static_cast<std::size_t>(x) * 4], &image.at(x, y));
        }
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
        return {reinterpret_cast<const char*>(&bytes_[begin]), at_ - 1 - begin};
    }

    void readHeader() {
        const std::string_view first = line();
        if (first != "#?RADIANCE" && first != "#?RGBE") failImage(name_, "is not an HDR picture");
        for (std::string_view text = line(); !text.empty(); text = line()) {
            if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe")
                failImage(name_,
                          fmt::format("is an HDR picture of the kind '{}'; only 32-bit_rle_rgbe is read",
                                      text.substr(7)));
            if (text.starts_with("EXPOSURE=")) readExposure(text.substr(9));
        }
    }

    void readExposure(std::string_view text) {
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
        double exposure = 0;
        const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), exposure);
        if (failure != std::errc{} || !std::isfinite(exposure) || !(exposure > 0))
            damaged(fmt::format("the exposure '{}' is not a positive number", text));
        exposure_ *= exposure;
        if (!(exposure_ > 1e-100 && exposure_ < 1e100)) damaged("its exposures multiply to no usable number");
    }

    void readResolution() {
        const std::string text(line());
        int used = 0;
        long long width = 0;
        long long height = 0;
        if (std::sscanf(text.c_str(), "-Y %9lld +X %9lld%n", &height, &width, &used) != 2 ||
            static_cast<std::size_t>(used) != text.size())
            damaged(fmt::format("the resolution '{}' is not of the form '-Y height +X width'", text));
        requireImageSize(width, height, 3, name_);
        width_ = static_cast<int>(width);
        height_ = static_cast<int>(height);
        // Four bytes a pixel, or at best runs of 127, stand for every row: no pixel is allocated for less.
        const std::size_t plain = static_cast<std::size_t>(width_) * 4;
        const std::size_t least = std::min(plain, 4 + 8 * ((static_cast<std::size_t>(width_) + 126) / 127));
        if ((bytes_.size() - at_) / least < static_cast<std::size_t>(height_)) truncated();
    }

    void readRow(std::vector<std::uint8_t>& row) {
        std::array<std::uint8_t, 4> start{byte(), byte(), byte(), byte()};
        const bool runs = width_ >= 8 && width_ < 32768 && start[0] == 2 && start[1] == 2 && start[2] < 128;
        if (!runs) {
            std::copy(start.begin(), start.end(), row.begin());
            for (std::size_t i = 4; i < row.size(); ++i) row[i] = byte();
            return;
        }
        if (start[2] * 256 + start[3] != width_) damaged("a row of another width");
        for (std::size_t component = 0; component < 4; ++component) readRuns(row, component);
    }

    // One component of a row: counts above 128 repeat a byte count - 128 times, others copy count bytes.
    void readRuns(std::vector<std::uint8_t>& row, std::size_t component) {
        for (int x = 0; x < width_;) {
            int count = byte();
            const bool repeat = count > 128;
            if (repeat) count -= 128;
            if (count == 0 || count > width_ - x) damaged("a run beyond its row");
            std::uint8_t value = 0;
            for (int i = 0; i < count; ++i, ++x) {
                if (!repeat || i == 0) value = byte();
                row[static_cast<std::size_t>(x) * 4 + component] = value;
            }
        }
    }

    void decodePixel(const std::uint8_t* rgbe, float* rgb) const {
        const double scale = rgbe[3] == 0 ? 0.0 : std::ldexp(1.0, rgbe[3] - 136) / exposure_;
        constexpr double greatest = std::numeric_limits<float>::max();
        for (int channel = 0; channel < 3; ++channel)
            rgb[channel] = static_cast<float>(std::min(rgbe[channel] * scale, greatest));
    }

    std::span<const std::byte> bytes_;
    const std::string& name_;
    std::size_t at_ = 0;
    int width_ = 0;
    int height_ = 0;
    double exposure_ = 1;
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
