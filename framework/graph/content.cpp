#include "graph/content.h"
#include <array>
#include <fmt/format.h>

namespace kestrel {

std::string_view spaceName(Space space) {
    constexpr std::array<std::string_view, 6> names = {"any",    "device", "view",
                                                       "render", "screen", "display"};
    return names.at(static_cast<size_t>(space));
}

std::string contentMistake(const Content& given, const Content& taken) {
    if (!taken.structure.empty() && given.structure != taken.structure)
        return given.structure.empty() ? fmt::format("no {} elements", taken.structure)
                                       : fmt::format("{} elements, not {}", given.structure, taken.structure);
    if (given.channels > 0 && given.channels < taken.channels)
        return fmt::format("{} of the {} channels that are read", given.channels, taken.channels);
    if (given.space != Space::Any && taken.space != Space::Any && given.space != taken.space)
        return fmt::format("values of {} space, not of {} space", spaceName(given.space),
                           spaceName(taken.space));
    return {};
}

std::string describe(const Content& content) {
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (!content.structure.empty()) add(content.structure + " elements");
    if (content.channels > 0)
        add(fmt::format("{} channel{}", content.channels, content.channels == 1 ? "" : "s"));
    if (content.space != Space::Any) add(fmt::format("{} space", spaceName(content.space)));
    return text;
}

} // namespace kestrel
