// Texel formats: the table that declarations, the memory plan, image writers and GL share.
#pragma once
#include <cstdint>
#include <string_view>

namespace kestrel {

enum class Format : std::uint8_t {
    None,
    R8,
    RG8,
    RGBA8,
    R16F,
    RG16F,
    RGBA16F,
    R32F,
    RG32F,
    RGBA32F,
    R8UI,
    R16UI,
    R32UI,
    RG32UI,
    RGBA32UI,
    R32I,
    D32F,
    Count
};

struct FormatInfo {
    std::string_view name; // "rgba16f": the GLSL image qualifier too, where there is one
    int channels = 0;
    int bytes = 0;         // a texel
    bool integer = false;  // usampler / uimage / isampler
    bool isSigned = false; // of integer formats
    bool depth = false;
};

const FormatInfo& formatInfo(Format format);

} // namespace kestrel
