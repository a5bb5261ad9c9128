// Loads plugins: shared libraries that add pass types to a registry. Nothing is ever unloaded, since a pass
// (its vtable, its exceptions on a stack) may outlive whoever asked for it.
#pragma once
#include "graph/registry.h"
#include <filesystem>
#include <string>
#include <vector>

namespace kestrel {

// The ways in which loading a plugin can fail.
enum class PluginFailure : std::uint8_t {
    None,
    NoFile,      // there is no such file
    NotLoadable, // not a shared library, or one of its symbols is missing
    NotAPlugin,  // a library without the functions that KESTREL_PLUGIN exports
    OtherStamp,  // built against other headers, by another compiler or with other flags
    Threw,       // its registration threw an exception, or registered something that is no pass type
    NameTaken    // a pass type of that name is there already
};

struct PluginResult {
    PluginFailure failure = PluginFailure::None;
    std::string message;            // one line that names the file and the way it failed; empty if it did not
    std::vector<std::string> types; // the names of the pass types that came in
};

// The stamp that a plugin must carry.
std::string abiStamp();

// Loads one plugin. On failure the registry is as it was. A folder `shaders` beside the library joins
// Registry::shaderFolders.
PluginResult loadPlugin(const std::filesystem::path& library, Registry& registry);

// Loads a plugin that was built anew since it was loaded, from a copy of its file. Its pass types take the
// place of those before (Registry::replace); a type that it no longer has stays as it was. The code before
// stays mapped, since passes made by it may live. On failure the registry is as it was.
PluginResult reloadPlugin(const std::filesystem::path& library, Registry& registry);

// Loads every *.so of the folders, by name. A bad plugin is skipped with a warning in the log, and so is a
// folder that does not exist. Returns the failures.
std::vector<PluginResult> loadPlugins(Registry& registry, const std::vector<std::filesystem::path>& folders);

} // namespace kestrel
