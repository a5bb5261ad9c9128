// Small pictures of every kind that is read, for tests that damage them and as seeds of the fuzz targets.
#pragma once
#include "support/pattern.h"
#include "unit/image_exr_writer.h"
#include "unit/image_file_builders.h"

namespace kestrel::test_files {

struct Sample {
    const char* kind;
    Bytes bytes;
};

// EXRs of every compression, in lines and tiles, one part and two, with chroma.
inline void addExrSamples(std::vector<Sample>& samples) {
    const auto data = window(0, 0, 8, 6);
    for (int compression = Imf::NO_COMPRESSION; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
        ExrPicture picture{.data = data,
                           .compression = static_cast<Imf::Compression>(compression),
                           .planes = colourPlanes("", 0, Imf::HALF)};
        samples.push_back({"EXR lines", exrFile(picture)});
        if (compression > Imf::ZIP_COMPRESSION) continue;
        picture.tiles = Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS);
        samples.push_back({"EXR tiles", exrFile(picture)});
    }
    ExrPicture flat{.name = "flat", .data = data, .planes = colourPlanes("")};
    ExrPicture deep{.name = "deep",
                    .data = window(0, 0, 2, 2),
                    .display = data,
                    .planes = {{"Z", Imf::FLOAT, [](int, int) { return 1.0F; }}},
                    .deep = true};
    samples.push_back({"EXR parts", exrFile({deep, flat})});
    ExrPicture chroma{.data = data, .planes = {{"Y", Imf::HALF, [](int, int) { return 1.0F; }}}};
    for (const char* name : {"RY", "BY"})
        chroma.planes.push_back({name, Imf::HALF, [](int, int) { return 0.1F; }, 2});
    samples.push_back({"EXR chroma", exrFile(chroma)});
}

// Small files of every kind that is read.
inline std::vector<Sample> samples() {
    std::vector<Sample> result;
    for (const int channels : {1, 3, 4})
        for (const ImageFormat format : {ImageFormat::Png, ImageFormat::Hdr, ImageFormat::Exr})
            for (const int width : {2, 9})
                result.push_back(
                    {"written", encodeImage(test::pattern(width, 3, channels), format, Encoding::Linear)});
    // Smooth, so that compression and runs come into play.
    for (const ImageFormat format : {ImageFormat::Png, ImageFormat::Hdr, ImageFormat::Exr})
        result.push_back({"smooth", encodeImage(Image(32, 20, 3, 0.5F), format, Encoding::Linear)});
    result.push_back({"PNG", png(2, 1, 16, 0, {0, 0x01, 0x02, 0xff, 0xff})});
    result.push_back({"PNG", png(2, 1, 8, 3, {0, 1, 0}, {0, 0, 255, 255, 0, 0})});
    ExrBuilder half;
    half.height = 2;
    half.half("B", {1, 2, 3, 4}).half("G", {1, 2, 3, 4}).floats("R", {1, 2, 3, 4});
    result.push_back({"EXR half", half.bytes()});
    ExrBuilder runs; // two runs of 8 bytes, equal before and after the predictor
    runs.half("Y", std::vector<std::uint16_t>(8, 0x8080));
    runs.compression = 1;
    runs.chunk = {7, 0x80, 7, 0x80};
    result.push_back({"EXR runs", runs.bytes()});
    result.push_back({"EXR PIZ", pizSample().bytes()});
    addExrSamples(result);
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\nEXPOSURE=2\nCOLORCORR=1 2 1\n"
                               "PRIMARIES=.64 .33 .29 .6 .15 .06 .333 .333\n\n+X 3 -Y 2\n";
    result.push_back({"HDR old runs", bytesOf(header + std::string("\x80\x40\x20\x81\1\1\1\1"
                                                                   "\x80\x40\x20\x81\1\1\1\1"
                                                                   "\x80\x40\x20\x81\1\1\1\1",
                                                                   24))});
    return result;
}

} // namespace kestrel::test_files
