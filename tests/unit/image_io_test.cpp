#include "core/error.h"
#include "core/files.h"
#include "image/io.h"
#include "support/message.h"
#include "support/pattern.h"
#include "unit/image_file_builders.h"
#include <bit>
#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace kestrel {
namespace {

using test::messageOf;
using test::pattern;
using test_files::Bytes;
using test_files::decodeMessage;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

class ImageFiles : public testing::Test {
protected:
    // A folder of its own, so that tests that run side by side do not meet.
    ImageFiles()
        : folder_(fs::path(testing::TempDir()) /
                  (std::string("kestrel_image_") +
                   testing::UnitTest::GetInstance()->current_test_info()->name())) {
        fs::create_directories(folder_);
    }
    ~ImageFiles() override { fs::remove_all(folder_); }
    fs::path folder_;
};

Image roundTrip(const Image& image, ImageFormat format, Encoding encoding = Encoding::Linear) {
    return decodeImage(encodeImage(image, format, encoding), format, "file");
}

std::vector<std::uint32_t> bitsOf(const Image& image) {
    std::vector<std::uint32_t> bits;
    for (const float value : image.values) bits.push_back(std::bit_cast<std::uint32_t>(value));
    return bits;
}

TEST_F(ImageFiles, PngRoundTripIsWithinHalfACode) {
    for (const int channels : {1, 3, 4})
        for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}, {33, 64}}) {
            const Image image = pattern(width, height, channels);
            const fs::path file = folder_ / "image.png";
            writeImage(file, image, Encoding::Linear);
            const Image read = readImage(file);
            ASSERT_EQ(read.channels, channels);
            ASSERT_TRUE(read.sameSize(image));
            for (std::size_t i = 0; i < image.values.size(); ++i)
                EXPECT_NEAR(read.values[i], image.values[i], 1.0F / 510 + 1e-6F);
            // What came from code values goes back to the same code values.
            EXPECT_EQ(roundTrip(read, ImageFormat::Png), read);
        }
}

TEST_F(ImageFiles, PngEncodesLinearLightOnRequestButNotAlpha) {
    const Image linear(1, 1, 4, 0.5F);
    const Image read = roundTrip(linear, ImageFormat::Png, Encoding::Srgb);
    EXPECT_EQ(read.at(0, 0, 0), 188.0F / 255.0F); // 255 * 0.7354 = 187.5
    EXPECT_EQ(read.at(0, 0, 3), 128.0F / 255.0F);
    EXPECT_EQ(roundTrip(Image(1, 1, 1, 0.5F), ImageFormat::Png, Encoding::Srgb).at(0, 0), 188.0F / 255.0F);
    EXPECT_EQ(roundTrip(Image(1, 1, 1, 0.5F), ImageFormat::Png, Encoding::Linear).at(0, 0), 128.0F / 255.0F);
}

TEST_F(ImageFiles, PngClampsAndHasACodeForWhatIsNoNumber) {
    Image image(6, 1, 1);
    image.values = {-1, 2, nan, infinity, -infinity, 1e-30F};
    for (const Encoding encoding : {Encoding::Srgb, Encoding::Linear})
        EXPECT_EQ(roundTrip(image, ImageFormat::Png, encoding).values,
                  (std::vector<float>{0, 1, 0, 1, 0, 0}));
}

TEST_F(ImageFiles, PngWritesAVectorAsRedAndGreen) {
    Image image(1, 1, 2);
    image.values = {1, 0.2F};
    const Image read = roundTrip(image, ImageFormat::Png);
    EXPECT_EQ(read.values, (std::vector<float>{1, 51.0F / 255.0F, 0}));
}

TEST_F(ImageFiles, PngReadsAllKindsOfPixels) {
    using test_files::png;
    const auto values = [](const Bytes& bytes) {
        return decodeImage(bytes, ImageFormat::Png, "file").values;
    };
    using Values = std::vector<float>;
    // 16-bit grey, two pixels: 0x0102 and 0xffff.
    EXPECT_EQ(values(png(2, 1, 16, 0, {0, 0x01, 0x02, 0xff, 0xff})), (Values{258.0F / 65535.0F, 1}));
    // 16-bit RGB.
    EXPECT_EQ(values(png(1, 1, 16, 2, {0, 0, 0, 0x80, 0, 0xff, 0xff})), (Values{0, 32768.0F / 65535.0F, 1}));
    // 8-bit grey with alpha is RGBA.
    EXPECT_EQ(values(png(1, 1, 8, 4, {0, 51, 255})), (Values{0.2F, 0.2F, 0.2F, 1}));
    // 1-bit grey: 1, 0, 1.
    EXPECT_EQ(values(png(3, 1, 1, 0, {0, 0b10100000})), (Values{1, 0, 1}));
    // A palette of two colours.
    EXPECT_EQ(values(png(2, 1, 8, 3, {0, 1, 0}, {0, 0, 255, 255, 0, 0})), (Values{1, 0, 0, 0, 0, 1}));
}

TEST_F(ImageFiles, PngRefusesWhatIsDamaged) {
    using test_files::png;
    Bytes bytes = png(1, 1, 8, 0, {0, 7});
    EXPECT_EQ(decodeImage(bytes, ImageFormat::Png, "file").values, (std::vector<float>{7.0F / 255.0F}));
    bytes[30] ^= std::byte{1}; // in the header's checksum
    EXPECT_EQ(decodeMessage(bytes, ImageFormat::Png), "file: is a damaged PNG: a checksum does not fit");
    EXPECT_EQ(decodeMessage(png(20000, 1, 8, 0, {0}), ImageFormat::Png),
              "file: has the size 20000x1; at most 16384 pixels a side are read");
    EXPECT_EQ(decodeMessage(png(0, 1, 8, 0, {0}), ImageFormat::Png), "file: has the size 0x1");
    EXPECT_THAT(decodeMessage(png(16384, 16384, 8, 2, {0}), ImageFormat::Png), HasSubstr("values are read"));
    EXPECT_THAT(decodeMessage(png(8, 8, 8, 0, {0, 1}), ImageFormat::Png),
                StartsWith("file: is a damaged PNG"));
    EXPECT_THAT(decodeMessage(png(1, 1, 8, 5, {0, 7}), ImageFormat::Png),
                StartsWith("file: is a damaged PNG"));
    EXPECT_EQ(decodeMessage(test_files::bytesOf("GIF89a and more of it"), ImageFormat::Png),
              "file: is not a PNG");
}

TEST_F(ImageFiles, PngThatInflatesBeyondItsSizeIsRefusedUninflated) {
    // 300 KB of stored data for one pixel.
    Bytes bytes = test_files::png(1, 1, 8, 0, std::vector<std::uint8_t>(300000));
    EXPECT_EQ(decodeMessage(bytes, ImageFormat::Png), "file: is a damaged PNG: its data do not fit its size");
}

TEST_F(ImageFiles, ExrRoundTripIsExactToTheBit) {
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
            const fs::path file = folder_ / "image.EXR";
            writeImage(file, image, Encoding::Srgb);
            const Image read = readImage(file);
            EXPECT_EQ(read.channels, channels);
            EXPECT_TRUE(read.sameSize(image));
            EXPECT_EQ(bitsOf(read), bitsOf(image));
        }
}

TEST_F(ImageFiles, ExrReadsHalfAndPicksChannelsByName) {
    using test_files::ExrBuilder;
    const auto values = [](const ExrBuilder& exr) {
        return decodeImage(exr.bytes(), ImageFormat::Exr, "file").values;
    };
    using Values = std::vector<float>;
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

    ExrBuilder more; // depth and identifiers beside the colours
    more.floats("B", {3}).floats("G", {2}).floats("R", {1}).floats("Z", {100}).uints("id", {5});
    testing::internal::CaptureStderr();
    EXPECT_EQ(values(more), (Values{1, 2, 3}));
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("file: left out: the channels Z, id"));

    ExrBuilder unknown;
    unknown.floats("u", {1}).floats("v", {2});
    EXPECT_EQ(decodeMessage(unknown.bytes(), ImageFormat::Exr),
              "file: has the channels 'u', 'v': neither RGB nor XYZ nor a single one");
    ExrBuilder integers;
    integers.uints("id", {1, 2});
    EXPECT_EQ(decodeMessage(integers.bytes(), ImageFormat::Exr),
              "file: holds integers in the channel 'id'; half and float are read");
}

TEST_F(ImageFiles, ExrWindowAndOrderOfLinesDoNotTurnThePicture) {
    test_files::ExrBuilder exr;
    exr.height = 3;
    exr.minX = -5;
    exr.minY = 40;
    exr.floats("Y", {1, 2, 3, 4, 5, 6});
    for (const int order : {0, 1}) {
        exr.lineOrder = order;
        const Image image = decodeImage(exr.bytes(), ImageFormat::Exr, "file");
        EXPECT_EQ(image.width, 2);
        EXPECT_EQ(image.height, 3);
        EXPECT_EQ(image.values, (std::vector<float>{1, 2, 3, 4, 5, 6}));
    }
}

TEST_F(ImageFiles, ExrRefusesWhatItCannotRead) {
    using test_files::ExrBuilder;
    const auto message = [](auto change) {
        ExrBuilder exr;
        exr.floats("Y", {1, 2});
        change(exr);
        return decodeMessage(exr.bytes(), ImageFormat::Exr);
    };
    EXPECT_EQ(message([](ExrBuilder& e) { e.flags = 0x200; }),
              "file: is an EXR with tiles, which is not read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.flags = 0x1000; }),
              "file: is an EXR with several parts, which is not read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.flags = 0x800; }),
              "file: is an EXR with deep data, which is not read");
    EXPECT_EQ(
        message([](ExrBuilder& e) { e.compression = 6; }),
        "file: is an EXR with the compression B44 (PIZ, ZIP, ZIPS, RLE and none are), which is not read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.compression = 77; }),
              "file: is a damaged EXR: the compression 77");
    EXPECT_EQ(message([](ExrBuilder& e) { e.sampling = 2; }),
              "file: is an EXR with subsampled channels, which is not read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.chunkCount = 1 << 30; }),
              "file: is a damaged EXR: it counts 1073741824 chunks instead of 1");
    EXPECT_EQ(message([](ExrBuilder& e) { e.claimedWidth = 100000; }),
              "file: has the size 100000x1; at most 16384 pixels a side are read");
    EXPECT_EQ(message([](ExrBuilder& e) { e.claimedWidth = 3; }),
              "file: is a damaged EXR: a chunk of an impossible size");
    EXPECT_EQ(message([](ExrBuilder& e) { e.minX = 2000000000; }),
              "file: is a damaged EXR: its data window is far from the origin");
    EXPECT_EQ(message([](ExrBuilder& e) { e.claimedWidth = -1; }), "file: has the size -1x1");
    EXPECT_EQ(decodeMessage(test_files::bytesOf("not an EXR at all"), ImageFormat::Exr),
              "file: is not an EXR");
}

TEST_F(ImageFiles, HdrRoundTripIsWithinItsEightBitMantissa) {
    for (const int width : {1, 7, 8, 200}) { // runs are written from 8 pixels on
        Image image = pattern(width, 5, 3);
        image.values[0] = 1234.5F;
        image.at(width - 1, 4, 1) = 1e-4F;
        const fs::path file = folder_ / "image.hdr";
        writeImage(file, image, Encoding::Linear);
        const Image read = readImage(file);
        ASSERT_EQ(read.channels, 3);
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < width; ++x) {
                const float greatest = std::max({image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)});
                for (int channel = 0; channel < 3; ++channel)
                    EXPECT_NEAR(read.at(x, y, channel), image.at(x, y, channel), greatest / 127);
            }
    }
}

TEST_F(ImageFiles, HdrWritesWhatItCannotHoldAsTheNearestValue) {
    Image image(4, 1, 1);
    image.values = {-1, nan, infinity, 1e-40F};
    const Image read = roundTrip(image, ImageFormat::Hdr);
    EXPECT_EQ(read.at(0, 0), 0);
    EXPECT_EQ(read.at(1, 0), 0);
    EXPECT_GT(read.at(2, 0), 1e38F);
    EXPECT_TRUE(std::isfinite(read.at(2, 0)));
    EXPECT_EQ(read.at(3, 0), 0);
}

TEST_F(ImageFiles, HdrReadsRunsAndExposures) {
    const auto hdr = [](const std::string& header, const std::string& size, const std::string& pixels) {
        return test_files::bytesOf("#?RADIANCE\n" + header + "\n" + size + "\n" + pixels);
    };
    const std::string format = "FORMAT=32-bit_rle_rgbe\n";
    const std::string pixel("\x80\x40\x00\x81", 4); // 128, 64, 0 times 2^(129-136) = 1, 0.5, 0
    EXPECT_EQ(decodeImage(hdr(format, "-Y 1 +X 1", pixel), ImageFormat::Hdr, "file").values,
              (std::vector<float>{1, 0.5F, 0}));
    EXPECT_EQ(
        decodeImage(hdr(format + "EXPOSURE= 2\nEXPOSURE=2.0\n", "-Y 1 +X 1", pixel), ImageFormat::Hdr, "f")
            .values,
        (std::vector<float>{0.25F, 0.125F, 0}));
    // Nine pixels: red a run, green copied, blue both, exponent a run.
    const std::string row(
        "\x02\x02\x00\x09\x89\x80\x09\x01\x02\x03\x04\x05\x06\x07\x08\x09\x88\x40\x01\x20\x89\x88", 22);
    const Image runs = decodeImage(hdr(format, "-Y 1 +X 9", row), ImageFormat::Hdr, "file");
    EXPECT_EQ(runs.at(8, 0, 0), 128);
    EXPECT_EQ(runs.at(4, 0, 1), 5);
    EXPECT_EQ(runs.at(7, 0, 2), 64);
    EXPECT_EQ(runs.at(8, 0, 2), 32);

    EXPECT_EQ(decodeMessage(hdr("FORMAT=32-bit_rle_xyze\n", "-Y 1 +X 1", pixel), ImageFormat::Hdr),
              "file: is an HDR picture of the kind '32-bit_rle_xyze'; only 32-bit_rle_rgbe is read");
    EXPECT_EQ(
        decodeMessage(hdr(format, "+Y 1 +X 1", pixel), ImageFormat::Hdr),
        "file: is a damaged HDR picture: the resolution '+Y 1 +X 1' is not of the form '-Y height +X width'");
    EXPECT_EQ(decodeMessage(hdr(format + "EXPOSURE=-1\n", "-Y 1 +X 1", pixel), ImageFormat::Hdr),
              "file: is a damaged HDR picture: the exposure '-1' is not a positive number");
    EXPECT_EQ(decodeMessage(hdr(format, "-Y 16384 +X 16384", pixel), ImageFormat::Hdr),
              "file: has 16384x16384 pixels of 3 channels; at most 268435456 values are read");
    EXPECT_EQ(decodeMessage(hdr(format, "-Y 9000 +X 9000", pixel), ImageFormat::Hdr),
              "file: is a truncated HDR picture");
    EXPECT_EQ(
        decodeMessage(hdr(format, "-Y 1 +X 8", std::string("\x02\x02\x00\x09", 4) + std::string(64, '\x01')),
                      ImageFormat::Hdr),
        "file: is a damaged HDR picture: a row of another width");
    EXPECT_EQ(decodeMessage(
                  hdr(format, "-Y 1 +X 8", std::string("\x02\x02\x00\x08\x89", 5) + std::string(64, '\x01')),
                  ImageFormat::Hdr),
              "file: is a damaged HDR picture: a run beyond its row");
}

TEST_F(ImageFiles, NameTheFileInEveryMessage) {
    const fs::path missing = folder_ / "missing.png";
    EXPECT_EQ(messageOf([&] { readImage(missing); }), missing.string() + ": no such file");
    EXPECT_EQ(messageOf([] { readImage("a.jpg"); }), "a.jpg: the ending '.jpg' is not .png, .hdr or .exr");
    EXPECT_EQ(messageOf([] { imageFormat("picture"); }), "picture: needs the ending .png, .hdr or .exr");
    EXPECT_EQ(messageOf([] { writeImage("a.bmp", Image(1, 1, 1), Encoding::Linear); }),
              "a.bmp: the ending '.bmp' is not .png, .hdr or .exr");
    const fs::path empty = folder_ / "empty.exr";
    writeFile(empty, std::string_view());
    EXPECT_EQ(messageOf([&] { readImage(empty); }), empty.string() + ": is empty");
    EXPECT_EQ(imageFormat("A.PNG"), ImageFormat::Png);
    EXPECT_EQ(imageFormat("a.b.Hdr"), ImageFormat::Hdr);
}

TEST_F(ImageFiles, ExrReadsPiz) {
    const Image image = decodeImage(test_files::pizSample().bytes(), ImageFormat::Exr, "file");
    ASSERT_EQ(image.values.size(), 128U);
    for (std::size_t i = 0; i < 128; ++i)
        EXPECT_EQ(image.values[i], std::ldexp(static_cast<float>(i / 32), -24)) << i;
}

} // namespace
} // namespace kestrel
