// Real scenes that tests use where they are: $KESTREL_ASSETS, or shared/assets beside the source tree.
#pragma once
#include "support/folders.h"
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

namespace kestrel::test {

// The folder of the real scenes; empty if there is none.
inline std::filesystem::path assetsFolder() {
    const char* named = std::getenv("KESTREL_ASSETS");
    const std::filesystem::path folder = named ? named : test::sourceFolder() / ".." / "shared" / "assets";
    std::error_code failure;
    return std::filesystem::is_directory(folder, failure) ? std::filesystem::canonical(folder)
                                                          : std::filesystem::path();
}

// All .gltf and .glb files below `folder`, sorted; none if it does not exist.
inline std::vector<std::filesystem::path> gltfFilesBelow(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code failure;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, failure))
        if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

} // namespace kestrel::test
