#include "scene/gltf_draco.h"
#include "scene/gltf_context.h"
#include "scene/gltf_views.h"
#include <cstring>
#include <fmt/format.h>
#include <new>
#include <tiny_gltf.h>
#ifdef KESTREL_HAS_DRACO
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#endif

namespace kestrel {

#ifdef KESTREL_HAS_DRACO
namespace {

constexpr std::uint64_t bytesATriangle = 64; // of the corner table and what is kept beside it

// What a mesh says that it takes, known before the memory is.
struct Budget {
    std::uint64_t most = 0, wanted = 0;
    [[nodiscard]] bool allows(std::uint64_t bytes) {
        wanted = bytes;
        return bytes <= most;
    }
};

// Draco's own decoders, which stop before they allocate more than the budget.
template<class Base>
class BoundedDecoder : public Base {
public:
    explicit BoundedDecoder(Budget& budget)
        : budget_(budget) {}

protected:
    bool DecodeConnectivity() override {
        draco::DecoderBuffer ahead = *this->buffer();
        std::uint32_t first = 0, second = 0;
        if (!readCount(ahead, first) || !readCount(ahead, second)) return false;
        // Edgebreaker: vertices, then faces; sequential: faces, then points.
        constexpr bool edgebreaker = std::is_same_v<Base, draco::MeshEdgebreakerDecoder>;
        const std::uint64_t faces = edgebreaker ? second : first, points = edgebreaker ? first : second;
        return budget_.allows(bytesATriangle * faces + 4 * points) && Base::DecodeConnectivity();
    }

    // All attributes are declared and none is decoded yet.
    bool DecodeAllAttributes() override {
        const draco::PointCloud& cloud = *this->point_cloud();
        std::uint64_t bytes = bytesATriangle * this->mesh()->num_faces();
        for (int i = 0; i < cloud.num_attributes(); ++i) {
            const draco::PointAttribute& attribute = *cloud.attribute(i);
            const auto element = static_cast<std::uint64_t>(attribute.num_components()) *
                                 static_cast<std::uint64_t>(draco::DataTypeLength(attribute.data_type()));
            bytes += element * cloud.num_points();
            if (!budget_.allows(bytes)) return false;
        }
        return budget_.allows(bytes) && Base::DecodeAllAttributes();
    }

private:
    bool readCount(draco::DecoderBuffer& buffer, std::uint32_t& count) const {
        // Before, counts were whole numbers of 32 bits.
        constexpr bool edgebreaker = std::is_same_v<Base, draco::MeshEdgebreakerDecoder>;
        constexpr int minor = edgebreaker ? 0 : 2;
        const bool varint = this->bitstream_version() >= DRACO_BITSTREAM_VERSION(2, minor);
        return varint ? draco::DecodeVarint(&count, &buffer) : buffer.Decode(&count);
    }

    Budget& budget_;
};

// glTF's component type for Draco's, 0 where there is none.
int componentTypeOf(draco::DataType type) {
    switch (type) {
    case draco::DT_INT8:
        return TINYGLTF_COMPONENT_TYPE_BYTE;
    case draco::DT_UINT8:
        return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    case draco::DT_INT16:
        return TINYGLTF_COMPONENT_TYPE_SHORT;
    case draco::DT_UINT16:
        return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    case draco::DT_INT32: // glTF has no such type: what is stored so is not negative
    case draco::DT_UINT32:
        return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    case draco::DT_FLOAT32:
        return TINYGLTF_COMPONENT_TYPE_FLOAT;
    default:
        return 0;
    }
}

AccessorData dataOf(const draco::PointAttribute& attribute, std::uint32_t points) {
    AccessorData data;
    data.count = points;
    data.components = attribute.num_components();
    data.componentType = componentTypeOf(attribute.data_type());
    const size_t element = static_cast<size_t>(attribute.num_components()) *
                           static_cast<size_t>(draco::DataTypeLength(attribute.data_type()));
    data.bytes.resize(element * points);
    for (std::uint32_t i = 0; i < points; ++i) {
        const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(i));
        if (value.value() < attribute.size())
            std::memcpy(data.bytes.data() + i * element, attribute.GetAddress(value), element);
    }
    return data;
}

// An empty message: the mesh is decoded.
template<class Base>
std::string decodeWith(draco::DecoderBuffer& buffer, Budget& budget, draco::Mesh& mesh) {
    BoundedDecoder<Base> decoder(budget);
    const draco::DecoderOptions options;
    const draco::Status status = decoder.Decode(options, &buffer, &mesh);
    if (budget.wanted > budget.most)
        return fmt::format("decompresses to {} bytes, of which {} are left for this file", budget.wanted,
                           budget.most);
    return status.ok() ? "" : "holds broken Draco data";
}

std::string decode(std::span<const std::byte> data, Budget& budget, draco::Mesh& mesh) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
    draco::DecoderBuffer ahead = buffer;
    draco::DracoHeader header;
    if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok()) return "holds no Draco data";
    if (header.encoder_type != draco::TRIANGULAR_MESH) return "holds Draco data that are no triangles";
    if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
        return decodeWith<draco::MeshSequentialDecoder>(buffer, budget, mesh);
    if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
        return decodeWith<draco::MeshEdgebreakerDecoder>(buffer, budget, mesh);
    return "holds Draco data of an unknown method";
}

} // namespace

bool hasDraco() { return true; }

DracoMesh decodeDraco(const GltfFile& file, std::span<const std::byte> data, std::uint64_t most,
                      const std::string& what) {
    Budget budget{most};
    draco::Mesh mesh;
    std::string message;
    try {
        message = decode(data, budget, mesh);
    } catch (const std::bad_alloc&) {
        message = "holds Draco data that need more memory than there is";
    }
    if (!message.empty()) failGltf(file, what + " " + message);
    DracoMesh result;
    result.indices.reserve(3 * size_t{mesh.num_faces()});
    for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face)
        for (const draco::PointIndex& corner : mesh.face(face)) result.indices.push_back(corner.value());
    for (int i = 0; i < mesh.num_attributes(); ++i)
        if (componentTypeOf(mesh.attribute(i)->data_type()) != 0)
            result.attributes.emplace(mesh.attribute(i)->unique_id(),
                                      dataOf(*mesh.attribute(i), mesh.num_points()));
    return result;
}

#else

bool hasDraco() { return false; }

DracoMesh decodeDraco(const GltfFile& file, std::span<const std::byte>, std::uint64_t,
                      const std::string& what) {
    failGltf(file, what + " is compressed by Draco, which this build lacks");
}

#endif

DracoPrimitive::DracoPrimitive(GltfContext& context, size_t mesh, size_t primitive, const std::string& what)
    : context_(context) {
    const nlohmann::json& source = context.file.document["meshes"][mesh]["primitives"][primitive];
    if (!hasDraco() || !source.contains("extensions")) return;
    const auto extension = source["extensions"].find("KHR_draco_mesh_compression");
    if (extension == source["extensions"].end()) return;
    mesh_ = meshOf((*extension)["bufferView"].get<size_t>(), what);
    for (const auto& [name, id] : (*extension)["attributes"].items()) {
        const auto accessor = source["attributes"].find(name);
        if (accessor == source["attributes"].end()) continue;
        const auto data = mesh_->attributes.find(id.get<std::uint32_t>());
        if (data == mesh_->attributes.end())
            context.fail(
                fmt::format("{}.{} has the number {} in its Draco data, where there is no such attribute",
                            what, name, id.dump()));
        replaced_.push_back(accessor->get<int>());
        context.accessors.replace(replaced_.back(), &data->second);
    }
}

DracoPrimitive::~DracoPrimitive() {
    for (const int accessor : replaced_) context_.accessors.replace(accessor, nullptr);
}

const std::vector<std::uint32_t>* DracoPrimitive::indices() const {
    return mesh_ ? &mesh_->indices : nullptr;
}

std::shared_ptr<const DracoMesh> DracoPrimitive::meshOf(size_t view, const std::string& what) {
    if (context_.draco && context_.dracoView == view) return context_.draco;
    auto mesh = std::make_shared<const DracoMesh>(
        decodeDraco(context_.file, gltfView(context_.file, view), context_.accessors.bytesLeft(), what));
    std::uint64_t bytes = mesh->indices.size() * sizeof(std::uint32_t);
    for (const auto& [id, data] : mesh->attributes) bytes += data.bytes.size();
    context_.accessors.spend(bytes, what);
    context_.draco = mesh;
    context_.dracoView = view;
    return mesh;
}

} // namespace kestrel
