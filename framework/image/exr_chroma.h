// Luminance with subsampled chroma (OpenEXR, "Technical Introduction": Luminance/Chroma Images).
#pragma once
#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfRgba.h>
#include <cstddef>
#include <vector>

namespace kestrel::detail {

// Pixels whose green is Y, and whose red and blue are RY and BY: in every `stepX`-th pixel of every
// `stepY`-th line, beginning with the first; both steps are 1 or 2.
struct ChromaPicture {
    int width = 0;
    int height = 0;
    int stepX = 1;
    int stepY = 1;
    std::vector<Imf::Rgba> pixels;
    [[nodiscard]] Imf::Rgba* line(int y) {
        return pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    }
};

// The chroma between its samples by OpenEXR's own filters, then RGB in place of Y, RY and BY.
void chromaToRgb(ChromaPicture& picture, const Imf::Chromaticities& chromaticities);

} // namespace kestrel::detail
