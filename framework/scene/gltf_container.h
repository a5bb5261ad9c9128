// The outer layers of a glTF file: GLB chunks, JSON, URIs, buffers.
#pragma once
#include "scene/gltf_import.h"
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kestrel {

struct GltfFile {
    std::filesystem::path path;
    GltfLimits limits;
    nlohmann::json document;
    std::vector<std::byte> binary;               // the GLB's BIN chunk
    std::vector<std::vector<std::byte>> buffers; // filled by readBuffers()
};

// Throws InputError that names the file.
[[noreturn]] void failGltf(const GltfFile& file, const std::string& message);

// Reads .gltf or .glb (told by the first bytes), up to the JSON document and the BIN chunk. Throws InputError
// for a bad GLB header or chunk and for text that is not JSON, nested too deep or of too many values.
GltfFile readGltfFile(const std::filesystem::path& path, const GltfLimits& limits);

// Reads the buffers that the document (checked against its schema) lists. Throws InputError where data is
// shorter than stated, lies outside the folder or is larger than maxFileBytes in total.
void readBuffers(GltfFile& file);

// The bytes of a data URI or of a file inside the folder of `file`. `what` names the user in messages.
std::vector<std::byte> readUri(const GltfFile& file, const std::string& uri, const std::string& what);

} // namespace kestrel
