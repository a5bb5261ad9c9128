// KHR_draco_mesh_compression: primitives whose attributes and indices are stored together, compressed.
#pragma once
#include "scene/gltf_accessor.h"
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace kestrel {

// What takes the place of an accessor's data: elements without gaps.
struct DracoMesh {
    std::vector<std::uint32_t> indices;               // 3 a triangle
    std::map<std::uint32_t, AccessorData> attributes; // by Draco's unique id
};

// Whether this build reads the extension.
bool hasDraco();

// Decodes a triangle mesh. `most`: the bytes that the result, and its connectivity while it is decoded (64 a
// triangle), may take. Throws InputError (with `what` in front) for data that is no such mesh, broken or too
// large.
DracoMesh decodeDraco(const GltfFile& file, std::span<const std::byte> data, std::uint64_t most,
                      const std::string& what);

struct GltfContext;

// While it lives, the accessors of a primitive that is compressed give what is decoded. For any other
// primitive it does nothing.
class DracoPrimitive {
public:
    DracoPrimitive(GltfContext& context, size_t mesh, size_t primitive, const std::string& what);
    DracoPrimitive(const DracoPrimitive&) = delete;
    DracoPrimitive& operator=(const DracoPrimitive&) = delete;
    ~DracoPrimitive();
    // The corners of its triangles, whatever its mode; nullptr where it is not compressed.
    [[nodiscard]] const std::vector<std::uint32_t>* indices() const;

private:
    std::shared_ptr<const DracoMesh> meshOf(size_t view, const std::string& what);

    GltfContext& context_;
    std::shared_ptr<const DracoMesh> mesh_;
    std::vector<int> replaced_;
};

} // namespace kestrel
