// Images and textures of a glTF file.
#pragma once
#include "scene/material.h"
#include <string>

namespace tinygltf {
struct TextureInfo;
}

namespace kestrel {

struct GltfContext;

// Whether this build reads WebP (EXT_texture_webp).
bool hasWebp();

// Adds an image to the scene and gives its index there. Keeps all images within GltfLimits::pixels: where
// they have more, the largest are halved until they do not, also those that are there already.
int keepGltfImage(GltfContext& context, TextureImage image);

// Says so if keepGltfImage() has halved images.
void warnOfReducedImages(GltfContext& context);

// The image (index in the file) that a texture shows: that of an extension that this build reads, else its
// own; -1: none that can be read.
int gltfTextureSource(const GltfContext& context, size_t texture);

} // namespace kestrel
