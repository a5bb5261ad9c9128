#include "core/error.h"
#include "image/io.h"
#include "support/message.h"
#include "support/pattern.h"
#include "unit/image_exr_writer.h"
#include "unit/image_file_builders.h"
#include <OpenEXR/ImfRgbaFile.h>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace kestrel {
namespace {

using test::messageOf;
using test::pattern;
using test_files::Bytes;
using test_files::colourPlanes;
using test_files::decodeMessage;
using test_files::ExrBuilder;
using test_files::exrFile;
using test_files::ExrPicture;
using test_files::ExrPlane;
using test_files::infinity;
using test_files::nan;
using test_files::warningsOf;
using test_files::window;
using testing::HasSubstr;
using Values = std::vector<float>;

std::vector<std::uint32_t> bitsOf(const Image& image) {
    std::vector<std::uint32_t> bits;
    for (const float value : image.values) bits.push_back(std::bit_cast<std::uint32_t>(value));
    return bits;
}

// The picture that `colourPlanes` describes.
Image colours(const Imath::Box2i& data, float base = 0) {
    Image image(data.max.x - data.min.x + 1, data.max.y - data.min.y + 1, 3);
    const auto planes = colourPlanes("", base);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int channel = 0; channel < 3; ++channel)
                image.at(x, y, channel) =
                    planes[static_cast<std::size_t>(channel)].value(data.min.x + x, data.min.y + y);
    return image;
}

void expectNear(const Image& image, const Image& expected, float tolerance) {
    ASSERT_TRUE(image.sameSize(expected));
    ASSERT_EQ(image.channels, expected.channels);
    for (std::size_t i = 0; i < image.values.size(); ++i)
        ASSERT_NEAR(image.values[i], expected.values[i], tolerance) << "value " << i;
}

TEST(Exr, RoundTripIsExactToTheBit) {
    for (int channels = 1; channels <= 4; ++channels)
        for (const auto& [width, height] : {std::pair{1, 1}, {3, 40}, {65, 33}}) {
            Image image = pattern(width, height, channels);
            image.values[0] = nan;
            if (image.values.size() > 5) {
                image.values[1] = infinity;
                image.values[2] = -infinity;
                image.values[3] = -0.0F;
                image.values[4] = std::numeric_limits<float>::denorm_min();
            }
            const Image read = decodeImage(encodeImage(image, ImageFormat::Exr, Encoding::Srgb), "file");
            EXPECT_EQ(read.channels, channels);
            EXPECT_TRUE(read.sameSize(image));
            EXPECT_EQ(bitsOf(read), bitsOf(image));
        }
}

TEST(Exr, IsWrittenTheSameWayEveryTime) {
    const Image image = pattern(40, 30, 4);
    EXPECT_EQ(encodeImage(image, ImageFormat::Exr, Encoding::Linear),
              encodeImage(image, ImageFormat::Exr, Encoding::Linear));
}

// Every compression, in lines and in tiles, of every type of values. The lossy ones are near: PXR24 rounds to
// 24 bits, B44 and DWA are for pictures that are looked at.
TEST(Exr, ReadsEveryCompressionInLinesAndTiles) {
    struct Case {
        Imf::Compression compression;
        float tolerance;
    };
    const auto data = window(-3, 5, 50, 37);
    for (const Case& one : {Case{Imf::NO_COMPRESSION, 0},
                            {Imf::RLE_COMPRESSION, 0},
                            {Imf::ZIPS_COMPRESSION, 0},
                            {Imf::ZIP_COMPRESSION, 0},
                            {Imf::PIZ_COMPRESSION, 0},
                            {Imf::PXR24_COMPRESSION, 1e-4F},
                            {Imf::B44_COMPRESSION, 0.02F},
                            {Imf::B44A_COMPRESSION, 0.02F},
                            {Imf::DWAA_COMPRESSION, 0.03F},
                            {Imf::DWAB_COMPRESSION, 0.03F}})
        for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT})
            for (const bool tiled : {false, true}) {
                SCOPED_TRACE(testing::Message() << "compression " << one.compression << ", type " << type
                                                << (tiled ? ", tiles" : ", lines"));
                ExrPicture picture{
                    .data = data, .compression = one.compression, .planes = colourPlanes("", 0, type)};
                if (tiled) picture.tiles = Imf::TileDescription(16, 8);
                // The pattern's values have few bits: a half holds them.
                expectNear(decodeImage(exrFile(picture), "file"), colours(data), one.tolerance);
            }
}

TEST(Exr, ReadsTheFullLevelOfTiles) {
    const auto data = window(4, -2, 33, 20);
    for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS})
        for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y, Imf::RANDOM_Y}) {
            ExrPicture picture{.data = data,
                               .compression = Imf::ZIP_COMPRESSION,
                               .tiles = Imf::TileDescription(8, 8, mode),
                               .order = order,
                               .planes = colourPlanes("")};
            EXPECT_EQ(decodeImage(exrFile(picture), "file"), colours(data)) << mode << ' ' << order;
        }
}

TEST(Exr, ReadsHalfAndPicksChannelsByName) {
    const auto values = [](const ExrBuilder& exr) { return decodeImage(exr.bytes(), "file").values; };
    // Halves: 0x3c00 is 1, 0x3800 is 0.5, 0x7c00 is infinity, 0x0001 is 2^-24.
    ExrBuilder half;
    half.half("Y", {0x3c00, 0x3800, 0x7c00, 0x0001});
    EXPECT_EQ(values(half), (Values{1, 0.5F, infinity, std::ldexp(1.0F, -24)}));

    ExrBuilder color; // the alphabet's order in the file
    color.floats("A", {4, 8}).floats("B", {3, 7}).floats("G", {2, 6}).half("R", {0x3c00, 0x3800});
    EXPECT_EQ(values(color), (Values{1, 2, 3, 4, 0.5F, 6, 7, 8}));

    ExrBuilder normal;
    normal.floats("X", {1, 4}).floats("Y", {2, 5}).floats("Z", {3, 6});
    EXPECT_EQ(values(normal), (Values{1, 2, 3, 4, 5, 6}));

    ExrBuilder depth;
    depth.floats("anything", {9, 8, 7});
    EXPECT_EQ(values(depth), (Values{9, 8, 7}));

    ExrBuilder lower;
    lower.floats("b", {3}).floats("g", {2}).floats("r", {1});
    EXPECT_EQ(values(lower), (Values{1, 2, 3}));

    ExrBuilder integers;
    integers.uints("id", {1, 16777215});
    EXPECT_EQ(values(integers), (Values{1, 16777215}));

    ExrBuilder more; // depth and identifiers beside the colours
    more.floats("B", {3}).floats("G", {2}).floats("R", {1}).floats("Z", {100}).uints("id", {5});
    EXPECT_THAT(warningsOf(more.bytes()), HasSubstr("file: left out: the channels Z, id\n"));
    EXPECT_EQ(values(more), (Values{1, 2, 3}));
    EXPECT_EQ(decodeImage(more.bytes(), "file", "Z").values, Values{100});
    EXPECT_EQ(warningsOf(more.bytes(), "Z"), "");

    ExrBuilder unknown;
    unknown.floats("u", {1}).floats("v", {2});
    EXPECT_EQ(decodeMessage(unknown.bytes()),
              "file: has the channels 'u', 'v': neither RGB nor XYZ nor a single one");
}

TEST(Exr, TakesTheOnlyLayerWithColoursAndSaysSo) {
    const auto data = window(0, 0, 7, 5);
    for (const char* layer : {"RGBA", "ViewLayer.Combined"}) {
        ExrPicture picture{.data = data, .planes = colourPlanes(std::string(layer) + ".")};
        picture.planes.push_back({"ViewLayer.Depth.Z", Imf::FLOAT, [](int, int) { return 7.0F; }});
        const Bytes bytes = exrFile(picture);
        EXPECT_EQ(decodeImage(bytes, "file"), colours(data));
        EXPECT_THAT(warningsOf(bytes), HasSubstr(std::string("file: took the layer '") + layer +
                                                 "'; left out: the channels ViewLayer.Depth.Z\n"));
        EXPECT_EQ(decodeImage(bytes, "file", layer), colours(data));
        EXPECT_EQ(decodeImage(bytes, "file", "ViewLayer.Depth"), Image(7, 5, 1, 7));
        EXPECT_EQ(decodeImage(bytes, "file", "ViewLayer.Depth.Z"), Image(7, 5, 1, 7));
    }
}

TEST(Exr, AsksWhichOfSeveralLayers) {
    const auto data = window(0, 0, 3, 2);
    ExrPicture picture{.data = data, .planes = colourPlanes("diffuse.")};
    for (const ExrPlane& plane : colourPlanes("glossy.", 4)) picture.planes.push_back(plane);
    const Bytes bytes = exrFile(picture);
    EXPECT_EQ(decodeMessage(bytes),
              "file: has several layers: 'diffuse', 'glossy'; name one as in 'file:diffuse'");
    EXPECT_EQ(decodeImage(bytes, "file", "glossy"), colours(data, 4));
    EXPECT_EQ(messageOf([&] { decodeImage(bytes, "file", "glosy"); }),
              "file: has no layer 'glosy' (did you mean 'glossy'?); it has 'diffuse', 'glossy'");
    // Colours without a layer's name come before those of a layer.
    for (const ExrPlane& plane : colourPlanes("", 8)) picture.planes.push_back(plane);
    EXPECT_EQ(decodeImage(exrFile(picture), "file"), colours(data, 8));
}

TEST(Exr, ReadsOnePartOfSeveral) {
    const auto data = window(0, 0, 5, 4);
    ExrPicture beauty{
        .name = "beauty", .data = data, .compression = Imf::ZIP_COMPRESSION, .planes = colourPlanes("")};
    ExrPicture depth{.name = "depth",
                     .data = window(1, 1, 3, 2),
                     .display = data,
                     .tiles = Imf::TileDescription(4, 4),
                     .planes = {{"Z", Imf::FLOAT, [](int, int) { return 9.0F; }}}};
    const Bytes both = exrFile({depth, beauty});
    EXPECT_EQ(decodeImage(both, "file"), colours(data));
    EXPECT_THAT(warningsOf(both),
                HasSubstr("file: took the layer 'beauty'; left out: the channels depth.Z\n"));
    EXPECT_EQ(decodeImage(both, "file", "beauty"), colours(data));
    Image far(5, 4, 1);
    for (const auto& [x, y] : {std::pair{1, 1}, {2, 1}, {3, 1}, {1, 2}, {2, 2}, {3, 2}}) far.at(x, y) = 9;
    EXPECT_EQ(decodeImage(both, "file", "depth"), far);

    ExrPicture albedo = beauty;
    albedo.name = "albedo";
    albedo.planes = colourPlanes("", 4);
    const Bytes three = exrFile({depth, beauty, albedo});
    EXPECT_EQ(decodeMessage(three),
              "file: has several layers: 'beauty', 'albedo'; name one as in 'file:beauty'");
    EXPECT_EQ(decodeImage(three, "file", "albedo"), colours(data, 4));

    // Layers of one name in two parts, as of two eyes.
    ExrPicture left = beauty, right = beauty;
    left.name = "left";
    left.planes = colourPlanes("diffuse.", 1);
    right.name = "right";
    right.planes = colourPlanes("diffuse.", 2);
    const Bytes eyes = exrFile({left, right});
    EXPECT_EQ(decodeImage(eyes, "file", "right"), colours(data, 2));
    EXPECT_EQ(decodeImage(eyes, "file", "left.diffuse"), colours(data, 1));
    EXPECT_EQ(messageOf([&] { decodeImage(eyes, "file", "diffuse"); }),
              "file: has several layers called 'diffuse': 'left.diffuse', 'right.diffuse'; name one as in "
              "'file:left.diffuse'");
}

TEST(Exr, ReadsTheViewsOfOnePart) {
    ExrPicture picture{.data = window(0, 0, 3, 2), .planes = colourPlanes(""), .views = {"left", "right"}};
    for (const ExrPlane& plane : colourPlanes("right.", 4)) picture.planes.push_back(plane);
    const Bytes bytes = exrFile(picture);
    EXPECT_EQ(decodeImage(bytes, "file"), colours(picture.data));
    EXPECT_THAT(warningsOf(bytes), HasSubstr("file: took the layer 'left'; left out: the channels right.B"));
    EXPECT_EQ(decodeImage(bytes, "file", "left"), colours(picture.data));
    EXPECT_EQ(decodeImage(bytes, "file", "right"), colours(picture.data, 4));
}

TEST(Exr, RefusesDeepDataByName) {
    const auto data = window(0, 0, 4, 3);
    ExrPicture deep{.name = "volume",
                    .data = data,
                    .planes = {{"Z", Imf::FLOAT, [](int, int) { return 1.0F; }}},
                    .deep = true};
    EXPECT_EQ(decodeMessage(exrFile(deep)), "file: is an EXR of deep data alone, which is not read");
    ExrPicture flat{.name = "flat", .data = data, .planes = colourPlanes("")};
    const Bytes both = exrFile({deep, flat});
    EXPECT_EQ(decodeImage(both, "file"), colours(data));
    EXPECT_EQ(messageOf([&] { decodeImage(both, "file", "volume"); }),
              "file: holds deep data in the part 'volume', which is not read");
}

TEST(Exr, IsTheDisplayWindow) {
    ExrPicture picture{.data = window(10, 20, 4, 3), .planes = colourPlanes("")};
    picture.planes.push_back({"A", Imf::FLOAT, [](int, int) { return 1.0F; }});
    Image whole = convertChannels(colours(picture.data), 4);
    EXPECT_EQ(decodeImage(exrFile(picture), "file"), whole);
    // A crop: black and transparent outside of the data.
    picture.display = window(9, 18, 6, 6);
    Image inside(6, 6, 4);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x)
            for (int channel = 0; channel < 4; ++channel)
                inside.at(x + 1, y + 2, channel) = whole.at(x, y, channel);
    for (const bool tiled : {false, true}) {
        if (tiled) picture.tiles = Imf::TileDescription(2, 2);
        EXPECT_EQ(decodeImage(exrFile(picture), "file"), inside);
    }
    // Overscan, cut off; and both, one to a side.
    picture.display = window(11, 21, 2, 1);
    EXPECT_EQ(decodeImage(exrFile(picture), "file"), crop(whole, 1, 1, 2, 1));
    picture.display = window(12, 20, 4, 3);
    const Image shifted = decodeImage(exrFile(picture), "file");
    EXPECT_EQ(crop(shifted, 0, 0, 2, 3), crop(whole, 2, 0, 2, 3));
    EXPECT_EQ(crop(shifted, 2, 0, 2, 3), Image(2, 3, 4));
    picture.display = window(100, 100, 2, 2);
    EXPECT_THAT(warningsOf(exrFile(picture)),
                HasSubstr("file: is black: its pixels lie outside of its display window\n"));
    EXPECT_EQ(decodeImage(exrFile(picture), "file"), Image(2, 2, 4));
}

TEST(Exr, OrderOfLinesDoesNotTurnThePicture) {
    ExrBuilder exr;
    exr.height = 3;
    exr.minX = -5;
    exr.minY = 40;
    exr.floats("Y", {1, 2, 3, 4, 5, 6});
    for (const int order : {0, 1}) {
        exr.lineOrder = order;
        const Image image = decodeImage(exr.bytes(), "file");
        EXPECT_EQ(image.width, 2);
        EXPECT_EQ(image.height, 3);
        EXPECT_EQ(image.values, (Values{1, 2, 3, 4, 5, 6}));
    }
}

TEST(Exr, ConvertsOtherPrimaries) {
    // Rec. 2020 and its green, which lies outside of Rec. 709: by the matrix of ITU-R BT.2407, annex 1.
    ExrPicture picture{.data = window(0, 0, 1, 1), .planes = {}};
    picture.chromaticities =
        Imf::Chromaticities({0.708F, 0.292F}, {0.170F, 0.797F}, {0.131F, 0.046F}, {0.3127F, 0.3290F});
    for (const auto& [name, value] : {std::pair{"R", 0.5F}, {"G", 1.0F}, {"B", 0.25F}})
        picture.planes.push_back({name, Imf::FLOAT, [v = value](int, int) { return v; }});
    const Bytes wide = exrFile(picture);
    expectNear(
        decodeImage(wide, "file"),
        [] {
            Image image(1, 1, 3);
            image.values = {0.5F * 1.6605F - 0.5876F - 0.25F * 0.0728F,
                            -0.5F * 0.1246F + 1.1329F - 0.25F * 0.0083F,
                            -0.5F * 0.0182F - 0.1006F + 0.25F * 1.1187F};
            return image;
        }(),
        2e-4F);
    EXPECT_THAT(warningsOf(wide), HasSubstr("file: converted to the primaries of Rec. 709 from red (0.708, "
                                            "0.292), green (0.17, 0.797)"));
    // Rec. 709 stated is Rec. 709.
    picture.chromaticities = Imf::Chromaticities();
    EXPECT_EQ(warningsOf(exrFile(picture)), "");
    EXPECT_EQ(decodeImage(exrFile(picture), "file").values, (Values{0.5F, 1, 0.25F}));
    // White of another white point is white.
    picture.chromaticities =
        Imf::Chromaticities({0.7347F, 0.2653F}, {0, 1}, {0.0001F, -0.077F}, {0.32168F, 0.33767F});
    for (ExrPlane& plane : picture.planes) plane.value = [](int, int) { return 1.0F; };
    expectNear(decodeImage(exrFile(picture), "file"), Image(1, 1, 3, 1), 1e-5F);
    // X, Y, Z in place of R, G, B: those of Rec. 709's white.
    picture.chromaticities = Imf::Chromaticities({1, 0}, {0, 1}, {0, 0}, {1.0F / 3, 1.0F / 3});
    for (const auto& [i, value] : {std::pair{0U, 0.95046F}, {1U, 1.0F}, {2U, 1.08906F}})
        picture.planes[i].value = [v = value](int, int) { return v; };
    expectNear(decodeImage(exrFile(picture), "file"), Image(1, 1, 3, 1), 1e-4F);
    // Nothing can be made of these: the values stay, and it is said.
    picture.chromaticities = Imf::Chromaticities({0.3F, 0.3F}, {0.3F, 0.3F}, {0.3F, 0.3F}, {0.3F, 0.3F});
    EXPECT_THAT(warningsOf(exrFile(picture)), HasSubstr("file: its chromaticities span no colours"));
    // A position is no colour.
    ExrPicture position{.data = window(0, 0, 1, 1), .planes = {}};
    position.chromaticities = Imf::Chromaticities({1, 0}, {0, 1}, {0, 0}, {1.0F / 3, 1.0F / 3});
    for (const char* name : {"X", "Y", "Z"})
        position.planes.push_back({name, Imf::FLOAT, [](int, int) { return 2.0F; }});
    EXPECT_EQ(decodeImage(exrFile(position), "file").values, (Values{2, 2, 2}));
}

// The picture of a smooth sky, written by OpenEXR as luminance and chroma.
Bytes chromaFile(int width, int height, Imf::RgbaChannels channels, std::vector<Imf::Rgba>& pixels,
                 const Imath::V2i& corner = {0, 0}) {
    pixels.clear();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float u = static_cast<float>(x) / 40;
            const float v = static_cast<float>(y) / 30;
            pixels.emplace_back(0.5F + 0.3F * u, 0.4F + 0.2F * v, 0.6F - 0.2F * u * v, 0.25F + 0.5F * u);
        }
    detail::ExrOutput stream;
    const auto data = window(corner.x, corner.y, width, height);
    {
        Imf::RgbaOutputFile file(stream, Imf::Header(data, data), channels, 0);
        file.setYCRounding(11, 11);
        file.setFrameBuffer(pixels.data() - corner.x - corner.y * width, 1, static_cast<std::size_t>(width));
        file.writePixels(height);
    }
    return stream.take();
}

TEST(Exr, ConvertsLuminanceAndChroma) {
    for (const auto& [width, height] : {std::pair{40, 30}, {34, 28}, {2, 2}, {2, 6}}) {
        SCOPED_TRACE(testing::Message() << width << "x" << height);
        std::vector<Imf::Rgba> pixels;
        const Bytes bytes = chromaFile(width, height, Imf::WRITE_YCA, pixels, {-4, 6});
        const Image image = decodeImage(bytes, "file");
        ASSERT_EQ(image.channels, 4);
        ASSERT_EQ(image.sizeText(), fmt::format("{}x{}", width, height));
        // Near what was written, and what OpenEXR's own reader makes of it.
        std::vector<Imf::Rgba> own(pixels.size());
        detail::ExrInput stream(bytes);
        Imf::RgbaInputFile file(stream, 0);
        file.setFrameBuffer(own.data() + 4 - 6 * width, 1, static_cast<std::size_t>(width));
        file.readPixels(6, 6 + height - 1);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const std::array<std::pair<half, half>, 4> pairs{{{pixels[i].r, own[i].r},
                                                              {pixels[i].g, own[i].g},
                                                              {pixels[i].b, own[i].b},
                                                              {pixels[i].a, own[i].a}}};
            for (std::size_t channel = 0; channel < 4; ++channel) {
                const float value = image.values[i * 4 + channel];
                EXPECT_NEAR(value, pairs[channel].first, 0.02F) << i;
                EXPECT_NEAR(value, pairs[channel].second, 0.002F) << i;
            }
        }
    }
    std::vector<Imf::Rgba> pixels;
    EXPECT_EQ(decodeImage(chromaFile(40, 30, Imf::WRITE_YC, pixels), "file").channels, 3);
    EXPECT_EQ(decodeImage(chromaFile(40, 30, Imf::WRITE_Y, pixels), "file").channels, 1);
}

TEST(Exr, ConvertsChromaOfALayerAtEveryPixel) {
    // Y, RY = (R - Y) / Y, BY = (B - Y) / Y of the colour (0.5, 1, 0.25).
    const float y = luminance(0.5F, 1, 0.25F);
    ExrPicture picture{.name = "a", .data = window(0, 0, 3, 2), .planes = {}};
    for (const auto& [name, value] :
         {std::pair{"sky.Y", y}, {"sky.RY", (0.5F - y) / y}, {"sky.BY", (0.25F - y) / y}})
        picture.planes.push_back({name, Imf::FLOAT, [v = value](int, int) { return v; }});
    ExrPicture other{.name = "b",
                     .data = window(0, 0, 3, 2),
                     .planes = {{"Z", Imf::FLOAT, [](int, int) { return 1.0F; }}}};
    const Image image = decodeImage(exrFile({other, picture}), "file");
    ASSERT_EQ(image.channels, 3);
    for (std::size_t i = 0; i < image.values.size(); ++i)
        EXPECT_NEAR(image.values[i], (Values{0.5F, 1, 0.25F})[i % 3], 0.002F);
}

TEST(Exr, RefusesWhatItCannotReadAndSaysWhat) {
    const auto message = [](auto change) {
        ExrBuilder exr;
        exr.floats("Y", {1, 2});
        change(exr);
        return decodeMessage(exr.bytes());
    };
    EXPECT_EQ(message([](ExrBuilder& e) { e.flags = 0x4000; }),
              "file: is an EXR with the flags 0x4000, which is not read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.flags = 1; }),
              "file: is an EXR with version 3, which is not read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.compression = 77; }),
              "file: is an EXR with an unknown compression, which is not read");
    EXPECT_EQ(
        message([](ExrBuilder& e) { e.sampling = 2; }),
        "file: is an EXR with the channel 'Y' subsampled 2x2 in a data window that this does not divide, "
        "which is not read");
    const auto value = [](int, int) { return 1.0F; };
    EXPECT_EQ(decodeMessage(exrFile({.data = window(0, 0, 2, 2), .planes = {{"Y", Imf::FLOAT, value, 2}}})),
              "file: is an EXR whose channel 'Y' is subsampled 2x2, which is not read");
    EXPECT_EQ(decodeMessage(exrFile({.data = window(0, 0, 4, 4),
                                     .planes = {{"Y", Imf::FLOAT, value},
                                                {"RY", Imf::FLOAT, value, 4},
                                                {"BY", Imf::FLOAT, value, 4}}})),
              "file: is an EXR whose channel 'RY' is subsampled 4x4, which is not read");
    EXPECT_EQ(
        decodeMessage(exrFile(
            {.data = window(0, 0, 4, 4),
             .planes = {{"Y", Imf::FLOAT, value}, {"RY", Imf::FLOAT, value, 2}, {"BY", Imf::FLOAT, value}}})),
        "file: is an EXR whose chroma channels are subsampled differently, which is not read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.claimedWidth = 100000; }),
              "file: has the size 100000x1; at most 16384 pixels a side are read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.minX = 2000000000; }),
              "file: has its edge at 2000000000; edges are read to 268435456 from the origin");
    EXPECT_EQ(message([](ExrBuilder& e) { e.claimedWidth = -1; }), "file: has the size -1x1");
    EXPECT_EQ(decodeMessage(test_files::bytesOf("\x76\x2f\x31\x01")), "file: is a truncated EXR");

    ExrPicture tiles{.data = window(0, 0, 1, 1), .planes = colourPlanes("")};
    tiles.tiles = Imf::TileDescription(20000, 1);
    EXPECT_EQ(decodeMessage(exrFile(tiles)),
              "file: has tiles of 20000x1; at most 16384 pixels a side are read");
    ExrPicture overscan{
        .data = window(0, 0, 20000, 1), .display = window(0, 0, 4, 1), .planes = colourPlanes("")};
    EXPECT_EQ(decodeMessage(exrFile(overscan)),
              "file: has a data window of 20000x1 pixels; at most 16384 pixels a side are read");
    ExrPicture wide{
        .data = window(0, 0, 9, 3), .display = window(0, 0, 20000, 4), .planes = colourPlanes("")};
    EXPECT_EQ(decodeMessage(exrFile(wide)),
              "file: has the size 20000x4; at most 16384 pixels a side are read");
}

TEST(Exr, PromisesMakeNoMemory) {
    // A picture of 16384x16384 in a file of some hundred bytes; an attribute of two billion bytes.
    ExrBuilder exr;
    exr.floats("Y", std::vector<float>(2));
    exr.claimedWidth = 16384;
    exr.claimedHeight = 16384;
    EXPECT_EQ(decodeMessage(exr.bytes()), "file: is a truncated EXR");
    ExrBuilder many;
    for (const char* name : {"R", "G", "B", "A"}) many.floats(name, {1});
    many.claimedWidth = 16384;
    many.claimedHeight = 16384;
    EXPECT_EQ(decodeMessage(many.bytes()),
              "file: has 16384x16384 pixels of 4 channels; at most 268435456 values are read");
    Bytes bytes = exr.bytes();
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t size = text.find("box2i") + 6;
    for (std::size_t i = 0; i < 4; ++i) bytes[size + i] = i < 3 ? std::byte{0xff} : std::byte{0x7f};
    EXPECT_EQ(decodeMessage(bytes), "file: is a truncated EXR");
}

TEST(Exr, ReadsPiz) {
    const Image image = decodeImage(test_files::pizSample().bytes(), "file");
    ASSERT_EQ(image.values.size(), 128U);
    for (std::size_t i = 0; i < 128; ++i)
        EXPECT_EQ(image.values[i], std::ldexp(static_cast<float>(i / 32), -24)) << i;
}

} // namespace
} // namespace kestrel
