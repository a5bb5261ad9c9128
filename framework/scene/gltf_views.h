// Buffer views of a glTF file, compressed ones too.
#pragma once
#include "scene/gltf_container.h"
#include <span>

namespace kestrel {

// The bytes of a buffer view. Throws InputError where it lies beyond its buffer.
std::span<const std::byte> gltfView(const GltfFile& file, size_t index);

// Whether this build reads EXT_meshopt_compression and KHR_meshopt_compression.
bool hasMeshopt();
// Whether a buffer only stands in for what compressed views hold: it need not be read.
bool isFallbackBuffer(const nlohmann::json& buffer);
// Decompresses the views that are compressed by them, into GltfFile::views. Throws InputError for broken
// streams and beyond GltfLimits::decodedBytes in total.
void decodeMeshoptViews(GltfFile& file);

} // namespace kestrel
