#include "image/exr_chroma.h"
#include <OpenEXR/ImfRgbaYca.h>
#include <algorithm>
#include <array>

namespace kestrel::detail {
namespace {

namespace yca = Imf::RgbaYca;

// Beyond the border the chroma is that of the sample nearest to it.
void fillAlong(ChromaPicture& picture) {
    const int last = picture.width - 1 - (picture.width - 1) % 2;
    std::vector<Imf::Rgba> padded(static_cast<std::size_t>(picture.width + yca::N - 1));
    for (int y = 0; y < picture.height; y += picture.stepY) {
        Imf::Rgba* line = picture.line(y);
        for (int i = 0; i < picture.width + yca::N - 1; ++i) {
            const int x = i - yca::N2;
            Imf::Rgba& to = padded[static_cast<std::size_t>(i)];
            to = line[std::clamp(x, 0, picture.width - 1)];
            if (x < 0 || x > last) {
                const Imf::Rgba& nearest = line[x < 0 ? 0 : last];
                to.r = nearest.r;
                to.b = nearest.b;
            }
        }
        yca::reconstructChromaHoriz(picture.width, padded.data(), line);
    }
}

void fillBetweenLines(ChromaPicture& picture) {
    const int last = picture.height - 1 - (picture.height - 1) % 2;
    for (int y = 1; y < picture.height; y += 2) {
        // Of the lines above and below only those with chroma are looked at, of the middle one only Y and A.
        std::array<const Imf::Rgba*, yca::N> lines{};
        for (int i = 0; i < yca::N; ++i)
            lines[static_cast<std::size_t>(i)] = picture.line(std::clamp(y + i - yca::N2, 0, last));
        lines[yca::N2] = picture.line(y);
        std::vector<Imf::Rgba> line(static_cast<std::size_t>(picture.width));
        yca::reconstructChromaVert(picture.width, lines.data(), line.data());
        std::copy(line.begin(), line.end(), picture.line(y));
    }
}

void lessenSaturation(ChromaPicture& picture, const Imath::V3f& weights) {
    const ChromaPicture before = picture;
    const auto lineBefore = [&](int y) {
        return before.pixels.data() + static_cast<std::size_t>(std::clamp(y, 0, before.height - 1)) *
                                          static_cast<std::size_t>(before.width);
    };
    for (int y = 0; y < picture.height; ++y) {
        const std::array<const Imf::Rgba*, 3> lines{lineBefore(y - 1), lineBefore(y), lineBefore(y + 1)};
        yca::fixSaturation(weights, picture.width, lines.data(), picture.line(y));
    }
}

} // namespace

void chromaToRgb(ChromaPicture& picture, const Imf::Chromaticities& chromaticities) {
    if (picture.stepX == 2) fillAlong(picture);
    if (picture.stepY == 2) fillBetweenLines(picture);
    const Imath::V3f weights = yca::computeYw(chromaticities);
    for (int y = 0; y < picture.height; ++y)
        yca::YCAtoRGBA(weights, picture.width, picture.line(y), picture.line(y));
    if (picture.stepX == 2 || picture.stepY == 2) lessenSaturation(picture, weights);
}

} // namespace kestrel::detail
