#include "scene/gltf_import.h"
#include "scene/gltf_additions.h"
#include "scene/gltf_context.h"
#include "scene/gltf_draco.h"
#include "scene/gltf_image.h"
#include "scene/gltf_schema.h"
#include "scene/gltf_views.h"
#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <string_view>

namespace kestrel {
namespace {

bool isSupported(const std::string& extension) {
    constexpr std::string_view always[] = {"EXT_mesh_gpu_instancing",
                                           "KHR_lights_punctual",
                                           "KHR_materials_emissive_strength",
                                           "KHR_materials_ior",
                                           "KHR_materials_pbrSpecularGlossiness",
                                           "KHR_materials_transmission",
                                           "KHR_materials_unlit",
                                           "KHR_mesh_quantization",
                                           "KHR_texture_transform"};
    if (std::find(std::begin(always), std::end(always), extension) != std::end(always)) return true;
    if (extension == "KHR_draco_mesh_compression") return hasDraco();
    if (extension == "EXT_meshopt_compression" || extension == "KHR_meshopt_compression") return hasMeshopt();
    return extension == "EXT_texture_webp" && hasWebp();
}

// What to do about an extension that is required and lacks; empty where there is nothing to say.
std::string remedy(const std::string& extension) {
    if (extension == "KHR_texture_basisu")
        return " (no decoder is packaged: store the textures as PNG, JPEG or WebP)";
    if (extension == "KHR_draco_mesh_compression") return " (this build lacks libdraco-dev)";
    if (extension.ends_with("_meshopt_compression")) return " (this build lacks libmeshoptimizer-dev)";
    return extension == "EXT_texture_webp" ? " (this build lacks libwebp-dev)" : "";
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

// The strings of the array `name` at the top level of a document that may be wrong anywhere.
std::vector<std::string> stringsOf(const nlohmann::json& document, const char* name) {
    std::vector<std::string> strings;
    const auto array = document.find(name);
    if (array == document.end() || !array->is_array()) return strings;
    for (const nlohmann::json& one : *array)
        if (one.is_string()) strings.push_back(one.get<std::string>());
    return strings;
}

// Comes before everything else: what an unknown extension that is required makes of the rest, nobody knows.
void checkExtensions(GltfFile& file) {
    std::string lacking;
    for (const std::string& name : stringsOf(file.document, "extensionsRequired"))
        if (!isSupported(name)) lacking += (lacking.empty() ? "" : ", ") + name + remedy(name);
    if (!lacking.empty()) failGltf(file, "requires extensions that Kestrel lacks: " + lacking);
    const std::vector<std::string> listed = stringsOf(file.document, "extensionsUsed");
    std::set<std::string> used(listed.begin(), listed.end());
    collectExtensions(file.document, used);
    for (const std::string& name : used)
        if (!isSupported(name)) file.warnings.add(fmt::format("the extension {} is ignored", name));
}

// An accessor without data reads as zeros: where a compression that this build lacks holds the data, that
// would draw a heap of points at the origin.
void refuseCompressedPrimitives(const GltfFile& file) {
    const auto meshes = file.document.find("meshes");
    if (hasDraco() || meshes == file.document.end()) return;
    for (size_t m = 0; m < meshes->size(); ++m) {
        const nlohmann::json& primitives = (*meshes)[m]["primitives"];
        for (size_t p = 0; p < primitives.size(); ++p) {
            const nlohmann::json& primitive = primitives[p];
            if (!primitive.contains("extensions") ||
                !primitive["extensions"].contains("KHR_draco_mesh_compression"))
                continue;
            for (const auto& [name, index] : primitive["attributes"].items()) {
                const nlohmann::json& accessor = file.document["accessors"][index.get<size_t>()];
                if (!accessor.contains("bufferView") && !accessor.contains("sparse"))
                    failGltf(file,
                             fmt::format("meshes[{}].primitives[{}] is stored by KHR_draco_mesh_compression "
                                         "alone, which this build lacks (libdraco-dev)",
                                         m, p));
            }
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
    // It insists on a buffer view for indices, which the document need not give: PrimitiveReader reads these.
    if (const auto meshes = reduced.find("meshes"); meshes != reduced.end())
        for (nlohmann::json& mesh : *meshes)
            for (nlohmann::json& primitive : mesh["primitives"]) primitive.erase("indices");
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

Scene importGltf(const std::filesystem::path& path, const SceneOptions& options, const GltfLimits& limits) {
    GltfFile file = readGltfFile(path, options, limits);
    checkExtensions(file);
    setAsideAdditions(file);
    checkGltfSchema(file);
    refuseCompressedPrimitives(file);
    const tinygltf::Model model = parseModel(file);
    Scene scene;
    scene.name = path.filename().string();
    scene.source = path.string();
    AccessorReader accessors(file, model);
    GltfContext context{file, model, accessors, scene};
    readBuffers(file);
    decodeMeshoptViews(file);
    readGltfImages(context);
    readGltfMaterials(context);
    readGltfMeshes(context);
    readGltfNodes(context);
    readGltfInstances(context);
    readGltfSkins(context);
    readGltfAnimations(context);
    scene.warnings = file.warnings.list();
    return scene;
}

} // namespace kestrel
