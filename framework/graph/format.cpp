#include "graph/format.h"
#include "core/check.h"
#include <array>

namespace kestrel {
namespace {

constexpr std::array<FormatInfo, static_cast<size_t>(Format::Count)> formats = {{
    {"none", 0, 0, false, false, false},
    {"r8", 1, 1, false, false, false},
    {"rg8", 2, 2, false, false, false},
    {"rgba8", 4, 4, false, false, false},
    {"r16f", 1, 2, false, false, false},
    {"rg16f", 2, 4, false, false, false},
    {"rgba16f", 4, 8, false, false, false},
    {"r32f", 1, 4, false, false, false},
    {"rg32f", 2, 8, false, false, false},
    {"rgba32f", 4, 16, false, false, false},
    {"r8ui", 1, 1, true, false, false},
    {"r16ui", 1, 2, true, false, false},
    {"r32ui", 1, 4, true, false, false},
    {"rg32ui", 2, 8, true, false, false},
    {"rgba32ui", 4, 16, true, false, false},
    {"r32i", 1, 4, true, true, false},
    {"d32f", 1, 4, false, false, true},
}};

} // namespace

const FormatInfo& formatInfo(Format format) {
    KESTREL_CHECK_LT(static_cast<size_t>(format), formats.size());
    return formats[static_cast<size_t>(format)];
}

} // namespace kestrel
