// The layout of an OpenEXR file ("OpenEXR File Layout", openexr.com), read and checked before the decoder
// sees the file: the decoder trusts much of what a file says of itself.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace kestrel::detail {

enum class ExrPixelType : int { Uint = 0, Half = 1, Float = 2 };

struct ExrChannel {
    std::string name;
    ExrPixelType type = ExrPixelType::Float;
};

struct ExrLayout {
    int width = 0;
    int height = 0;
    std::vector<ExrChannel> channels; // in the file's order
    bool piz = false;                 // whether the pixels are compressed by PIZ
};

// Checks that `bytes` is a whole, single-part scan-line EXR whose chunks lie inside it and have possible
// sizes. Throws InputError whose location is `name` and that says what is wrong, or which kind of EXR is not
// read (tiles, several parts, deep data, subsampled channels, lossy compressions).
ExrLayout scanExr(std::span<const std::byte> bytes, const std::string& name);

} // namespace kestrel::detail
