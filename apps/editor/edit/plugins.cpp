#include "edit/plugins.h"
#include "plugin/loader.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kestrel::edit {

Plugins::State Plugins::stateOf(const std::filesystem::path& library) {
    std::error_code failure;
    State state;
    state.bytes = std::filesystem::file_size(library, failure);
    if (failure) return {};
    state.time = std::filesystem::last_write_time(library, failure);
    return failure ? State() : state;
}

Plugins::Plugins(Registry& registry, const std::vector<std::filesystem::path>& folders)
    : registry_(registry) {
    std::error_code ignored;
    for (const std::filesystem::path& folder : folders)
        for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
            if (entry.path().extension() == ".so") loaded_[entry.path()] = stateOf(entry.path());
    seen_ = loaded_;
}

std::vector<std::string> Plugins::follow(bool& changed) {
    std::vector<std::string> told;
    for (auto& [library, loaded] : loaded_) {
        const State now = stateOf(library);
        const State before = std::exchange(seen_[library], now);
        // A file that went away is one that is being written.
        if (now == State() || now == loaded || now != before) continue;
        loaded = now;
        const PluginResult result = reloadPlugin(library, registry_);
        changed = changed || result.failure == PluginFailure::None;
        told.push_back(result.failure == PluginFailure::None
                           ? fmt::format("{} was built anew: {}", library.filename().string(),
                                         fmt::join(result.types, ", "))
                           : result.message);
    }
    return told;
}

} // namespace kestrel::edit
