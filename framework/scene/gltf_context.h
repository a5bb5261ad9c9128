// What the readers of the parts of a glTF file share.
#pragma once
#include "scene/gltf_accessor.h"
#include "scene/gltf_container.h"
#include "scene/scene.h"
#include <map>
#include <memory>
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace kestrel {

struct DracoMesh;

struct GltfContext {
    GltfFile& file;
    const tinygltf::Model& model; // without buffers and images
    AccessorReader& accessors;
    Scene& scene;
    std::vector<int> imageIndex{}; // the file's image to the scene's; -1 where it is not read
    int imageSide = 0;             // that all images are kept within
    std::uint64_t wantedPixels = 0, keptPixels = 0;         // of all images, and of those in the scene
    std::map<std::string, std::pair<int, int>> converted{}; // the images of specular-glossiness materials
    std::uint64_t storedBytes = 0;
    // The mesh that was decoded last: primitives that share one follow each other.
    std::shared_ptr<const DracoMesh> draco{};
    size_t dracoView = 0;

    [[noreturn]] void fail(const std::string& message) const { failGltf(file, message); }
    // To be called before `count` elements of `size` bytes are copied into the scene. Throws InputError where
    // the sum passes GltfLimits::storedBytes.
    void spend(std::uint64_t count, std::uint64_t size, const std::string& what);
    void warn(const std::string& message) { file.warnings.add(message); }
};

// Each reads one part into context.scene; the order is that of calling.
void readGltfImages(GltfContext& context);
void readGltfMaterials(GltfContext& context);
void readGltfMeshes(GltfContext& context);
void readGltfNodes(GltfContext& context); // with cameras and lights
void readGltfInstances(GltfContext& context);
void readGltfSkins(GltfContext& context);
void readGltfAnimations(GltfContext& context);

// An extension's value, or nullptr.
const tinygltf::Value* gltfExtension(const tinygltf::ExtensionMap& extensions, const char* name);
// A member of an object as number, or `otherwise`.
double gltfNumber(const tinygltf::Value& object, const char* name, double otherwise);

} // namespace kestrel
