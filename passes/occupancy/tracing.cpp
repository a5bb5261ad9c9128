#include "tracing.h"
#include "grid.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace kestrel {
Format columnFormat(int words) {
    if (words == 1) return Format::R32UI;
    return words == 2 ? Format::RG32UI : Format::RGBA32UI;
}

Defines columnDefines(int resolution) {
    const int words = resolution / 32;
    const Format format = columnFormat(words);
    constexpr std::array types = {"uint", "uint", "uvec2", "", "uvec4"};
    constexpr std::array parts = {"x", "x", "xy", "", "xyzw"};
    const auto channels = static_cast<size_t>(formatInfo(format).channels);
    return {{"RESOLUTION", std::to_string(resolution)},
            {"WORDS", std::to_string(words)},
            {"COLUMN_FORMAT", std::string(formatInfo(format).name)},
            {"COLUMN_TYPE", types.at(channels)},
            {"COLUMN_PART", parts.at(channels)}};
}

bool fitsTexels(const Desc& buffer, const Capabilities& capabilities) {
    const auto texels = buffer.bytes / static_cast<std::uint64_t>(formatInfo(buffer.format).bytes);
    return texels <= static_cast<std::uint64_t>(capabilities.maxTextureBufferTexels);
}

std::optional<int> mapResolution(const Inputs& inputs, Declaration& declaration) {
    const Desc& map = inputs["occupancy"].desc;
    const std::optional<int> resolution = occupancyResolution(map);
    if (!resolution)
        declaration.problems.push_back(
            {"occupancy",
             fmt::format("is no occupancy map of 32, 64, 128 or 256 cells an edge: {}", describe(map))});
    return resolution;
}
} // namespace kestrel
