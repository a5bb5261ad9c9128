// Writing a scene as glTF 2.0 binary (.glb).
#pragma once
#include "scene/scene.h"
#include <cstddef>
#include <filesystem>
#include <vector>

namespace kestrel {

// Writes everything that a Scene holds, with images as PNG inside the file: loading it gives an equal scene,
// geometry, transforms and animations to the bit. Area lights, which glTF lacks, go into the extras of their
// node ("KESTREL_area_light"); other programs ignore them. What differs after loading: a rootTransform other
// than the identity comes back as a node above the roots; a camera or light without a node gets one; unnamed
// cameras get names; images and materials keep their order, but primitives without triangles, which glTF
// forbids, and cameras and lights outside the scene's roots do not come back.
// Throws InputError where the file cannot be written or would pass 4 GiB.
void exportScene(const Scene& scene, const std::filesystem::path& file);

// The bytes of that file. The same scene gives the same bytes.
std::vector<std::byte> exportedGlb(const Scene& scene);

} // namespace kestrel
