#include "core/error.h"
#include "scene/builtin.h"
#include "scene/gltf_import.h"
#include "scene/scene.h"
#include "scene/setup.h"
#include <algorithm>
#include <cctype>
#include <vector>

namespace kestrel {
namespace {

[[noreturn]] void failUnknown(const std::string& source) {
    std::vector<std::string> names;
    for (const std::string& name : builtinNames()) names.push_back("builtin:" + name);
    throw InputError(Location{source},
                     "is no scene: name a .gltf or .glb file, or a built-in scene as builtin:NAME" +
                         didYouMean(source.find(':') == source.npos ? "builtin:" + source : source, names));
}

} // namespace

Scene loadScene(const std::string& source, const std::filesystem::path& folder, const SceneOptions& options) {
    return loadScene(source, folder, options, {});
}

Scene loadScene(const std::string& source, const std::filesystem::path& folder, const SceneOptions& options,
                const SceneSetup& setup) {
    Scene scene;
    if (isBuiltin(source)) {
        scene = builtinScene(source);
    } else {
        const std::filesystem::path path = folder / source;
        std::string ending = path.extension().string();
        std::transform(ending.begin(), ending.end(), ending.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        if (ending != ".gltf" && ending != ".glb") failUnknown(source);
        scene = importGltf(path, options);
    }
    // That of a file says where it was found: what is named beside the scene lies there.
    if (isBuiltin(source)) scene.source = source;
    setUpScene(scene, setup, folder);
    return scene;
}

} // namespace kestrel
