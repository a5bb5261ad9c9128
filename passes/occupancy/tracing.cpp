#include "tracing.h"
#include "core/check.h"
#include "execute/commands.h"
#include "grid.h"
#include <algorithm>
#include <array>
#include <cstring>
#include <fmt/format.h>

namespace kestrel {
namespace {

// The storage block `Exhausted`.
struct ExhaustedRays {
    std::uint32_t rays = 0, exhausted = 0;
    std::uint32_t begun = 0x52414d45; // tells a buffer that counting began with from one that is new
};

} // namespace

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

namespace exhaustion {

void declare(Declaration& declaration, Module& tracer, Step& clears) {
    tracer.defines["COUNT_EXHAUSTED"] = "1";
    tracer.uses.push_back({.port = "exhausted", .access = Access::Storage, .write = true});
    declaration.outputs.push_back(
        {.port = "exhausted", .desc = Desc::buffer(sizeof(ExhaustedRays)), .keeps = true});
    clears.uses.push_back({.port = "exhausted", .access = Access::Copy, .write = true});
    declaration.steps.insert(
        declaration.steps.begin(),
        {.name = "report", .run = report, .uses = {{.port = "exhausted", .access = Access::Host}}});
    declaration.always = true;
}

void clear(Commands& commands) { commands.uploadValue("exhausted", ExhaustedRays{}); }

// What consumers counted since the pass last ran: in the last frame.
void report(Commands& commands) {
    const std::vector<std::byte> bytes = commands.download("exhausted");
    ExhaustedRays counted;
    KESTREL_CHECK_EQ(bytes.size(), sizeof(counted));
    std::memcpy(&counted, bytes.data(), sizeof(counted));
    if (counted.begun != ExhaustedRays{}.begun) return; // a new buffer
    commands.report("rays", counted.rays);
    commands.report("exhausted rays", counted.exhausted);
}

} // namespace exhaustion
} // namespace kestrel
