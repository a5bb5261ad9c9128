#include "plugin/loader.h"
#include "core/error.h"
#include "core/log.h"
#include "plugin/plugin.h"
#include <algorithm>
#include <atomic>
#include <dlfcn.h>
#include <exception>
#include <unistd.h>

namespace fs = std::filesystem;

namespace kestrel {
namespace {

PluginResult failed(const fs::path& library, PluginFailure failure, const std::string& why) {
    std::string message = fmt::format("plugin {} is skipped: {}", library.string(), why);
    std::replace(message.begin(), message.end(), '\n', ' ');
    return {failure, std::move(message), {}};
}

std::string lastError() {
    const char* text = dlerror();
    return text == nullptr ? "no reason given" : text;
}

// Runs the plugin's registration on a registry of its own. Empty if it went well.
std::string registerInto(Registry& fresh, void (*registerTypes)(Registry*)) {
    try {
        registerTypes(&fresh);
        return {};
    } catch (const std::exception& error) {
        return error.what();
    } catch (...) {
        return "an exception of unknown kind";
    }
}

void addFolder(Registry& registry, const fs::path& folder) {
    auto& folders = registry.shaderFolders;
    if (std::find(folders.begin(), folders.end(), folder) == folders.end()) folders.push_back(folder);
}

// Opens a library and lets it register into `fresh`; `path` is what messages name.
PluginResult readPlugin(const fs::path& file, const fs::path& path, Registry& fresh) {
    void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr)
        return failed(path, PluginFailure::NotLoadable, "it does not load: " + lastError());
    const auto stamp = reinterpret_cast<const char* (*)()>(dlsym(handle, "kestrelPluginStamp"));
    const auto registerTypes = reinterpret_cast<void (*)(Registry*)>(dlsym(handle, "kestrelPluginRegister"));
    if (stamp == nullptr || registerTypes == nullptr)
        return failed(path, PluginFailure::NotAPlugin,
                      "it is not a Kestrel plugin (it has no KESTREL_PLUGIN block)");
    if (stamp() != abiStamp())
        return failed(path, PluginFailure::OtherStamp,
                      fmt::format("it was built for another Kestrel: its stamp is [{}], this one's is [{}]; "
                                  "build it again",
                                  stamp(), abiStamp()));
    if (const std::string why = registerInto(fresh, registerTypes); !why.empty())
        return failed(path, PluginFailure::Threw, "its registration failed: " + why);
    return {};
}

// Puts what came into the registry. Types of the same library are replaced if `again`.
PluginResult takeTypes(const Registry& fresh, const fs::path& path, bool again, Registry& registry) {
    const std::string library = path.filename().string();
    PluginResult result;
    for (const PassType& type : fresh.types()) {
        const PassType* taken = registry.find(type.name);
        if (taken != nullptr && !(again && taken->plugin == library))
            return failed(path, PluginFailure::NameTaken,
                          fmt::format("the name of its pass type '{}' is taken by {}", type.name,
                                      taken->plugin.empty() ? "Kestrel itself" : taken->plugin));
        result.types.push_back(type.name);
    }
    for (PassType type : fresh.types()) {
        type.plugin = library;
        registry.replace(std::move(type));
    }
    for (const fs::path& folder : fresh.shaderFolders) addFolder(registry, folder);
    std::error_code failure;
    if (const fs::path shaders = path.parent_path() / "shaders"; fs::is_directory(shaders, failure))
        addFolder(registry, shaders);
    return result;
}

} // namespace

std::string abiStamp() { return KESTREL_ABI_STAMP; }

PluginResult loadPlugin(const fs::path& library, Registry& registry) {
    std::error_code failure;
    const fs::path path = fs::absolute(library, failure);
    if (!fs::is_regular_file(path, failure)) return failed(path, PluginFailure::NoFile, "no such file");
    Registry fresh;
    PluginResult result = readPlugin(path, path, fresh);
    return result.failure == PluginFailure::None ? takeTypes(fresh, path, false, registry) : result;
}

PluginResult reloadPlugin(const fs::path& library, Registry& registry) {
    std::error_code failure;
    const fs::path path = fs::absolute(library, failure);
    if (!fs::is_regular_file(path, failure)) return failed(path, PluginFailure::NoFile, "no such file");
    // The loader knows a library by its file: a copy is another one. It lies beside, for $ORIGIN.
    static std::atomic<int> copies{0};
    const fs::path copy =
        path.parent_path() / fmt::format(".{}.{}.{}", path.filename().string(), ::getpid(), ++copies);
    fs::copy_file(path, copy, fs::copy_options::overwrite_existing, failure);
    if (failure)
        return failed(path, PluginFailure::NoFile, "it cannot be copied beside itself: " + failure.message());
    Registry fresh;
    PluginResult result = readPlugin(copy, path, fresh);
    fs::remove(copy, failure); // what is mapped stays
    return result.failure == PluginFailure::None ? takeTypes(fresh, path, true, registry) : result;
}

std::vector<PluginResult> loadPlugins(Registry& registry, const std::vector<fs::path>& folders) {
    std::vector<PluginResult> failures;
    for (const fs::path& folder : folders) {
        std::vector<fs::path> libraries;
        std::error_code failure;
        for (const auto& entry : fs::directory_iterator(folder, failure))
            if (entry.path().extension() == ".so") libraries.push_back(entry.path());
        if (failure) {
            failures.push_back(
                failed(folder, PluginFailure::NoFile, "the folder cannot be read: " + failure.message()));
            logWarning("{}", failures.back().message);
        }
        std::sort(libraries.begin(), libraries.end());
        for (const fs::path& library : libraries) {
            PluginResult result = loadPlugin(library, registry);
            if (result.failure == PluginFailure::None) continue;
            logWarning("{}", result.message);
            failures.push_back(std::move(result));
        }
    }
    return failures;
}

} // namespace kestrel
