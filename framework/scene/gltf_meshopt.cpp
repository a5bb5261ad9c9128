// EXT_meshopt_compression and KHR_meshopt_compression: buffer views that are compressed one by one.
#include "scene/gltf_views.h"
#include "scene/meshopt_attributes.h"
#include <fmt/format.h>
#ifdef KESTREL_HAS_MESHOPT
#include <meshoptimizer.h>
#endif

namespace kestrel {
namespace {

using nlohmann::json;

constexpr const char* extensions[] = {"KHR_meshopt_compression", "EXT_meshopt_compression"};

const json* compressionOf(const json& object) {
    const auto all = object.find("extensions");
    if (all == object.end()) return nullptr;
    for (const char* name : extensions)
        if (const auto found = all->find(name); found != all->end()) return &*found;
    return nullptr;
}

#ifdef KESTREL_HAS_MESHOPT

struct Compressed {
    std::span<const std::byte> stream;
    size_t count = 0, stride = 0;
    std::string mode, filter;
};

class ViewDecoder {
public:
    ViewDecoder(GltfFile& file, size_t index)
        : file_(file)
        , index_(index) {}

    // Decodes into GltfFile::views; the bytes that it took.
    std::uint64_t decode(const json& compression, std::uint64_t left) {
        const Compressed source = read(compression);
        if (source.count > left / source.stride)
            fail(fmt::format(
                "decompresses to {} elements of {} bytes; at most {} bytes are decompressed for one "
                "file",
                source.count, source.stride, file_.limits.decodedBytes));
        std::vector<std::byte> bytes(source.count * source.stride);
        if (!decompress(source, bytes.data())) fail("has a broken compressed stream");
        applyFilter(source, bytes.data());
        const std::uint64_t size = bytes.size();
        file_.views[index_] = std::move(bytes);
        return size;
    }

private:
    [[noreturn]] void fail(const std::string& message) const {
        failGltf(file_, fmt::format("bufferViews[{}] {}", index_, message));
    }

    [[nodiscard]] Compressed read(const json& compression) const {
        Compressed source;
        source.count = compression["count"].get<size_t>();
        source.stride = compression["byteStride"].get<size_t>();
        source.mode = compression["mode"].get<std::string>();
        source.filter = compression.value("filter", "NONE");
        const size_t buffer = compression["buffer"].get<size_t>();
        const size_t offset = compression.value("byteOffset", size_t{0});
        const size_t length = compression["byteLength"].get<size_t>();
        const std::vector<std::byte>& bytes = file_.buffers[buffer];
        if (offset > bytes.size() || length > bytes.size() - offset)
            fail(fmt::format("is compressed in bytes {} to {} of buffers[{}], which has {}", offset,
                             offset + length, buffer, bytes.size()));
        source.stream = std::span(bytes).subspan(offset, length);
        checkLayout(source);
        const size_t whole = file_.document["bufferViews"][index_]["byteLength"].get<size_t>();
        if (whole / source.stride != source.count || whole % source.stride != 0)
            fail(fmt::format("has {} bytes, but {} compressed elements of {}", whole, source.count,
                             source.stride));
        return source;
    }

    void checkLayout(const Compressed& source) const {
        const bool attributes = source.mode == "ATTRIBUTES", triangles = source.mode == "TRIANGLES";
        if (!attributes && !triangles && source.mode != "INDICES")
            fail(fmt::format("is compressed in the mode '{}', which Kestrel does not know",
                             source.mode.substr(0, 60)));
        const size_t stride = source.stride;
        bool fits = attributes ? stride % 4 == 0 && stride <= 256 : stride == 2 || stride == 4;
        if (triangles && source.count % 3 != 0)
            fail(fmt::format("has {} indices of triangles", source.count));
        const std::string& filter = source.filter;
        if (filter == "OCTAHEDRAL" || filter == "COLOR")
            fits &= attributes && (stride == 4 || stride == 8);
        else if (filter == "QUATERNION")
            fits &= attributes && stride == 8;
        else if (filter == "EXPONENTIAL")
            fits &= attributes;
        else if (filter != "NONE")
            fail(fmt::format("has the compression filter '{}', which Kestrel does not know",
                             filter.substr(0, 60)));
        if (!fits)
            fail(fmt::format(
                "is compressed in the mode {} with the filter {}, which elements of {} bytes do not fit",
                source.mode, filter, stride));
    }

    static bool decompress(const Compressed& source, std::byte* out) {
        const auto* stream = reinterpret_cast<const unsigned char*>(source.stream.data());
        const size_t size = source.stream.size();
        if (source.mode == "TRIANGLES")
            return meshopt_decodeIndexBuffer(out, source.count, source.stride, stream, size) == 0;
        if (source.mode == "INDICES")
            return meshopt_decodeIndexSequence(out, source.count, source.stride, stream, size) == 0;
        if (isMeshoptAttributes1(source.stream))
            return decodeMeshoptAttributes1(source.stream, source.count, source.stride, out);
        return meshopt_decodeVertexBuffer(out, source.count, source.stride, stream, size) == 0;
    }

    static void applyFilter(const Compressed& source, std::byte* elements) {
        if (source.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(elements, source.count, source.stride);
        if (source.filter == "QUATERNION") meshopt_decodeFilterQuat(elements, source.count, source.stride);
        if (source.filter == "EXPONENTIAL") meshopt_decodeFilterExp(elements, source.count, source.stride);
        if (source.filter == "COLOR") decodeMeshoptColours(elements, source.count, source.stride);
    }

    GltfFile& file_;
    size_t index_;
};

#endif // KESTREL_HAS_MESHOPT

} // namespace

bool isFallbackBuffer(const json& buffer) {
    const json* compression = compressionOf(buffer);
    return compression != nullptr && compression->value("fallback", false);
}

#ifdef KESTREL_HAS_MESHOPT
bool hasMeshopt() { return true; }

void decodeMeshoptViews(GltfFile& file) {
    const auto views = file.document.find("bufferViews");
    if (views == file.document.end()) return;
    std::uint64_t left = file.limits.decodedBytes;
    for (size_t i = 0; i < views->size(); ++i)
        if (const json* compression = compressionOf((*views)[i]))
            left -= ViewDecoder(file, i).decode(*compression, left);
}
#else
bool hasMeshopt() { return false; }
void decodeMeshoptViews(GltfFile&) {}
#endif

std::span<const std::byte> gltfView(const GltfFile& file, size_t index) {
    if (const auto found = file.views.find(index); found != file.views.end()) return found->second;
    const json& view = file.document["bufferViews"][index];
    const size_t buffer = view["buffer"].get<size_t>();
    const std::uint64_t offset = view.value("byteOffset", std::uint64_t{0});
    const std::uint64_t length = view["byteLength"].get<std::uint64_t>();
    const std::vector<std::byte>& bytes = file.buffers[buffer];
    if (offset > bytes.size() || length > bytes.size() - offset)
        failGltf(file, fmt::format("bufferViews[{}] has bytes {} to {} of buffers[{}], which has {}", index,
                                   offset, offset + length, buffer, bytes.size()));
    return std::span(bytes).subspan(offset, length);
}

} // namespace kestrel
