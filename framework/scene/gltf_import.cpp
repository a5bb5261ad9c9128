#include "scene/gltf_import.h"
#include "scene/gltf_context.h"
#include "scene/gltf_schema.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

constexpr std::array supportedExtensions{"KHR_lights_punctual",  "KHR_materials_emissive_strength",
                                         "KHR_materials_ior",    "KHR_materials_transmission",
                                         "KHR_materials_unlit",  "KHR_mesh_quantization",
                                         "KHR_texture_transform"};

bool isSupported(const std::string& extension) {
    return std::find(supportedExtensions.begin(), supportedExtensions.end(), extension) !=
           supportedExtensions.end();
}

// The names of all extensions that occur anywhere: files forget to list them in extensionsUsed.
void collectExtensions(const nlohmann::json& value, std::set<std::string>& names) {
    if (value.is_object()) {
        const auto extensions = value.find("extensions");
        if (extensions != value.end() && extensions->is_object())
            for (const auto& [name, content] : extensions->items()) names.insert(name);
    }
    for (const nlohmann::json& below : value)
        if (below.is_structured()) collectExtensions(below, names);
}

// An accessor without data reads as zeros: where a compression that Kestrel lacks holds the data, that would
// draw a heap of points at the origin.
void refusePrimitivesWithoutData(const GltfFile& file) {
    const auto meshes = file.document.find("meshes");
    if (meshes == file.document.end()) return;
    const auto hasData = [&](const nlohmann::json& index) {
        const nlohmann::json& accessor = file.document["accessors"][index.get<size_t>()];
        return accessor.contains("bufferView") || accessor.contains("sparse");
    };
    for (size_t m = 0; m < meshes->size(); ++m) {
        const nlohmann::json& primitives = (*meshes)[m]["primitives"];
        for (size_t p = 0; p < primitives.size(); ++p) {
            const nlohmann::json& primitive = primitives[p];
            const std::string what = fmt::format("meshes[{}].primitives[{}]", m, p);
            const bool compressed = primitive.contains("extensions") &&
                                    primitive["extensions"].contains("KHR_draco_mesh_compression");
            for (const auto& [name, accessor] : primitive["attributes"].items())
                if (compressed && !hasData(accessor))
                    failGltf(file,
                             what + " is stored by KHR_draco_mesh_compression alone, which Kestrel lacks");
            if (primitive.contains("indices") &&
                !file.document["accessors"][primitive["indices"].get<size_t>()].contains("bufferView"))
                failGltf(file, what + ".indices refers to an accessor without a buffer view");
        }
    }
}

// tinygltf fills its structures from the checked document. It gets neither buffers nor images, which are read
// here, within bounds; nor what it would copy into every sampler of an animation.
tinygltf::Model parseModel(const GltfFile& file) {
    nlohmann::json reduced = nlohmann::json::object();
    for (const auto& [name, value] : file.document.items())
        if (name != "buffers" && name != "images") reduced[name] = value;
    if (const auto animations = reduced.find("animations"); animations != reduced.end())
        for (nlohmann::json& animation : *animations) {
            animation.erase("extensions");
            animation.erase("extras");
        }
    const std::string text = reduced.dump();
    tinygltf::TinyGLTF parser;
    tinygltf::Model model;
    std::string errors, warnings;
    if (!parser.LoadASCIIFromString(&model, &errors, &warnings, text.data(),
                                    static_cast<unsigned int>(text.size()), "", 0)) {
        std::replace(errors.begin(), errors.end(), '\n', ' ');
        while (errors.ends_with(' ')) errors.pop_back();
        failGltf(file, errors.empty() ? "is not glTF" : errors);
    }
    return model;
}

} // namespace

void GltfContext::warn(const std::string& message) {
    constexpr size_t most = 100;
    if (scene.warnings.size() > most ||
        std::find(scene.warnings.begin(), scene.warnings.end(), message) != scene.warnings.end())
        return;
    scene.warnings.push_back(scene.warnings.size() < most ? message : "there are further warnings");
}

void GltfContext::spend(std::uint64_t count, std::uint64_t size, const std::string& what) {
    const std::uint64_t left = file.limits.storedBytes - storedBytes;
    if (count > left / size)
        fail(fmt::format("{}: the meshes and animations take more than {} bytes", what,
                         file.limits.storedBytes));
    storedBytes += count * size;
}

const tinygltf::Value* gltfExtension(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto found = extensions.find(name);
    return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

double gltfNumber(const tinygltf::Value& object, const char* name, double otherwise) {
    return object.Has(name) ? object.Get(name).GetNumberAsDouble() : otherwise;
}

void checkGltfExtensions(GltfContext& context) {
    std::string lacking;
    for (const std::string& name : context.model.extensionsRequired)
        if (!isSupported(name)) lacking += (lacking.empty() ? "" : ", ") + name;
    if (!lacking.empty()) context.fail("requires extensions that Kestrel lacks: " + lacking);
    std::set<std::string> used(context.model.extensionsUsed.begin(), context.model.extensionsUsed.end());
    collectExtensions(context.file.document, used);
    for (const std::string& name : used)
        if (!isSupported(name)) context.warn(fmt::format("the extension {} is ignored", name));
}

Scene importGltf(const std::filesystem::path& path, const GltfLimits& limits) {
    GltfFile file = readGltfFile(path, limits);
    checkGltfSchema(file);
    refusePrimitivesWithoutData(file);
    const tinygltf::Model model = parseModel(file);
    Scene scene;
    scene.name = path.filename().string();
    scene.source = path.string();
    AccessorReader accessors(file, model);
    GltfContext context{file, model, accessors, scene, {}, 0};
    checkGltfExtensions(context);
    readBuffers(file);
    readGltfImages(context);
    readGltfMaterials(context);
    readGltfMeshes(context);
    readGltfNodes(context);
    readGltfSkins(context);
    readGltfAnimations(context);
    return scene;
}

} // namespace kestrel
