// Plugins that are built anew while the editor is open.
#pragma once
#include "graph/registry.h"
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kestrel::edit {

class Plugins {
public:
    // Watches the libraries that lie in the folders now. The registry must outlive this.
    Plugins(Registry& registry, const std::vector<std::filesystem::path>& folders);

    // Loads those that changed and have stood still since the last call, so that no half file is read. A
    // sentence each, good or bad; `changed` becomes true where pass types are others now.
    std::vector<std::string> follow(bool& changed);

private:
    struct State {
        std::filesystem::file_time_type time{};
        std::uintmax_t bytes = 0;
        friend bool operator==(const State&, const State&) = default;
    };
    static State stateOf(const std::filesystem::path& library);

    Registry& registry_;
    std::map<std::filesystem::path, State> loaded_, seen_;
};

} // namespace kestrel::edit
