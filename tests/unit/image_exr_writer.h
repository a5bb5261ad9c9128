// EXR files of every kind, in memory, by OpenEXR's own writer.
#pragma once
#include "image/exr_stream.h"
#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

namespace kestrel::test_files {

// The value of a channel at a pixel of the data window, absolute coordinates.
using ExrValue = std::function<float(int x, int y)>;

struct ExrPlane {
    std::string name = {};
    Imf::PixelType type = Imf::FLOAT;
    ExrValue value = {};
    int sampling = 1;
};

struct ExrPicture {
    std::string name = {}; // of the part; needed where there are several
    Imath::Box2i data = {};
    std::optional<Imath::Box2i> display = {}; // without: the data window
    Imf::Compression compression = Imf::NO_COMPRESSION;
    std::optional<Imf::TileDescription> tiles = {};
    std::optional<Imf::Chromaticities> chromaticities = {};
    Imf::LineOrder order = Imf::INCREASING_Y;
    std::vector<ExrPlane> planes = {};
    bool deep = false;
    std::vector<std::string> views = {}; // the first is that of channels without a layer's name
};

inline Imath::Box2i window(int x, int y, int width, int height) {
    return {{x, y}, {x + width - 1, y + height - 1}};
}

// R, G, B of `prefix` with values that tell the place and the channel; `base` tells one layer from another.
inline std::vector<ExrPlane> colourPlanes(const std::string& prefix, float base = 0,
                                          Imf::PixelType type = Imf::FLOAT) {
    std::vector<ExrPlane> planes;
    for (int i = 0; i < 3; ++i)
        planes.push_back({prefix + std::string(1, "RGB"[i]), type, [i, base](int x, int y) {
                              return base + static_cast<float>(i) * 0.25F + static_cast<float>(x) / 64 +
                                     static_cast<float>(y) / 32;
                          }});
    return planes;
}

// The pixels of one level: the full level has the picture's values, all others 1000.
class ExrPixels {
public:
    ExrPixels(const ExrPicture& picture, const Imath::Box2i& level, bool full) {
        for (const ExrPlane& plane : picture.planes) {
            const int width = (level.max.x - level.min.x) / plane.sampling + 1;
            const int height = (level.max.y - level.min.y) / plane.sampling + 1;
            std::vector<std::uint32_t>& words = words_.emplace_back();
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const float value =
                        full ? plane.value(level.min.x + x * plane.sampling, level.min.y + y * plane.sampling)
                             : 1000.0F;
                    std::uint32_t word = static_cast<std::uint32_t>(value);
                    if (plane.type == Imf::FLOAT) word = std::bit_cast<std::uint32_t>(value);
                    if (plane.type == Imf::HALF) word = half(value).bits();
                    words.push_back(word);
                }
            buffer.insert(plane.name, Imf::Slice::Make(plane.type, words.data(), level, 4,
                                                       4 * static_cast<std::size_t>(width), plane.sampling,
                                                       plane.sampling));
        }
    }
    Imf::FrameBuffer buffer;

private:
    std::list<std::vector<std::uint32_t>> words_;
};

inline Imf::Header exrHeader(const ExrPicture& picture) {
    Imf::Header header(picture.display.value_or(picture.data), picture.data);
    header.compression() = picture.compression;
    header.lineOrder() = picture.order;
    for (const ExrPlane& plane : picture.planes)
        header.channels().insert(plane.name, Imf::Channel(plane.type, plane.sampling, plane.sampling));
    if (!picture.name.empty()) header.setName(picture.name);
    if (picture.chromaticities) Imf::addChromaticities(header, *picture.chromaticities);
    if (!picture.views.empty()) Imf::addMultiView(header, picture.views);
    if (picture.tiles) header.setTileDescription(*picture.tiles);
    header.setType(picture.deep ? Imf::DEEPSCANLINE : picture.tiles ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
    return header;
}

inline void writeDeep(Imf::MultiPartOutputFile& file, int part, const ExrPicture& picture) {
    const int width = picture.data.max.x - picture.data.min.x + 1;
    const int height = picture.data.max.y - picture.data.min.y + 1;
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<unsigned> counts(pixels, 1);
    std::vector<float> values(pixels, 0.5F);
    std::vector<float*> pointers;
    for (float& value : values) pointers.push_back(&value);
    Imf::DeepFrameBuffer buffer;
    const auto at = [&](auto* data, std::size_t size) {
        return reinterpret_cast<char*>(data) -
               static_cast<std::ptrdiff_t>(size) * (picture.data.min.x + picture.data.min.y * width);
    };
    buffer.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, at(counts.data(), 4), 4, 4 * static_cast<std::size_t>(width)));
    for (const ExrPlane& plane : picture.planes)
        buffer.insert(plane.name, Imf::DeepSlice(Imf::FLOAT, at(pointers.data(), 8), 8,
                                                 8 * static_cast<std::size_t>(width), 4));
    Imf::DeepScanLineOutputPart out(file, part);
    out.setFrameBuffer(buffer);
    out.writePixels(height);
}

inline void writeTiles(Imf::MultiPartOutputFile& file, int part, const ExrPicture& picture) {
    Imf::TiledOutputPart out(file, part);
    for (int ly = 0; ly < out.numYLevels(); ++ly)
        for (int lx = 0; lx < out.numXLevels(); ++lx) {
            if (!out.isValidLevel(lx, ly)) continue;
            const ExrPixels pixels(picture, out.dataWindowForLevel(lx, ly), lx == 0 && ly == 0);
            out.setFrameBuffer(pixels.buffer);
            out.writeTiles(0, out.numXTiles(lx) - 1, 0, out.numYTiles(ly) - 1, lx, ly);
        }
}

// One part, or several.
inline std::vector<std::byte> exrFile(const std::vector<ExrPicture>& pictures) {
    detail::ExrOutput stream;
    {
        std::vector<Imf::Header> headers;
        for (const ExrPicture& picture : pictures) headers.push_back(exrHeader(picture));
        Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()), false, 0);
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            const int part = static_cast<int>(i);
            if (pictures[i].deep) {
                writeDeep(file, part, pictures[i]);
            } else if (pictures[i].tiles) {
                writeTiles(file, part, pictures[i]);
            } else {
                const ExrPixels pixels(pictures[i], pictures[i].data, true);
                Imf::OutputPart out(file, part);
                out.setFrameBuffer(pixels.buffer);
                out.writePixels(pictures[i].data.max.y - pictures[i].data.min.y + 1);
            }
        }
    }
    return stream.take();
}

inline std::vector<std::byte> exrFile(const ExrPicture& picture) {
    return exrFile(std::vector<ExrPicture>{picture});
}

} // namespace kestrel::test_files
