// OpenEXR pictures, read and written by the OpenEXR library.
#include "core/check.h"
#include "core/error.h"
#include "core/log.h"
#include "image/exr_chroma.h"
#include "image/exr_header.h"
#include "image/exr_layers.h"
#include "image/exr_stream.h"
#include "image/formats.h"
#include "image/primaries.h"
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <algorithm>
#include <array>
#include <exception>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <new>
#include <string_view>

namespace kestrel::detail {
namespace {

int widthOf(const Imath::Box2i& window) { return window.max.x - window.min.x + 1; }
int heightOf(const Imath::Box2i& window) { return window.max.y - window.min.y + 1; }

std::vector<ExrPart> partsOf(const std::vector<Imf::Header>& headers) {
    std::vector<ExrPart> parts;
    for (const Imf::Header& header : headers) {
        ExrPart part{header.hasName() ? header.name() : "", {}, isDeep(header)};
        if (Imf::hasMultiView(header) && !Imf::multiView(header).empty())
            part.view = Imf::multiView(header).front();
        for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
            part.channels.emplace_back(channel.name());
        parts.push_back(std::move(part));
    }
    return parts;
}

void tellChoice(const std::vector<ExrPart>& parts, const ExrLayer& layer, const std::string& name) {
    constexpr std::size_t most = 16; // a line that can be read
    std::vector<std::string> others;
    std::size_t count = 0;
    for (std::size_t part = 0; part < parts.size(); ++part)
        for (const std::string& channel : parts[part].channels) {
            const bool taken = part == layer.part && std::find(layer.channels.begin(), layer.channels.end(),
                                                               channel) != layer.channels.end();
            if (taken || ++count > most) continue;
            others.push_back(printable(parts.size() > 1 ? parts[part].name + "." + channel : channel));
        }
    if (count > most) others.push_back(fmt::format("and {} more", count - most));
    const bool said = layer.chosen && !layer.name.empty();
    if (said && others.empty())
        logWarning("{}: took the layer '{}'", name, printable(layer.name));
    else if (said)
        logWarning("{}: took the layer '{}'; left out: the channels {}", name, printable(layer.name),
                   fmt::join(others, ", "));
    else if (!others.empty())
        logWarning("{}: left out: the channels {}", name, fmt::join(others, ", "));
}

// The picture in the display window: 0 where there are no data.
Image inDisplayWindow(Image data, const Imf::Header& header, const std::string& name) {
    const Imath::Box2i& from = header.dataWindow();
    const Imath::Box2i& to = header.displayWindow();
    if (from == to) return data;
    Image picture(widthOf(to), heightOf(to), data.channels);
    const Imath::V2i begin(std::max(from.min.x, to.min.x), std::max(from.min.y, to.min.y));
    const Imath::V2i end(std::min(from.max.x, to.max.x) + 1, std::min(from.max.y, to.max.y) + 1);
    if (begin.x >= end.x || begin.y >= end.y) {
        logWarning("{}: is black: its pixels lie outside of its display window", name);
        return picture;
    }
    for (int y = begin.y; y < end.y; ++y)
        std::copy_n(data.values.begin() +
                        static_cast<std::ptrdiff_t>(data.index(begin.x - from.min.x, y - from.min.y)),
                    (end.x - begin.x) * data.channels,
                    picture.values.begin() +
                        static_cast<std::ptrdiff_t>(picture.index(begin.x - to.min.x, y - to.min.y)));
    return picture;
}

class ExrReader {
public:
    ExrReader(std::span<const std::byte> bytes, const Imf::Header& header, const ExrLayer& layer,
              const std::string& name)
        : stream_(bytes)
        , header_(header)
        , layer_(layer)
        , name_(name)
        , data_(header.dataWindow()) {}

    Image read() {
        checkSampling();
        const int channels = static_cast<int>(layer_.channels.size());
        for (const Imath::Box2i& window : {data_, header_.displayWindow()})
            requireImageSize(widthOf(window), heightOf(window), channels, name_);
        Image image = readPixels();
        if (image.channels >= 3 && colours()) convertColours(image);
        return inDisplayWindow(std::move(image), header_, name_);
    }

private:
    [[nodiscard]] const Imf::Channel& channel(const std::string& wanted) const {
        return header_.channels()[wanted];
    }

    // Whether the channels are colours and not a position or a normal.
    [[nodiscard]] bool colours() const {
        const std::string& first = layer_.channels.front();
        return layer_.chroma || first.ends_with('R') || first.ends_with('r');
    }

    void checkSampling() const {
        for (std::size_t i = 0; i < layer_.channels.size(); ++i) {
            const Imf::Channel& read = channel(layer_.channels[i]);
            const bool mayBeHalved = layer_.chroma && (i == 1 || i == 2);
            const int most = mayBeHalved ? 2 : 1;
            if (read.xSampling < 1 || read.xSampling > most || read.ySampling < 1 || read.ySampling > most)
                failImage(name_, fmt::format("is an EXR whose channel '{}' is subsampled {}x{}, which is not "
                                             "read",
                                             layer_.channels[i], read.xSampling, read.ySampling));
        }
        if (!layer_.chroma) return;
        const Imf::Channel& red = channel(layer_.channels[1]);
        const Imf::Channel& blue = channel(layer_.channels[2]);
        if (red.xSampling != blue.xSampling || red.ySampling != blue.ySampling)
            failImage(name_, "is an EXR whose chroma channels are subsampled differently, which is not read");
    }

    // Memory for the pixels is set aside once it is known that the file has all of them.
    Image readPixels() {
        try {
            Imf::MultiPartInputFile file(stream_, 0, false);
            Imf::InputPart part(file, static_cast<int>(layer_.part));
            if (!part.isComplete()) failImage(name_, "is a truncated EXR: not all of its pixels are there");
            return layer_.chroma ? readChroma(part) : readChannels(part);
        } catch (const Error&) {
            throw;
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& problem) {
            if (stream_.ranOut()) failImage(name_, "is a truncated EXR");
            failImage(name_, "is a damaged EXR: " + exrReason(problem));
        }
    }

    void readInto(Imf::InputPart& part, const Imf::FrameBuffer& pixels) const {
        part.setFrameBuffer(pixels);
        part.readPixels(data_.min.y, data_.max.y);
    }

    Image readChannels(Imf::InputPart& part) const {
        Image image(widthOf(data_), heightOf(data_), static_cast<int>(layer_.channels.size()));
        const std::size_t pixelBytes = layer_.channels.size() * sizeof(float);
        Imf::FrameBuffer pixels;
        for (std::size_t i = 0; i < layer_.channels.size(); ++i)
            pixels.insert(layer_.channels[i],
                          Imf::Slice::Make(Imf::FLOAT, image.values.data() + i, data_, pixelBytes,
                                           pixelBytes * static_cast<std::size_t>(image.width)));
        readInto(part, pixels);
        return image;
    }

    Image readChroma(Imf::InputPart& part) const {
        const Imf::Channel& chroma = channel(layer_.channels[1]);
        ChromaPicture picture{widthOf(data_), heightOf(data_), chroma.xSampling, chroma.ySampling, {}};
        picture.pixels.assign(static_cast<std::size_t>(picture.width) *
                                  static_cast<std::size_t>(picture.height),
                              Imf::Rgba(0, 0, 0, 1));
        Imf::FrameBuffer pixels;
        Imf::Rgba& first = picture.pixels.front();
        const std::array<half*, 4> places{&first.g, &first.r, &first.b, &first.a};
        for (std::size_t i = 0; i < layer_.channels.size(); ++i) {
            const Imf::Channel& read = channel(layer_.channels[i]);
            const auto stepX = static_cast<std::size_t>(read.xSampling);
            const auto stepY = static_cast<std::size_t>(read.ySampling);
            pixels.insert(
                layer_.channels[i],
                Imf::Slice::Make(Imf::HALF, places[i], data_, sizeof(Imf::Rgba) * stepX,
                                 sizeof(Imf::Rgba) * stepY * static_cast<std::size_t>(picture.width),
                                 read.xSampling, read.ySampling));
        }
        readInto(part, pixels);
        chromaToRgb(picture, chromaticities());
        Image image(picture.width, picture.height, static_cast<int>(layer_.channels.size()));
        const auto channels = layer_.channels.size();
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
            const Imf::Rgba& pixel = picture.pixels[i];
            const std::array<half, 4> values{pixel.r, pixel.g, pixel.b, pixel.a};
            for (std::size_t c = 0; c < channels; ++c) image.values[i * channels + c] = values[c];
        }
        return image;
    }

    [[nodiscard]] Imf::Chromaticities chromaticities() const {
        return Imf::hasChromaticities(header_) ? Imf::chromaticities(header_) : Imf::Chromaticities();
    }

    void convertColours(Image& image) const {
        if (!Imf::hasChromaticities(header_)) return;
        const Imf::Chromaticities& stated = Imf::chromaticities(header_);
        const auto point = [](const Imath::V2f& xy) {
            return glm::dvec2(static_cast<double>(xy.x), static_cast<double>(xy.y));
        };
        const Primaries primaries{point(stated.red), point(stated.green), point(stated.blue),
                                  point(stated.white)};
        if (alike(primaries, rec709)) return;
        const auto matrix = toRec709(primaries);
        if (!matrix) {
            logWarning("{}: its chromaticities span no colours and are not used: {}", name_,
                       describe(primaries));
            return;
        }
        transformColours(image, *matrix);
        logWarning("{}: converted to the primaries of Rec. 709 from {}", name_, describe(primaries));
    }

    ExrInput stream_;
    const Imf::Header& header_;
    const ExrLayer& layer_;
    const std::string& name_;
    Imath::Box2i data_;
};

std::vector<std::string_view> channelNames(int channels) {
    static constexpr std::array<std::string_view, 4> names{"R", "G", "B", "A"};
    if (channels == 1) return {"Y"};
    return {names.begin(), names.begin() + channels};
}

} // namespace

Image decodeExr(std::span<const std::byte> bytes, const std::string& name, const std::string& layer) {
    const std::vector<Imf::Header> headers = readExrHeaders(bytes, name);
    const std::vector<ExrPart> parts = partsOf(headers);
    const ExrLayer chosen = chooseLayer(parts, layer, name);
    Image image = ExrReader(bytes, headers[chosen.part], chosen, name).read();
    if (layer.empty()) tellChoice(parts, chosen, name);
    return image;
}

std::vector<std::byte> encodeExr(const Image& image) {
    const std::vector<std::string_view> names = channelNames(image.channels);
    const std::size_t pixelBytes = names.size() * sizeof(float);
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer pixels;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string channel(names[i]);
        header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
        pixels.insert(channel,
                      Imf::Slice::Make(Imf::FLOAT, image.values.data() + i, header.dataWindow(), pixelBytes,
                                       pixelBytes * static_cast<std::size_t>(image.width)));
    }
    ExrOutput stream;
    {
        Imf::OutputFile file(stream, header, 0);
        file.setFrameBuffer(pixels);
        file.writePixels(image.height);
    }
    return stream.take();
}

} // namespace kestrel::detail
