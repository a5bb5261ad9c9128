#include "named.h"
#include "core/files.h"
#include "plugin/loader.h"
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fmt/format.h>
#include <system_error>
#include <vector>

namespace kestrel {

std::filesystem::path graphFile(const std::string& graph) {
    std::error_code ignored;
    if (isStream(graph) || std::filesystem::exists(graph, ignored)) return graph;
    const std::filesystem::path shipped = shareFolder() / "graphs";
    if (std::filesystem::is_regular_file(shipped / graph, ignored)) return shipped / graph;
    std::vector<std::string> names;
    for (const std::filesystem::path& place : {std::filesystem::path("."), shipped})
        for (const auto& entry : std::filesystem::directory_iterator(place, ignored))
            if (entry.path().extension() == ".json") names.push_back(entry.path().filename().string());
    throw InputError(Location{graph},
                     "no such file, and no graph of that name comes with Kestrel" + didYouMean(graph, names));
}

Extent parseSize(const std::string& text) {
    const auto side = [](const char* begin, const char* end) -> std::uint32_t {
        std::uint32_t value = 0;
        const auto [rest, failure] = std::from_chars(begin, end, value);
        return failure == std::errc() && rest == end && value <= 16384 ? value : 0;
    };
    const size_t cross = text.find('x');
    const char* begin = text.data();
    const char* end = begin + text.size();
    const Extent size{cross == std::string::npos ? 0 : side(begin, begin + cross),
                      cross == std::string::npos ? 0 : side(begin + cross + 1, end), 1};
    if (size.width == 0 || size.height == 0)
        throw InputError(fmt::format("--size {}: it must be WIDTHxHEIGHT with 1 to 16384 each", text));
    return size;
}

Registry& loadedRegistry() {
    static Registry registry = [] {
        Registry loaded;
        loadPlugins(loaded, pluginFolders());
        return loaded;
    }();
    return registry;
}

std::vector<std::string> absentPlugins() {
    std::vector<std::string> absent;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(shareFolder() / "shaders", ignored)) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_directory(ignored) || name == "lib" || name == "shared") continue;
        if (std::ranges::none_of(pluginFolders(), [&](const std::filesystem::path& folder) {
                return std::filesystem::exists(folder / (name + ".so"), ignored);
            }))
            absent.push_back(name);
    }
    std::ranges::sort(absent);
    return absent;
}

} // namespace kestrel
