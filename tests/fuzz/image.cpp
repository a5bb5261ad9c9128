// Pictures: PNG, HDR and EXR, told by their first bytes.
#include "fuzz.h"
#include "image/io.h"
#include "unit/image_file_builders.h"

namespace {

using kestrel::test_files::Octets;

void decode(std::span<const std::byte> bytes) {
    using namespace kestrel;
    fuzz::taken([&] {
        const Image image = decodeImage(bytes, "picture");
        KESTREL_CHECK_EQ(image.values.size(), image.pixelCount() * static_cast<std::size_t>(image.channels));
        KESTREL_CHECK_LE(image.values.size(), maxImageValues);
        KESTREL_CHECK(image.channels >= 1 && image.channels <= 4);
    });
}

// The PNG with checksums that fit, so that changed bytes are read behind them; empty if it is none.
Octets mended(std::span<const std::uint8_t> png) {
    constexpr std::size_t head = 8;
    if (png.size() < head || png[0] != 0x89) return {};
    Octets file(png.begin(), png.begin() + head);
    for (std::size_t at = head; png.size() - at >= 12;) {
        std::size_t length = 0;
        for (std::size_t i = 0; i < 4; ++i) length = length << 8 | png[at + i];
        if (length > png.size() - at - 12) break;
        const auto typed = png.subspan(at + 4, 4 + length);
        const Octets data(typed.begin() + 4, typed.end());
        kestrel::test_files::append(
            file, kestrel::test_files::pngChunk(std::string(typed.begin(), typed.begin() + 4), data));
        at += 12 + length;
    }
    return file;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    decode(kestrel::fuzz::bytesOf(data, size));
    if (const Octets png = mended({data, size}); !png.empty()) decode(std::as_bytes(std::span(png)));
    return 0;
}
