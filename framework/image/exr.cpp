#include "core/check.h"
#include "core/log.h"
#include "image/exr_layout.h"
#include "image/formats.h"
#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <string_view>
#include <tinyexr.h>

namespace kestrel::detail {
namespace {

// tinyexr's structures, freed however the function is left.
struct Header {
    EXRHeader value;
    Header() { InitEXRHeader(&value); }
    Header(const Header&) = delete;
    Header& operator=(const Header&) = delete;
    ~Header() { FreeEXRHeader(&value); }
};

struct Pixels {
    EXRImage value;
    Pixels() { InitEXRImage(&value); }
    Pixels(const Pixels&) = delete;
    Pixels& operator=(const Pixels&) = delete;
    ~Pixels() { FreeEXRImage(&value); }
};

struct Message {
    const char* text = nullptr;
    Message() = default;
    Message(const Message&) = delete;
    Message& operator=(const Message&) = delete;
    ~Message() { FreeEXRErrorMessage(text); }
    // The library's sentence in one line.
    [[nodiscard]] std::string line() const {
        std::string result = text == nullptr ? "the decoder gives no reason" : text;
        std::replace(result.begin(), result.end(), '\n', ' ');
        while (!result.empty() && (result.back() == ' ' || result.back() == '.')) result.pop_back();
        return result;
    }
};

int find(const ExrLayout& layout, std::string_view channel) {
    for (std::size_t i = 0; i < layout.channels.size(); ++i)
        if (layout.channels[i].name == channel) return static_cast<int>(i);
    return -1;
}

// The positions in the file of the channels that are read, in the image's order.
std::vector<int> chooseChannels(const ExrLayout& layout, const std::string& name) {
    if (layout.channels.size() == 1) return {0};
    // RGBA, RGB, RG, position or normal, grey.
    static const std::vector<std::vector<std::string_view>> orders{
        {"R", "G", "B", "A"}, {"R", "G", "B"}, {"R", "G"}, {"X", "Y", "Z"}, {"X", "Y"}, {"Y"}};
    for (const auto& order : orders) {
        std::vector<int> chosen;
        for (const std::string_view channel : order) chosen.push_back(find(layout, channel));
        if (std::find(chosen.begin(), chosen.end(), -1) == chosen.end()) return chosen;
    }
    std::vector<std::string> names;
    for (const ExrChannel& channel : layout.channels) names.push_back("'" + channel.name + "'");
    failImage(name, fmt::format("has the channels {}: neither RGB nor XYZ nor a single one",
                                fmt::join(names, ", ")));
}

void warnOfOthers(const ExrLayout& layout, const std::vector<int>& chosen, const std::string& name) {
    std::vector<std::string> others;
    for (std::size_t i = 0; i < layout.channels.size(); ++i)
        if (std::find(chosen.begin(), chosen.end(), static_cast<int>(i)) == chosen.end())
            others.push_back(printable(layout.channels[i].name));
    if (!others.empty()) logWarning("{}: left out: the channels {}", name, fmt::join(others, ", "));
}

void decodePlanes(std::span<const std::byte> bytes, const std::string& name, Header& header, Pixels& pixels) {
    const auto* file = reinterpret_cast<const unsigned char*>(bytes.data());
    Message message;
    EXRVersion version;
    if (ParseEXRVersionFromMemory(&version, file, bytes.size()) != TINYEXR_SUCCESS)
        failImage(name, "is not an EXR");
    if (ParseEXRHeaderFromMemory(&header.value, &version, file, bytes.size(), &message.text) !=
        TINYEXR_SUCCESS)
        failImage(name, "is a damaged EXR: " + message.line());
    for (int channel = 0; channel < header.value.num_channels; ++channel)
        if (header.value.pixel_types[channel] == TINYEXR_PIXELTYPE_HALF)
            header.value.requested_pixel_types[channel] = TINYEXR_PIXELTYPE_FLOAT;
    // The order of the lines in the file does not turn the picture over, as the decoder would have it.
    header.value.line_order = 0;
    // With this number the library frees every plane where it fails.
    pixels.value.num_channels = header.value.num_channels;
    if (LoadEXRImageFromMemory(&pixels.value, &header.value, file, bytes.size(), &message.text) !=
        TINYEXR_SUCCESS) {
        InitEXRImage(&pixels.value); // the library has freed it, but left the pointers
        failImage(name, "is a damaged EXR: " + message.line());
    }
}

std::vector<std::string_view> channelNames(int channels) {
    static constexpr std::array<std::string_view, 4> names{"R", "G", "B", "A"};
    if (channels == 1) return {"Y"};
    return {names.begin(), names.begin() + channels};
}

} // namespace

Image decodeExr(std::span<const std::byte> bytes, const std::string& name) {
    const ExrLayout layout = scanExr(bytes, name);
    const std::vector<int> chosen = chooseChannels(layout, name);
    for (const int channel : chosen)
        if (layout.channels[static_cast<std::size_t>(channel)].type == ExrPixelType::Uint)
            failImage(name, fmt::format("holds integers in the channel '{}'; half and float are read",
                                        layout.channels[static_cast<std::size_t>(channel)].name));
    // The decoder of PIZ takes the length of its tables (at most 8192 bytes of bitmap) from the data without
    // asking how much data there is: with zeros behind the file it reads those.
    std::vector<std::byte> padded;
    if (layout.piz) {
        padded.assign(bytes.begin(), bytes.end());
        padded.resize(padded.size() + 65536);
        bytes = padded;
    }
    Header header;
    Pixels pixels;
    try {
        decodePlanes(bytes, name, header, pixels);
    } catch (const std::out_of_range& problem) { // the decoder's own bounds checks
        failImage(name, fmt::format("is a damaged EXR: {}", problem.what()));
    }
    KESTREL_CHECK_EQ(header.value.num_channels, static_cast<int>(layout.channels.size()));
    KESTREL_CHECK_EQ(pixels.value.width, layout.width);
    KESTREL_CHECK_EQ(pixels.value.height, layout.height);
    warnOfOthers(layout, chosen, name);

    Image image(layout.width, layout.height, static_cast<int>(chosen.size()));
    for (std::size_t channel = 0; channel < chosen.size(); ++channel) {
        const auto* plane = reinterpret_cast<const float*>(pixels.value.images[chosen[channel]]);
        for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel)
            image.values[pixel * chosen.size() + channel] = plane[pixel];
    }
    return image;
}

std::vector<std::byte> encodeExr(const Image& image) {
    const auto channels = static_cast<std::size_t>(image.channels);
    // The file lists channels by the alphabet.
    const std::vector<std::string_view> names = channelNames(image.channels);
    std::vector<std::size_t> order(channels);
    for (std::size_t i = 0; i < channels; ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return names[a] < names[b]; });

    std::vector<std::vector<float>> planes(channels, std::vector<float>(image.pixelCount()));
    std::vector<unsigned char*> pointers(channels);
    std::vector<EXRChannelInfo> infos(channels);
    std::vector<int> types(channels, TINYEXR_PIXELTYPE_FLOAT);
    for (std::size_t i = 0; i < channels; ++i) {
        for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel)
            planes[i][pixel] = image.values[pixel * channels + order[i]];
        pointers[i] = reinterpret_cast<unsigned char*>(planes[i].data());
        infos[i] = {};
        names[order[i]].copy(infos[i].name, sizeof infos[i].name - 1);
    }

    EXRHeader header;
    InitEXRHeader(&header);
    header.num_channels = image.channels;
    header.channels = infos.data();
    header.pixel_types = types.data();
    header.requested_pixel_types = types.data();
    header.compression_type = TINYEXR_COMPRESSIONTYPE_ZIP;
    EXRImage pixels;
    InitEXRImage(&pixels);
    pixels.images = pointers.data();
    pixels.width = image.width;
    pixels.height = image.height;
    pixels.num_channels = image.channels;

    Message message;
    unsigned char* memory = nullptr;
    const std::size_t size = SaveEXRImageToMemory(&pixels, &header, &memory, &message.text);
    const std::unique_ptr<unsigned char, decltype(&std::free)> owner(memory, std::free);
    KESTREL_CHECK_NE(size, std::size_t{0});
    std::vector<std::byte> bytes(size);
    std::memcpy(bytes.data(), memory, size);
    return bytes;
}

} // namespace kestrel::detail
