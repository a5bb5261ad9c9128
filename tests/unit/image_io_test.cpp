#include "core/error.h"
#include "core/files.h"
#include "image/io.h"
#include "support/message.h"
#include "support/pattern.h"
#include "support/temporary_folder.h"
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
using test_files::infinity;
using test_files::nan;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

class ImageFiles : public testing::Test {
protected:
    test::TemporaryFolder folder_;
};

Image roundTrip(const Image& image, ImageFormat format, Encoding encoding = Encoding::Linear) {
    return decodeImage(encodeImage(image, format, encoding), "file");
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
    const auto values = [](const Bytes& bytes) { return decodeImage(bytes, "file").values; };
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
    EXPECT_EQ(decodeImage(bytes, "file").values, (std::vector<float>{7.0F / 255.0F}));
    bytes[30] ^= std::byte{1}; // in the header's checksum
    EXPECT_EQ(decodeMessage(bytes), "file: is a damaged PNG: a checksum does not fit");
    EXPECT_EQ(decodeMessage(png(20000, 1, 8, 0, {0})),
              "file: has the size 20000x1; at most 16384 pixels a side are read");
    EXPECT_EQ(decodeMessage(png(0, 1, 8, 0, {0})), "file: has the size 0x1");
    EXPECT_THAT(decodeMessage(png(16384, 16384, 8, 2, {0})), HasSubstr("values are read"));
    EXPECT_THAT(decodeMessage(png(8, 8, 8, 0, {0, 1})), StartsWith("file: is a damaged PNG"));
    EXPECT_THAT(decodeMessage(png(1, 1, 8, 5, {0, 7})), StartsWith("file: is a damaged PNG"));
    Bytes mangled = png(1, 1, 8, 0, {0, 7}); // as by a transfer that changes the ends of lines
    mangled[4] = std::byte{'\n'};
    EXPECT_EQ(decodeMessage(mangled), "file: is not a PNG");
}

TEST_F(ImageFiles, PngThatInflatesBeyondItsSizeIsRefusedUninflated) {
    // 300 KB of stored data for one pixel.
    Bytes bytes = test_files::png(1, 1, 8, 0, std::vector<std::uint8_t>(300000));
    EXPECT_EQ(decodeMessage(bytes), "file: is a damaged PNG: its data do not fit its size");
}

TEST_F(ImageFiles, NameTheFileInEveryMessage) {
    const fs::path missing = folder_ / "missing.png";
    EXPECT_EQ(messageOf([&] { readImage(missing); }), missing.string() + ": no such file");
    EXPECT_EQ(messageOf([] { readImage("a.exr:beauty"); }), "a.exr: no such file");
    EXPECT_EQ(messageOf([] { imageFormat("picture"); }), "picture: needs the ending .png, .hdr or .exr");
    EXPECT_EQ(messageOf([] { writeImage("a.bmp", Image(1, 1, 1), Encoding::Linear); }),
              "a.bmp: the ending '.bmp' is not .png, .hdr or .exr");
    const fs::path empty = folder_ / "empty.exr";
    writeFile(empty, std::string_view());
    EXPECT_EQ(messageOf([&] { readImage(empty); }), empty.string() + ": is empty");
    EXPECT_EQ(imageFormat("A.PNG"), ImageFormat::Png);
    EXPECT_EQ(imageFormat("a.b.Hdr"), ImageFormat::Hdr);
}

// Adam7: the passes' first pixels and steps in x and y (PNG, 8.2), a row a filter byte 0 and the pixels.
std::vector<std::uint8_t> interlaced(std::uint32_t width, std::uint32_t height, std::size_t bytesPerPixel,
                                     const std::vector<std::uint8_t>& pixels) {
    struct Pass {
        std::uint32_t x, y, stepX, stepY;
    };
    std::vector<std::uint8_t> rows;
    for (const Pass& pass : {Pass{0, 0, 8, 8},
                             {4, 0, 8, 8},
                             {0, 4, 4, 8},
                             {2, 0, 4, 4},
                             {0, 2, 2, 4},
                             {1, 0, 2, 2},
                             {0, 1, 1, 2}})
        for (std::uint32_t y = pass.y; y < height && pass.x < width; y += pass.stepY) {
            rows.push_back(0);
            for (std::uint32_t x = pass.x; x < width; x += pass.stepX)
                for (std::size_t i = 0; i < bytesPerPixel; ++i)
                    rows.push_back(pixels[(std::size_t{y} * width + x) * bytesPerPixel + i]);
        }
    return rows;
}

TEST_F(ImageFiles, PngReadsInterlacedPictures) {
    for (const auto& [bits, colorType, channels] :
         {std::tuple<std::uint8_t, std::uint8_t, std::size_t>{8, 0, 1}, {8, 2, 3}, {8, 6, 4}, {16, 2, 3}})
        for (const auto& [width, height] : {std::pair{1U, 1U}, {5U, 3U}, {19U, 17U}}) {
            const std::size_t bytesPerPixel = channels * bits / 8;
            std::vector<std::uint8_t> pixels;
            for (std::size_t i = 0; i < width * height * bytesPerPixel; ++i)
                pixels.push_back(static_cast<std::uint8_t>(i * 37 + i / 7));
            const Image image =
                decodeImage(test_files::png(width, height, bits, colorType,
                                            interlaced(width, height, bytesPerPixel, pixels), {}, {}, true),
                            "file");
            ASSERT_EQ(image.values.size(), width * height * channels);
            for (std::size_t i = 0; i < image.values.size(); ++i)
                EXPECT_EQ(image.values[i],
                          bits == 8 ? static_cast<float>(pixels[i]) / 255.0F
                                    : static_cast<float>(pixels[2 * i] * 256 + pixels[2 * i + 1]) / 65535.0F);
        }
}

TEST_F(ImageFiles, PngReadsTransparencyOfPalettesAndColours) {
    using test_files::png;
    using Values = std::vector<float>;
    // A palette of red and blue, the first of them half transparent: 51 / 255.
    EXPECT_EQ(decodeImage(png(2, 1, 8, 3, {0, 1, 0}, {255, 0, 0, 0, 0, 255}, {51}), "file").values,
              (Values{0, 0, 1, 1, 1, 0, 0, 0.2F}));
    // Two pixels of four bits in a palette.
    EXPECT_EQ(decodeImage(png(2, 1, 4, 3, {0, 0x10}, {255, 0, 0, 0, 0, 255}), "file").values,
              (Values{0, 0, 1, 1, 0, 0}));
    // One grey value that is transparent, of 8 and of 16 bits.
    EXPECT_EQ(decodeImage(png(2, 1, 8, 0, {0, 51, 255}, {}, {0, 51}), "file").values,
              (Values{0.2F, 0.2F, 0.2F, 0, 1, 1, 1, 1}));
    EXPECT_EQ(decodeImage(png(2, 1, 16, 0, {0, 0x01, 0x02, 0xff, 0xff}, {}, {1, 2}), "file").values,
              (Values{258.0F / 65535.0F, 258.0F / 65535.0F, 258.0F / 65535.0F, 0, 1, 1, 1, 1}));
    // 16-bit grey with alpha.
    EXPECT_EQ(decodeImage(png(1, 1, 16, 4, {0, 0x01, 0x02, 0x80, 0x00}), "file").values,
              (Values{258.0F / 65535.0F, 258.0F / 65535.0F, 258.0F / 65535.0F, 32768.0F / 65535.0F}));
}

TEST_F(ImageFiles, AreToldByTheirFirstBytesNotByTheirNames) {
    const Image image = pattern(9, 4, 3);
    for (const ImageFormat format : {ImageFormat::Png, ImageFormat::Hdr, ImageFormat::Exr}) {
        const auto bytes = encodeImage(image, format, Encoding::Linear);
        EXPECT_EQ(imageFormat(bytes, "file"), format);
        for (const char* name : {"picture", "picture.png", "picture.hdr", "picture.exr", "picture.jpg"}) {
            writeFile(folder_ / name, bytes);
            const Picture picture = readPicture(folder_ / name);
            EXPECT_EQ(picture.format, format);
            EXPECT_EQ(picture.image, decodeImage(bytes, "file"));
        }
    }
    EXPECT_EQ(decodeMessage(test_files::bytesOf("GIF89a and more of it")),
              "file: is a GIF picture; PNG, HDR and EXR are read");
    EXPECT_EQ(decodeMessage(test_files::bytesOf("\xff\xd8\xff\xe0 JFIF")),
              "file: is a JPEG picture; PNG, HDR and EXR are read");
    EXPECT_EQ(decodeMessage(test_files::bytesOf("solid cube")),
              "file: does not begin as a PNG, HDR or EXR picture does");
    EXPECT_EQ(decodeMessage({}), "file: is empty");
}

TEST_F(ImageFiles, NameALayerBehindAColon) {
    const auto name = [&](const std::string& text) {
        const ImageName parts = imageName(folder_ / text);
        return parts.file.filename().string() + "|" + parts.layer;
    };
    writeImage(folder_ / "a.exr", Image(2, 2, 3, 0.5F), Encoding::Linear);
    EXPECT_EQ(name("a.exr"), "a.exr|");
    EXPECT_EQ(name("a.exr:beauty"), "a.exr|beauty");
    EXPECT_EQ(name("a.exr:shape:left"), "a.exr|shape:left");
    EXPECT_EQ(name("b.exr:beauty"), "b.exr|beauty"); // there is no such file, but that is what was meant
    EXPECT_EQ(name("frame:12.png"), "frame:12.png|");
    // A file whose own name has a colon is that file; with a layer the longest name wins.
    writeFile(folder_ / "a.exr:beauty",
              encodeImage(Image(3, 3, 1, 0.25F), ImageFormat::Exr, Encoding::Linear));
    EXPECT_EQ(name("a.exr:beauty"), "a.exr:beauty|");
    EXPECT_EQ(name("a.exr:beauty:R"), "a.exr:beauty|R");
    EXPECT_EQ(readImage(folder_ / "a.exr:R"), Image(2, 2, 1, 0.5F));

    writeImage(folder_ / "a.png", Image(2, 2, 3, 0.5F), Encoding::Linear);
    EXPECT_EQ(messageOf([&] { readImage(folder_ / "a.png:beauty"); }),
              (folder_ / "a.png").string() + ": is no EXR, so it has no layer 'beauty'");
}

} // namespace
} // namespace kestrel
