// What the readers of the parts of a glTF file share.
#pragma once
#include "scene/gltf_accessor.h"
#include "scene/gltf_container.h"
#include "scene/scene.h"
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace kestrel {

struct GltfContext {
    const GltfFile& file;
    const tinygltf::Model& model; // without buffers and images
    AccessorReader& accessors;
    Scene& scene;
    std::vector<int> imageIndex; // the file's image to the scene's; -1 where Kestrel cannot read its format
    std::uint64_t storedBytes = 0;

    [[noreturn]] void fail(const std::string& message) const { failGltf(file, message); }
    // To be called before `count` elements of `size` bytes are copied into the scene. Throws InputError where
    // the sum passes GltfLimits::storedBytes.
    void spend(std::uint64_t count, std::uint64_t size, const std::string& what);
    // Adds to Scene::warnings unless it is there already; says so once when there are too many to be read.
    void warn(const std::string& message);
};

// Each reads one part into context.scene; the order is that of calling.
void checkGltfExtensions(GltfContext& context);
void readGltfImages(GltfContext& context);
void readGltfMaterials(GltfContext& context);
void readGltfMeshes(GltfContext& context);
void readGltfNodes(GltfContext& context); // with cameras and lights
void readGltfSkins(GltfContext& context);
void readGltfAnimations(GltfContext& context);

// An extension's value, or nullptr.
const tinygltf::Value* gltfExtension(const tinygltf::ExtensionMap& extensions, const char* name);
// A member of an object as number, or `otherwise`.
double gltfNumber(const tinygltf::Value& object, const char* name, double otherwise);

} // namespace kestrel
