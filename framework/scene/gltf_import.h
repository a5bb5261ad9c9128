// Reading glTF 2.0 files (.gltf with its buffers and images, and .glb).
#pragma once
#include "scene/scene.h"
#include <cstdint>
#include <filesystem>

namespace kestrel {

// A stranger's file cannot make the program allocate without bound.
inline constexpr std::uint64_t maxGltfPixels = std::uint64_t{1} << 28;       // of all images together
inline constexpr std::uint64_t maxGltfDecodedBytes = std::uint64_t{2} << 30; // of all accessors as floats
inline constexpr std::uint64_t maxGltfJsonValues = 4'000'000;                // and at most 64 levels deep

// Reads the file's default scene. finishScene() has not been called on the result. What the file asks for and
// Kestrel lacks is in Scene::warnings. Throws InputError (one line: the file, and which accessor, node, … is
// wrong) for everything that glTF 2.0 forbids and that would matter here: broken or truncated JSON and GLB,
// wrong types, indices out of range, data beyond its buffer, NaN and infinity, cycles and second parents in
// the node hierarchy, files outside the folder, required extensions that Kestrel lacks, sizes above the
// limits.
Scene importGltf(const std::filesystem::path& file);

} // namespace kestrel
