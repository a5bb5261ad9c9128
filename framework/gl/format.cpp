#include "core/check.h"
#include "gl/loader.h"
#include "gl/objects.h"
#include <algorithm>
#include <cmath>

namespace kestrel::gl {

GlFormat glFormat(Format format) {
    switch (format) {
    case Format::R8:
        return {GL_R8, GL_RED, GL_UNSIGNED_BYTE};
    case Format::RG8:
        return {GL_RG8, GL_RG, GL_UNSIGNED_BYTE};
    case Format::RGBA8:
        return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::R16F:
        return {GL_R16F, GL_RED, GL_HALF_FLOAT};
    case Format::RG16F:
        return {GL_RG16F, GL_RG, GL_HALF_FLOAT};
    case Format::RGBA16F:
        return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT};
    case Format::R32F:
        return {GL_R32F, GL_RED, GL_FLOAT};
    case Format::RG32F:
        return {GL_RG32F, GL_RG, GL_FLOAT};
    case Format::RGBA32F:
        return {GL_RGBA32F, GL_RGBA, GL_FLOAT};
    case Format::R8UI:
        return {GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE};
    case Format::R16UI:
        return {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT};
    case Format::R32UI:
        return {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT};
    case Format::RG32UI:
        return {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT};
    case Format::RGBA32UI:
        return {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT};
    case Format::R32I:
        return {GL_R32I, GL_RED_INTEGER, GL_INT};
    case Format::D32F:
        return {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT};
    case Format::None:
    case Format::Count:
        break;
    }
    KESTREL_CHECK(!"a texture format was expected");
    return {};
}

std::int64_t toFormatInteger(Format format, float value) {
    const FormatInfo& info = formatInfo(format);
    const int bits = 8 * info.bytes / info.channels;
    const std::int64_t largest = (std::int64_t{1} << (info.isSigned ? bits - 1 : bits)) - 1;
    const std::int64_t smallest = info.isSigned ? -largest - 1 : 0;
    if (std::isnan(value)) return 0;
    // Compared as doubles, which hold every 32-bit integer.
    const double clamped = std::clamp(double(value), double(smallest), double(largest));
    return static_cast<std::int64_t>(clamped);
}

} // namespace kestrel::gl
