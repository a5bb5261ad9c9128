// Files cut off or changed at every byte: an error that names the file, or an image; never a crash.
#include "core/error.h"
#include "image/io.h"
#include "support/message.h"
#include "unit/image_file_builders.h"
#include "unit/image_samples.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using test_files::Bytes;
using test_files::decodeMessage;
using test_files::Sample;
using test_files::samples;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(HostileImages, EverySampleIsWhole) {
    for (const Sample& sample : samples()) EXPECT_NO_THROW(decodeImage(sample.bytes, "file"));
}

TEST(HostileImages, TruncatedAtEveryLengthIsAnError) {
    for (const Sample& sample : samples())
        for (std::size_t length = 0; length < sample.bytes.size(); ++length) {
            // A copy of its own, so that a sanitizer sees a read beyond the end.
            const Bytes part(sample.bytes.begin(),
                             sample.bytes.begin() + static_cast<std::ptrdiff_t>(length));
            const std::string message = decodeMessage(part);
            // Where only the smaller levels of tiles are cut off, the picture is there.
            if (message == "no error" && std::string_view(sample.kind) == "EXR tiles" && length > 600) {
                EXPECT_EQ(decodeImage(part, "file"), decodeImage(sample.bytes, "file"));
                continue;
            }
            EXPECT_THAT(message, AllOf(StartsWith("file: "), testing::Not(HasSubstr("\n"))))
                << sample.kind << ", " << length << " of " << sample.bytes.size();
        }
}

TEST(HostileImages, DamagedAtEveryByteIsAnErrorOrAnImage) {
    for (const Sample& sample : samples())
        for (std::size_t at = 0; at < sample.bytes.size(); ++at)
            for (const int change : {0x01, 0x80, 0xff}) {
                Bytes damaged = sample.bytes;
                damaged[at] ^= static_cast<std::byte>(change);
                try {
                    const Image image = decodeImage(damaged, "file");
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
