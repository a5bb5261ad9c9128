#include "core/error.h"
#include "image/io.h"
#include "support/message.h"
#include "support/pattern.h"
#include "unit/image_file_builders.h"
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace kestrel {
namespace {

using test::pattern;
using test_files::Bytes;
using test_files::decodeMessage;
using test_files::infinity;
using test_files::nan;
using test_files::warningsOf;
using testing::HasSubstr;
using Values = std::vector<float>;

Image roundTrip(const Image& image) {
    return decodeImage(encodeImage(image, ImageFormat::Hdr, Encoding::Linear), "file");
}

Bytes hdr(const std::string& header, const std::string& size, const std::string& pixels) {
    return test_files::bytesOf("#?RADIANCE\n" + header + "\n" + size + "\n" + pixels);
}

const std::string format = "FORMAT=32-bit_rle_rgbe\n";
const std::string pixel("\x80\x40\x00\x81", 4); // 128, 64, 0 times 2^(129-136) = 1, 0.5, 0

// Pixels without run lengths: mantissas `from`, `from` + 1 and so on, in red alone, at the exponent where a
// mantissa is its own value.
std::string countedPixels(int from, int count) {
    std::string bytes;
    for (int i = 0; i < count; ++i) bytes += {static_cast<char>(from + i), 0, 0, static_cast<char>(136)};
    return bytes;
}

Values reds(const Image& image) {
    Values values;
    for (std::size_t i = 0; i < image.pixelCount(); ++i) values.push_back(image.values[i * 3]);
    return values;
}

TEST(Hdr, RoundTripIsWithinItsEightBitMantissa) {
    for (const int width : {1, 7, 8, 200}) { // runs are written from 8 pixels on
        Image image = pattern(width, 5, 3);
        image.values[0] = 1234.5F;
        image.at(width - 1, 4, 1) = 1e-4F;
        const Image read = roundTrip(image);
        ASSERT_EQ(read.channels, 3);
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < width; ++x) {
                const float greatest = std::max({image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)});
                for (int channel = 0; channel < 3; ++channel)
                    EXPECT_NEAR(read.at(x, y, channel), image.at(x, y, channel), greatest / 127);
            }
    }
}

TEST(Hdr, WritesWhatItCannotHoldAsTheNearestValue) {
    Image image(4, 1, 1);
    image.values = {-1, nan, infinity, 1e-40F};
    const Image read = roundTrip(image);
    EXPECT_EQ(read.at(0, 0), 0);
    EXPECT_EQ(read.at(1, 0), 0);
    EXPECT_GT(read.at(2, 0), 1e38F);
    EXPECT_TRUE(std::isfinite(read.at(2, 0)));
    EXPECT_EQ(read.at(3, 0), 0);
}

TEST(Hdr, ReadsRunsAndExposures) {
    EXPECT_EQ(decodeImage(hdr(format, "-Y 1 +X 1", pixel), "file").values, (std::vector<float>{1, 0.5F, 0}));
    EXPECT_EQ(decodeImage(hdr(format + "EXPOSURE= 2\nEXPOSURE=2.0\n", "-Y 1 +X 1", pixel), "f").values,
              (std::vector<float>{0.25F, 0.125F, 0}));
    // Nine pixels: red a run, green copied, blue both, exponent a run.
    const std::string row(
        "\x02\x02\x00\x09\x89\x80\x09\x01\x02\x03\x04\x05\x06\x07\x08\x09\x88\x40\x01\x20\x89\x88", 22);
    const Image runs = decodeImage(hdr(format, "-Y 1 +X 9", row), "file");
    EXPECT_EQ(runs.at(8, 0, 0), 128);
    EXPECT_EQ(runs.at(4, 0, 1), 5);
    EXPECT_EQ(runs.at(7, 0, 2), 64);
    EXPECT_EQ(runs.at(8, 0, 2), 32);
}

TEST(Hdr, ReadsOldRunLengths) {
    const std::string a("\x80\x40\x00\x81", 4), b("\x40\x80\x00\x81", 4);
    const auto mark = [](int count) { return std::string("\1\1\1", 3) + static_cast<char>(count); };
    // Three more of the first, then one of the second.
    const Image image = decodeImage(hdr(format, "-Y 1 +X 5", a + mark(3) + b), "file");
    EXPECT_EQ(reds(image), (Values{1, 1, 1, 1, 0.5F}));
    // Repeats that follow one another count 256 times as much each: 1 + 44 + 256 = 301 pixels; then anew.
    const Image wide = decodeImage(
        hdr(format, "-Y 2 +X 303", a + mark(44) + mark(1) + b + mark(1) + b + mark(46) + mark(1)), "file");
    ASSERT_EQ(wide.sizeText(), "303x2");
    EXPECT_EQ(wide.at(300, 0), 1);
    EXPECT_EQ(wide.at(301, 0), 0.5F);
    EXPECT_EQ(wide.at(302, 0), 0.5F);
    EXPECT_EQ(wide.at(302, 1), 0.5F);

    EXPECT_EQ(decodeMessage(hdr(format, "-Y 1 +X 5", a + mark(5))),
              "file: is a damaged HDR picture: a run beyond its row");
    EXPECT_EQ(decodeMessage(hdr(format, "-Y 1 +X 2", mark(1) + a)),
              "file: is a damaged HDR picture: a repeat without a pixel before it");
    EXPECT_EQ(decodeMessage(hdr(format, "-Y 1 +X 9", a + mark(0) + mark(0) + mark(0) + mark(0))),
              "file: is a damaged HDR picture: a run beyond its row");
    EXPECT_EQ(decodeMessage(hdr(format, "-Y 1 +X 5", a + mark(1))), "file: is a truncated HDR picture");
}

TEST(Hdr, TurnsThePictureAsTheResolutionSays) {
    // Three columns and two rows: 1 2 3 above 4 5 6; the order in the file, for each resolution.
    const Values picture{1, 2, 3, 4, 5, 6};
    struct Case {
        const char* resolution;
        std::vector<int> order;
    };
    for (const Case& one : {Case{"-Y 2 +X 3", {1, 2, 3, 4, 5, 6}},
                            {"-Y 2 -X 3", {3, 2, 1, 6, 5, 4}},
                            {"+Y 2 +X 3", {4, 5, 6, 1, 2, 3}},
                            {"+Y 2 -X 3", {6, 5, 4, 3, 2, 1}},
                            {"+X 3 -Y 2", {1, 4, 2, 5, 3, 6}},
                            {"+X 3 +Y 2", {4, 1, 5, 2, 6, 3}},
                            {"-X 3 -Y 2", {3, 6, 2, 5, 1, 4}},
                            {"-X 3 +Y 2", {6, 3, 5, 2, 4, 1}}}) {
        std::string pixels;
        for (const int value : one.order) pixels += countedPixels(value, 1);
        const Image image = decodeImage(hdr(format, one.resolution, pixels), "file");
        EXPECT_EQ(image.sizeText(), "3x2") << one.resolution;
        EXPECT_EQ(reds(image), picture) << one.resolution;
    }
    // Run lengths go along the file's lines, whatever axis that is: eight times the same, four times.
    const std::string row("\x02\x02\x00\x08\x88\x07\x88\x00\x88\x00\x88\x88", 12);
    const Image columns = decodeImage(hdr(format, "+X 4 -Y 8", row + row + row + row), "file");
    EXPECT_EQ(columns.sizeText(), "4x8");
    EXPECT_EQ(reds(columns), Values(32, 7));
}

TEST(Hdr, ReadsHeadersAsProgramsWriteThem) {
    const Values values{1, 0.5F, 0};
    const auto read = [](const std::string& text) {
        return decodeImage(test_files::bytesOf(text + pixel), "file").values;
    };
    EXPECT_EQ(read("#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n"), values);
    EXPECT_EQ(read("#?RADIANCE\n# Made with a program\nGAMMA=1\nPRIMARIES=0 0 0 0 0 0 0 0\n"
                   "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n"),
              values);
    EXPECT_EQ(read("#?RADIANCE\nrpict -vf a.vf\nVIEW= -vtv\nCAPDATE= 2020:01:01\nPIXASPECT=1\n"
                   "FORMAT= 32-bit_rle_rgbe \n\n-Y 1 +X 1\n"),
              values);
    EXPECT_EQ(read("#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 1\r\n"), values);
    EXPECT_EQ(read("#?RADIANCE\n\n-Y 1 +X 1\n"), values); // no format at all
    // Indented lines tell of the pictures that this one was made from.
    EXPECT_EQ(read("#?RADIANCE\na.hdr:\n\tEXPOSURE=4\n\tFORMAT=ascii\nFORMAT=32-bit_rle_rgbe\n\n"
                   "-Y 1 +X 1\n"),
              values);
}

TEST(Hdr, DividesByExposureAndColourCorrectionAndSaysSo) {
    const Bytes bytes = hdr(format + "EXPOSURE=2\nCOLORCORR= 0.5 1 2\nEXPOSURE=+1.0e+00\nCOLORCORR=2 1 1\n",
                            "-Y 1 +X 1", std::string("\x80\x80\x80\x81", 4));
    EXPECT_EQ(decodeImage(bytes, "file").values, (Values{0.5F, 0.5F, 0.25F}));
    EXPECT_THAT(warningsOf(bytes), HasSubstr("file: divided by the exposure and colour correction of its "
                                             "header, (2, 2, 4)\n"));
    EXPECT_EQ(warningsOf(hdr(format + "EXPOSURE=1\n", "-Y 1 +X 1", pixel)), "");
    EXPECT_EQ(decodeMessage(hdr(format + "EXPOSURE=-1\n", "-Y 1 +X 1", pixel)),
              "file: is a damaged HDR picture: the exposure '-1' is not a positive number");
    EXPECT_EQ(decodeMessage(hdr(format + "COLORCORR=1 2\n", "-Y 1 +X 1", pixel)),
              "file: is a damaged HDR picture: the colour correction '1 2' is not three positive numbers");
}

TEST(Hdr, ConvertsOtherColoursAndSaysSo) {
    // The white of Rec. 709, X 0.9505, Y 1, Z 1.0891, in 256ths: 121.66, 128, 139.4 at exponent 129.
    const Bytes xyz = hdr("FORMAT=32-bit_rle_xyze\n", "-Y 1 +X 1", std::string("\x7a\x80\x8b\x81", 4));
    const Image white = decodeImage(xyz, "file");
    for (const float value : white.values) EXPECT_NEAR(value, 1, 0.015F); // a step of a mantissa: 1/128
    EXPECT_THAT(warningsOf(xyz), HasSubstr("file: converted to the primaries of Rec. 709 from CIE XYZ\n"));
    // Exactly: each of X, Y, Z alone gives a column of the matrix of IEC 61966-2-1.
    const Image x =
        decodeImage(hdr("FORMAT=32-bit_rle_xyze\n", "-Y 1 +X 1", std::string("\x80\0\0\x81", 4)), "file");
    EXPECT_NEAR(x.at(0, 0, 0), 3.2406F, 1e-3F);
    EXPECT_NEAR(x.at(0, 0, 1), -0.9689F, 1e-3F);
    EXPECT_NEAR(x.at(0, 0, 2), 0.0557F, 1e-3F);

    const auto stated = [](const std::string& primaries) {
        return hdr(format + "PRIMARIES=" + primaries + "\n", "-Y 1 +X 1", pixel);
    };
    const Values plain{1, 0.5F, 0};
    // Radiance's own and those of Rec. 709 stand for themselves.
    for (const char* same :
         {"0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333", ".64 .33 .3 .6 .15 .06 .3127 .329"}) {
        EXPECT_EQ(decodeImage(stated(same), "file").values, plain);
        EXPECT_EQ(warningsOf(stated(same)), "");
    }
    const Bytes wide = stated("0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290");
    const Image converted = decodeImage(wide, "file");
    EXPECT_NEAR(converted.at(0, 0, 0), 1.6605F - 0.5F * 0.5876F, 1e-3F);
    EXPECT_NEAR(converted.at(0, 0, 1), -0.1246F + 0.5F * 1.1329F, 1e-3F);
    EXPECT_THAT(warningsOf(wide),
                HasSubstr("file: converted to the primaries of Rec. 709 from red (0.708, 0.292)"));
    EXPECT_THAT(warningsOf(stated("red")), HasSubstr("file: its primaries 'red' are not eight numbers"));
    EXPECT_THAT(warningsOf(stated("1 1 1 1 1 1 1 1")), HasSubstr("file: its primaries span no colours"));
}

TEST(Hdr, RefusesWhatIsDamagedOrNotReadAndSaysWhich) {
    EXPECT_EQ(decodeMessage(hdr("FORMAT=Radiance_spectra\n", "-Y 1 +X 1", pixel)),
              "file: is an HDR picture of the kind 'Radiance_spectra', which is not read");
    for (const char* resolution : {"-Y 1 +Y 1", "-Y one +X 1", "1 1", "-Y 1 +X 1 +Z 1", "*Y 1 +X 1"})
        EXPECT_EQ(decodeMessage(hdr(format, resolution, pixel)),
                  std::string("file: is a damaged HDR picture: the resolution '") + resolution +
                      "' is not of the form '-Y height +X width', in any of its eight orders and signs");
    EXPECT_EQ(decodeMessage(hdr(format, "-Y 16384 +X 16384", pixel)),
              "file: has 16384x16384 pixels of 3 channels; at most 268435456 values are read");
    EXPECT_EQ(decodeMessage(hdr(format, "+X 20000 +Y 1", pixel)),
              "file: has the size 20000x1; at most 16384 pixels a side are read");
    EXPECT_EQ(decodeMessage(hdr(format, "-Y 9000 +X 9000", pixel)), "file: is a truncated HDR picture");
    EXPECT_EQ(
        decodeMessage(hdr(format, "-Y 1 +X 8", std::string("\x02\x02\x00\x09", 4) + std::string(64, '\x01'))),
        "file: is a damaged HDR picture: a row of another width");
    EXPECT_EQ(decodeMessage(
                  hdr(format, "-Y 1 +X 8", std::string("\x02\x02\x00\x08\x89", 5) + std::string(64, '\x01'))),
              "file: is a damaged HDR picture: a run beyond its row");
}

} // namespace
} // namespace kestrel
