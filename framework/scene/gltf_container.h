// The outer layers of a glTF file: GLB chunks, JSON, URIs, buffers.
#pragma once
#include "scene/gltf_import.h"
#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kestrel {

// What a file asks for and Kestrel lacks: each once, and no endless list.
class GltfWarnings {
public:
    void add(const std::string& message);
    [[nodiscard]] const std::vector<std::string>& list() const { return list_; }

private:
    std::vector<std::string> list_;
};

struct GltfFile {
    std::filesystem::path path;
    SceneOptions options;
    GltfLimits limits;
    nlohmann::json document;
    GltfWarnings warnings;
    std::map<size_t, std::string> unreadable;    // accessors that are of no kind that Kestrel knows, and why
    std::vector<std::byte> binary;               // the GLB's BIN chunk
    std::vector<std::vector<std::byte>> buffers; // filled by readBuffers()
    std::map<size_t, std::vector<std::byte>> views; // of compressed buffer views (gltf_views.h)
};

// Throws InputError that names the file.
[[noreturn]] void failGltf(const GltfFile& file, const std::string& message);

// Reads .gltf or .glb (told by the first bytes), up to the JSON document and the BIN chunk. Throws InputError
// for a bad GLB header or chunk and for text that is not JSON, nested too deep or of too many values.
GltfFile readGltfFile(const std::filesystem::path& path, const SceneOptions& options,
                      const GltfLimits& limits);

// Reads the buffers that the document (checked against its schema) lists. Throws InputError where data is
// shorter than stated, lies outside the folder or is larger than maxFileBytes in total.
void readBuffers(GltfFile& file);

// The bytes of a data URI (RFC 2397: percent-encoded, base64 or not) or of a file. `what` names the user in
// messages. Throws InputError for a file outside the folder of `file`, unless SceneOptions::allowOutside is
// set.
std::vector<std::byte> readUri(const GltfFile& file, const std::string& uri, const std::string& what);
// Why readUri() would refuse a URI for where it leads, as the tail of a sentence; empty if it would not.
std::string outsideFolder(const GltfFile& file, const std::string& uri);

} // namespace kestrel
