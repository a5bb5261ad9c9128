// Reading glTF 2.0 files (.gltf with its buffers and images, and .glb).
#pragma once
#include "scene/scene.h"
#include <cstdint>
#include <filesystem>

namespace kestrel {

// A stranger's file cannot make the program allocate without bound.
struct GltfLimits {
    std::uint64_t jsonValues = 4'000'000;          // and at most 64 levels deep
    std::uint64_t pixels = std::uint64_t{1} << 28; // of all images together: reduced where they have more
    std::uint64_t decodedPixels = std::uint64_t{1} << 32; // before they are reduced
    // Of all accessors as floats, each once, and of what Draco decompresses; again of all decompressed buffer
    // views.
    std::uint64_t decodedBytes = std::uint64_t{2} << 30;
    std::uint64_t storedBytes = std::uint64_t{2} << 30; // of meshes and animations, which may share accessors
    std::uint64_t joints = 4'000'000;                   // of all skinned nodes, which may share skins
    std::uint64_t instances =
        1'000'000; // of EXT_mesh_gpu_instancing: evenly thinned out where there are more
    std::uint64_t triangles = 64'000'000; // that instances may make, likewise
};

// Reads the file's default scene. finishScene() has not been called on the result. What the file asks for and
// Kestrel lacks is in Scene::warnings. Throws InputError (one line: the file, and which accessor, node, … is
// wrong) for everything that glTF 2.0 forbids and that would matter here: broken or truncated JSON and GLB,
// wrong types, indices out of range, data beyond its buffer, NaN and infinity, cycles and second parents in
// the node hierarchy, files outside the folder, required extensions that Kestrel lacks, sizes above the
// limits.
Scene importGltf(const std::filesystem::path& file, const SceneOptions& options = {},
                 const GltfLimits& limits = {});

} // namespace kestrel
