#include "shader/source.h"
#include "core/error.h"
#include "core/files.h"
#include <algorithm>
#include <fmt/format.h>

namespace fs = std::filesystem;

namespace kestrel {
namespace {

// No shader comes near this; a larger file is a mistake.
constexpr std::uintmax_t maxShaderBytes = 4u << 20;

bool isLibraryPath(const std::string& path) {
    const fs::path relative(path);
    if (path.empty() || relative.is_absolute()) return false;
    return std::none_of(relative.begin(), relative.end(), [](const fs::path& part) { return part == ".."; });
}

std::string withUnixLineEnds(std::string text) {
    std::string result;
    result.reserve(text.size());
    for (size_t i = 0; i < text.size(); ++i) {
        const bool beforeNewline = i + 1 < text.size() && text[i + 1] == '\n';
        if (text[i] == '\r' && beforeNewline) continue;
        result += text[i];
    }
    return result;
}

} // namespace

std::optional<ShaderStage> shaderStageOf(std::string_view file) {
    if (file.ends_with(".vert")) return ShaderStage::Vertex;
    if (file.ends_with(".geom")) return ShaderStage::Geometry;
    if (file.ends_with(".frag")) return ShaderStage::Fragment;
    if (file.ends_with(".comp")) return ShaderStage::Compute;
    return std::nullopt;
}

const char* shaderStageName(ShaderStage stage) {
    switch (stage) {
    case ShaderStage::Vertex:
        return "vertex";
    case ShaderStage::Geometry:
        return "geometry";
    case ShaderStage::Fragment:
        return "fragment";
    case ShaderStage::Compute:
        break;
    }
    return "compute";
}

ShaderLibrary::ShaderLibrary(std::vector<fs::path> folders)
    : folders_(std::move(folders)) {}

void ShaderLibrary::addFolder(fs::path folder) {
    if (std::find(folders_.begin(), folders_.end(), folder) == folders_.end())
        folders_.push_back(std::move(folder));
}

void ShaderLibrary::addVirtual(std::string path, std::string text) {
    cache_.erase(path);
    missed_.erase(path);
    virtual_[std::move(path)] = withUnixLineEnds(std::move(text));
}

std::optional<ShaderLibrary::FileState> ShaderLibrary::stateOf(const std::string& path) const {
    if (!isLibraryPath(path)) return std::nullopt;
    for (const fs::path& folder : folders_) {
        const fs::path file = folder / path;
        std::error_code failure;
        if (!fs::is_regular_file(file, failure)) continue;
        FileState state{file, fs::file_size(file, failure), fs::last_write_time(file, failure)};
        if (!failure) return state;
    }
    return std::nullopt;
}

std::optional<fs::path> ShaderLibrary::locate(const std::string& path) const {
    if (virtual_.contains(path)) return std::nullopt;
    const std::optional<FileState> state = stateOf(path);
    if (!state) return std::nullopt;
    return state->file;
}

const std::string* ShaderLibrary::find(const std::string& path) {
    if (const auto known = virtual_.find(path); known != virtual_.end()) return &known->second;
    if (const auto known = cache_.find(path); known != cache_.end()) return &known->second.text;
    // The state is taken before the text: a write in between shows as a change.
    const std::optional<FileState> state = stateOf(path);
    if (!state) {
        missed_.insert(path);
        return nullptr;
    }
    missed_.erase(path);
    std::string text = withUnixLineEnds(readText(state->file, maxShaderBytes));
    return &cache_.insert_or_assign(path, CachedText{*state, std::move(text)}).first->second.text;
}

const std::string& ShaderLibrary::text(const std::string& path) {
    const std::string* found = find(path);
    if (!found) throw InputError(missing(path));
    return *found;
}

std::string ShaderLibrary::missing(const std::string& path) const {
    if (!isLibraryPath(path))
        return fmt::format("'{}' is not a path inside a shader folder (it is absolute or has '..')", path);
    std::string searched;
    for (const fs::path& folder : folders_) searched += (searched.empty() ? "" : ", ") + folder.string();
    return fmt::format("no shader file '{}'{}; searched {}", path, didYouMean(path, paths()),
                       searched.empty() ? "no folder" : searched);
}

bool ShaderLibrary::changed() {
    const size_t dropped = std::erase_if(cache_, [this](const auto& entry) {
        const std::optional<FileState> now = stateOf(entry.first);
        return !now || !(*now == entry.second.state);
    });
    const size_t appeared =
        std::erase_if(missed_, [this](const std::string& path) { return stateOf(path).has_value(); });
    return dropped + appeared > 0;
}

std::vector<std::string> ShaderLibrary::paths() const {
    std::set<std::string> found;
    for (const auto& [path, text] : virtual_) found.insert(path);
    for (const fs::path& folder : folders_) {
        std::error_code failure;
        for (fs::recursive_directory_iterator it(folder, failure), end; !failure && it != end;
             it.increment(failure)) {
            if (it->is_regular_file()) found.insert(it->path().lexically_relative(folder).generic_string());
        }
    }
    return {found.begin(), found.end()};
}

} // namespace kestrel
