// Files cut off or changed at every byte: an error that names the file, or an image; never a crash.
#include "core/error.h"
#include "image/io.h"
#include "support/message.h"
#include "support/pattern.h"
#include "unit/image_file_builders.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using test::pattern;
using test_files::Bytes;
using test_files::decodeMessage;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

struct Sample {
    ImageFormat format;
    Bytes bytes;
};

// Small files of every kind that is read.
std::vector<Sample> samples() {
    std::vector<Sample> result;
    for (const int channels : {1, 3, 4})
        for (const ImageFormat format : {ImageFormat::Png, ImageFormat::Hdr, ImageFormat::Exr})
            for (const int width : {2, 9})
                result.push_back(
                    {format, encodeImage(pattern(width, 3, channels), format, Encoding::Linear)});
    // Smooth, so that compression and runs come into play.
    for (const ImageFormat format : {ImageFormat::Png, ImageFormat::Hdr, ImageFormat::Exr})
        result.push_back({format, encodeImage(Image(32, 20, 3, 0.5F), format, Encoding::Linear)});
    result.push_back({ImageFormat::Png, test_files::png(2, 1, 16, 0, {0, 0x01, 0x02, 0xff, 0xff})});
    result.push_back({ImageFormat::Png, test_files::png(2, 1, 8, 3, {0, 1, 0}, {0, 0, 255, 255, 0, 0})});
    test_files::ExrBuilder half;
    half.height = 2;
    half.half("B", {1, 2, 3, 4}).half("G", {1, 2, 3, 4}).floats("R", {1, 2, 3, 4});
    result.push_back({ImageFormat::Exr, half.bytes()});
    test_files::ExrBuilder runs; // two runs of 8 bytes, equal before and after the predictor
    runs.half("Y", std::vector<std::uint16_t>(8, 0x8080));
    runs.compression = 1;
    runs.chunk = {7, 0x80, 7, 0x80};
    result.push_back({ImageFormat::Exr, runs.bytes()});
    result.push_back({ImageFormat::Exr, test_files::pizSample().bytes()});
    return result;
}

TEST(HostileImages, EverySampleIsWhole) {
    for (const Sample& sample : samples()) EXPECT_NO_THROW(decodeImage(sample.bytes, sample.format, "file"));
}

TEST(HostileImages, TruncatedAtEveryLengthIsAnError) {
    for (const Sample& sample : samples())
        for (std::size_t length = 0; length < sample.bytes.size(); ++length) {
            // A copy of its own, so that a sanitizer sees a read beyond the end.
            const Bytes part(sample.bytes.begin(),
                             sample.bytes.begin() + static_cast<std::ptrdiff_t>(length));
            EXPECT_THAT(decodeMessage(part, sample.format),
                        AllOf(StartsWith("file: "), testing::Not(HasSubstr("\n"))))
                << "format " << static_cast<int>(sample.format) << ", " << length << " of "
                << sample.bytes.size();
        }
}

TEST(HostileImages, DamagedAtEveryByteIsAnErrorOrAnImage) {
    for (const Sample& sample : samples())
        for (std::size_t at = 0; at < sample.bytes.size(); ++at)
            for (const int change : {0x01, 0x80, 0xff}) {
                Bytes damaged = sample.bytes;
                damaged[at] ^= static_cast<std::byte>(change);
                try {
                    const Image image = decodeImage(damaged, sample.format, "file");
                    EXPECT_EQ(image.values.size(),
                              image.pixelCount() * static_cast<std::size_t>(image.channels));
                    EXPECT_LE(image.values.size(), maxImageValues);
                } catch (const InputError& error) {
                    EXPECT_THAT(error.what(), StartsWith("file: "));
                }
            }
}

} // namespace
} // namespace kestrel
