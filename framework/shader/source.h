// Where shader text comes from: an ordered list of folders, a cache of what was read, and virtual files for
// tests.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel {

// The stages that Kestrel uses, each known by the file's ending: .vert .geom .frag .comp.
enum class ShaderStage { Vertex, Geometry, Fragment, Compute };

// The stage of a shader file by its ending; nothing if the ending is none of the four.
std::optional<ShaderStage> shaderStageOf(std::string_view file);

// "vertex", "geometry", "fragment", "compute".
const char* shaderStageName(ShaderStage stage);

// Name -> text of preprocessor macros. An empty text stands for "1".
using Defines = std::map<std::string, std::string>;

// Finds and caches shader texts. A path is relative, with forward slashes ("lib/tracer.glsl"); the first
// folder that has it wins, and a virtual file wins over all folders. Not for use by two threads at once.
class ShaderLibrary {
public:
    explicit ShaderLibrary(std::vector<std::filesystem::path> folders = {});

    // Searched after the folders that are there already: a plugin cannot replace a file of the framework.
    void addFolder(std::filesystem::path folder);

    // A file that exists only here; replaces an earlier one of that path.
    void addVirtual(std::string path, std::string text);

    // The text of a file with line ends "\n". The reference holds until changed(), addFolder() or
    // addVirtual(). Throws InputError naming the path, the folders searched and a near name if there is no
    // such file.
    const std::string& text(const std::string& path);

    // The text, or null if there is no such file (missing() then says what to tell the user). Throws
    // InputError if the file is there and cannot be read.
    const std::string* find(const std::string& path);

    // The sentence about a path that is not there: the folders searched and the near name.
    [[nodiscard]] std::string missing(const std::string& path) const;

    // Drops each cached text whose file has changed (size or modification time, gone, or hidden by a file in
    // an earlier folder) since it was read, and says whether there was any. Hot reload calls it between
    // frames.
    bool changed();

    // The file on disk that a path stands for; nothing for virtual files and files that do not exist.
    [[nodiscard]] std::optional<std::filesystem::path> locate(const std::string& path) const;

    // Every path that can be included, sorted, each once.
    [[nodiscard]] std::vector<std::string> paths() const;

    [[nodiscard]] const std::vector<std::filesystem::path>& folders() const { return folders_; }

private:
    // What tells one state of a file from another without reading it.
    struct FileState {
        std::filesystem::path file;
        std::uintmax_t size = 0;
        std::filesystem::file_time_type modified;
        friend bool operator==(const FileState&, const FileState&) = default;
    };
    struct CachedText {
        FileState state;
        std::string text;
    };
    [[nodiscard]] std::optional<FileState> stateOf(const std::string& path) const;

    std::vector<std::filesystem::path> folders_;
    std::map<std::string, std::string> virtual_;
    std::map<std::string, CachedText> cache_;
    std::set<std::string> missed_; // paths that find() did not find
};

} // namespace kestrel
