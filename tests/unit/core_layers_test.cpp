// The order of the layers, read from the includes: a folder includes only itself and folders before it.
#include "core/files.h"
#include "support/folders.h"
#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <optional>
#include <sstream>

namespace kestrel {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> layers = {"core",   "image", "scene", "reference", "shader", "graph",
                                         "plugin", "gl",    "draw",  "execute",   "measure"};

struct Include {
    fs::path file;
    std::string target; // as written
    bool quoted = false;
};

// The include of a line, if it is one.
std::optional<Include> includeOf(const fs::path& file, std::string line) {
    std::erase(line, ' ');
    if (!line.starts_with("#include")) return {};
    const size_t begin = line.find_first_of("\"<");
    const size_t end = line.find_first_of("\">", begin + 1);
    if (begin == std::string::npos || end == std::string::npos) return {};
    return Include{file, line.substr(begin + 1, end - begin - 1), line[begin] == '"'};
}

std::vector<Include> includesUnder(const fs::path& folder) {
    std::vector<Include> found;
    if (!fs::exists(folder)) return found;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string ending = entry.path().extension();
        if (ending != ".h" && ending != ".cpp") continue;
        std::istringstream text(readText(entry.path()));
        for (std::string line; std::getline(text, line);)
            if (auto include = includeOf(entry.path(), line)) found.push_back(std::move(*include));
    }
    return found;
}

// The first folder of an include if it is one of the layers, else empty.
std::string layerOf(const std::string& target) {
    const std::string folder = target.substr(0, target.find('/'));
    const bool known = target.find('/') != std::string::npos &&
                       std::find(layers.begin(), layers.end(), folder) != layers.end();
    return known ? folder : std::string();
}

// Whether a quoted include is a file beside the includer.
bool isBeside(const Include& include) { return fs::exists(include.file.parent_path() / include.target); }

const fs::path root = test::sourceFolder();

TEST(Layers, AFolderIncludesOnlyFoldersBeforeIt) {
    size_t seen = 0;
    for (size_t i = 0; i < layers.size(); ++i) {
        const std::vector<std::string> allowed(layers.begin(),
                                               layers.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        for (const Include& include : includesUnder(root / "framework" / layers[i])) {
            const std::string layer = layerOf(include.target);
            if (layer.empty()) continue;
            ++seen;
            EXPECT_TRUE(std::find(allowed.begin(), allowed.end(), layer) != allowed.end())
                << include.file.lexically_relative(root) << " includes " << include.target;
        }
    }
    EXPECT_GT(seen, 50u);
}

TEST(Layers, EveryFolderOfTheFrameworkIsALayer) {
    for (const auto& entry : fs::directory_iterator(root / "framework")) {
        const std::string name = entry.path().filename();
        if (!entry.is_directory() || name == "cmake") continue;
        EXPECT_TRUE(std::find(layers.begin(), layers.end(), name) != layers.end()) << name;
    }
}

TEST(Layers, TheFrameworkIncludesItselfAndSharedShaderHeadersOnly) {
    for (const Include& include : includesUnder(root / "framework")) {
        if (!include.quoted || !layerOf(include.target).empty() || isBeside(include)) continue;
        const bool known = include.target.starts_with("shared/") || include.target == "kestrel_stamp.h";
        EXPECT_TRUE(known) << include.file.lexically_relative(root) << " includes " << include.target;
    }
}

TEST(Layers, APassIncludesTheFrameworkAndItsOwnFolderButNoOtherPass) {
    ASSERT_TRUE(fs::exists(root / "passes"));
    for (const auto& folder : fs::directory_iterator(root / "passes")) {
        if (!folder.is_directory()) continue;
        const std::string own = folder.path().filename();
        for (const Include& include : includesUnder(folder.path())) {
            if (!include.quoted) continue;
            const bool known = !layerOf(include.target).empty() || include.target.starts_with("shared/") ||
                               include.target.starts_with(own + "/") ||
                               (isBeside(include) && include.target.find("..") == std::string::npos);
            EXPECT_TRUE(known) << include.file.lexically_relative(root) << " includes " << include.target;
        }
    }
}

TEST(Layers, SharedShaderHeadersIncludeOnlyEachOther) {
    for (const Include& include : includesUnder(root / "shaders")) {
        if (!include.quoted) continue;
        EXPECT_TRUE(include.target.starts_with("shared/"))
            << include.file.lexically_relative(root) << " includes " << include.target;
    }
}

TEST(Layers, NothingIncludesAnApp) {
    for (const char* folder : {"framework", "passes", "shaders"})
        for (const Include& include : includesUnder(root / folder))
            EXPECT_FALSE(include.target.starts_with("apps/"))
                << include.file.lexically_relative(root) << " includes " << include.target;
}

} // namespace
} // namespace kestrel
