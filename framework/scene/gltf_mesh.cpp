// Meshes of a glTF file: triangle lists from all triangle modes, vertex attributes, morph targets.
#include "scene/geometry.h"
#include "scene/gltf_context.h"
#include "scene/gltf_draco.h"
#include "scene/gltf_schema.h"
#include "scene/skin_weights.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace kestrel {
namespace {

constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

// The corners of triangles of any mode, as positions in the list of `count` elements (glTF 2.0, 3.7.2.1).
std::vector<std::uint32_t> triangleCorners(int mode, size_t count) {
    std::vector<std::uint32_t> corners;
    if (count < 3) return corners;
    const std::uint32_t n = static_cast<std::uint32_t>(count);
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        for (std::uint32_t i = 0; i < n - n % 3; ++i) corners.push_back(i);
        return corners;
    }
    for (std::uint32_t i = 0; i + 2 < n; ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
            corners.insert(corners.end(), {i, i + 1 + i % 2, i + 2 - i % 2});
        else
            corners.insert(corners.end(), {i + 1, i + 2, 0});
    }
    return corners;
}

// Reads one primitive; keeps the vertices that triangles use, in their order.
class PrimitiveReader {
public:
    PrimitiveReader(GltfContext& context, size_t mesh, size_t index, std::string what)
        : context_(context)
        , source_(context.model.meshes[mesh].primitives[index])
        , indices_(context.file.document["meshes"][mesh]["primitives"][index].value("indices", -1))
        , what_(std::move(what))
        , draco_(context, mesh, index, what_) {}

    Primitive read() {
        Primitive primitive;
        primitive.material = source_.material;
        positionAccessor_ = source_.attributes.at("POSITION");
        // Read first: only then is the count, which sizes what follows, known to be true.
        context_.accessors.floats(positionAccessor_, 3, what_ + ".POSITION");
        readIndices(primitive);
        readAttributes(primitive);
        for (size_t i = 0; i < source_.targets.size(); ++i) readTarget(primitive, i);
        return primitive;
    }

private:
    void readIndices(Primitive& primitive) {
        const size_t vertices = context_.accessors.count(positionAccessor_);
        const std::vector<std::uint32_t>* indices = draco_.indices();
        const int mode = indices != nullptr ? TINYGLTF_MODE_TRIANGLES : source_.mode;
        if (indices == nullptr && indices_ >= 0)
            indices = &context_.accessors.integers(indices_, 1, what_ + ".indices");
        const size_t count = indices ? indices->size() : vertices;
        // A strip or fan has up to three corners for each index.
        context_.spend(count, 3 * sizeof(std::uint32_t), what_);
        if (mode == TINYGLTF_MODE_TRIANGLES && count % 3 != 0)
            context_.warn(
                fmt::format("{} has {} indices: the last, incomplete triangle is ignored", what_, count));
        primitive.indices = triangleCorners(mode, count);
        if (indices)
            for (std::uint32_t& corner : primitive.indices) corner = (*indices)[corner];
        std::vector<std::uint32_t> newIndex(vertices, unused);
        for (const std::uint32_t corner : primitive.indices) {
            if (corner >= vertices)
                context_.fail(fmt::format("{} has the index {}, but {} vertices", what_, corner, vertices));
            newIndex[corner] = 0;
        }
        for (std::uint32_t i = 0; i < vertices; ++i) {
            if (newIndex[i] == unused) continue;
            newIndex[i] = static_cast<std::uint32_t>(kept_.size());
            kept_.push_back(i);
        }
        for (std::uint32_t& corner : primitive.indices) corner = newIndex[corner];
    }

    // The accessor of an attribute, or -1. Throws where its length is not that of the positions.
    int attribute(const std::map<std::string, int>& attributes, const char* name, const std::string& what) {
        const auto found = attributes.find(name);
        if (found == attributes.end()) return -1;
        if (const std::string* reason = context_.accessors.unreadable(found->second);
            reason != nullptr && isDispensable(what, name)) {
            context_.warn(fmt::format("{}.{} {}, and is ignored", what, name, *reason));
            return -1;
        }
        const size_t count = context_.accessors.count(found->second);
        const size_t vertices = context_.accessors.count(positionAccessor_);
        if (count != vertices)
            context_.fail(
                fmt::format("{}.{} has {} elements, but there are {} vertices", what, name, count, vertices));
        return found->second;
    }

    // Without these the triangles still stand where they are.
    [[nodiscard]] bool isDispensable(const std::string& what, std::string_view name) const {
        return what != what_ || (name != "POSITION" && name != "JOINTS_0" && name != "WEIGHTS_0");
    }

    template<int N>
    std::vector<glm::vec<N, float>> floats(const std::map<std::string, int>& attributes, const char* name,
                                           const std::string& what) {
        std::vector<glm::vec<N, float>> values;
        const int accessor = attribute(attributes, name, what);
        if (accessor < 0) return values;
        const std::vector<float>& source = context_.accessors.floats(accessor, N, what + "." + name);
        context_.spend(kept_.size(), N * sizeof(float), what);
        values.reserve(kept_.size());
        for (const std::uint32_t vertex : kept_) {
            glm::vec<N, float> value;
            for (int k = 0; k < N; ++k)
                value[k] = source[static_cast<size_t>(vertex) * N + static_cast<size_t>(k)];
            values.push_back(value);
        }
        return values;
    }

    void readAttributes(Primitive& primitive) {
        const auto& attributes = source_.attributes;
        primitive.positions = floats<3>(attributes, "POSITION", what_);
        primitive.normals = floats<3>(attributes, "NORMAL", what_);
        primitive.tangents = floats<4>(attributes, "TANGENT", what_);
        primitive.texCoords = floats<2>(attributes, "TEXCOORD_0", what_);
        primitive.texCoords1 = floats<2>(attributes, "TEXCOORD_1", what_);
        readColours(primitive);
        readJoints(primitive);
        if (primitive.normals.empty()) primitive.tangents.clear(); // glTF: ignored without normals
        repairNormals(primitive);
        for (const auto& [name, accessor] : attributes)
            if (name == "JOINTS_1")
                context_.warn("more than four joints a vertex: the first four are used");
            else if (name == "TEXCOORD_2" || name == "COLOR_1")
                context_.warn(name + " is ignored");
    }

    void readColours(Primitive& primitive) {
        const int accessor = attribute(source_.attributes, "COLOR_0", what_);
        if (accessor < 0) return;
        if (context_.accessors.components(accessor) != 3) {
            primitive.colours = floats<4>(source_.attributes, "COLOR_0", what_);
            return;
        }
        for (const glm::vec3& colour : floats<3>(source_.attributes, "COLOR_0", what_))
            primitive.colours.emplace_back(colour, 1.0f);
    }

    void readJoints(Primitive& primitive) {
        const int joints = attribute(source_.attributes, "JOINTS_0", what_);
        primitive.weights = floats<4>(source_.attributes, "WEIGHTS_0", what_);
        if ((joints < 0) != primitive.weights.empty() && !kept_.empty())
            context_.fail(what_ + " has only one of JOINTS_0 and WEIGHTS_0");
        if (joints < 0) return;
        const std::vector<std::uint32_t>& source =
            context_.accessors.integers(joints, 4, what_ + ".JOINTS_0");
        context_.spend(kept_.size(), sizeof(glm::uvec4), what_);
        for (const std::uint32_t vertex : kept_) {
            const std::uint32_t* joint = source.data() + 4 * static_cast<size_t>(vertex);
            primitive.joints.emplace_back(joint[0], joint[1], joint[2], joint[3]);
        }
        for (glm::vec4& weights : primitive.weights) {
            for (int k = 0; k < 4; ++k) {
                if (weights[k] < -static_cast<float>(gltfRounding))
                    context_.fail(what_ + ".WEIGHTS_0 has a negative weight");
                if (weights[k] < 0)
                    context_.warn(what_ + ".WEIGHTS_0 has weights below 0, which are read as 0");
                weights[k] = std::max(weights[k], 0.0f);
            }
            const float sum = weights.x + weights.y + weights.z + weights.w;
            if (!std::isfinite(sum)) context_.fail(what_ + ".WEIGHTS_0 has weights that are out of range");
            // What already sums to 1 up to rounding stays as it is, to the bit.
            if (sum == 0)
                weights = glm::vec4(1, 0, 0, 0);
            else if (std::abs(sum - 1) > 1e-5f)
                weights /= sum;
        }
        for (size_t i = 0; i < primitive.weights.size(); ++i)
            mergeJoints(primitive.joints[i], primitive.weights[i]);
    }

    // Unit length for what is not nearly so; the mean of the adjacent faces for what has no length at all.
    void repairNormals(Primitive& primitive) const {
        std::vector<glm::dvec3> faces;
        for (size_t i = 0; i < primitive.normals.size(); ++i) {
            glm::vec3& normal = primitive.normals[i];
            const double squared = glm::dot(glm::dvec3(normal), glm::dvec3(normal));
            if (std::abs(squared - 1) <= 1e-5) continue;
            if (squared > 0) {
                normal = glm::vec3(glm::dvec3(normal) / std::sqrt(squared));
                continue;
            }
            if (faces.empty()) faces = summedFaceNormals(primitive);
            const double length = std::sqrt(glm::dot(faces[i], faces[i]));
            normal = length > 0 ? glm::vec3(faces[i] / length) : glm::vec3(0, 0, 1);
        }
    }

    static std::vector<glm::dvec3> summedFaceNormals(const Primitive& primitive) {
        std::vector<glm::dvec3> sums(primitive.positions.size(), glm::dvec3(0));
        for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            const std::uint32_t* corner = primitive.indices.data() + i;
            const glm::dvec3 a(primitive.positions[corner[0]]);
            const glm::dvec3 cross = glm::cross(glm::dvec3(primitive.positions[corner[1]]) - a,
                                                glm::dvec3(primitive.positions[corner[2]]) - a);
            for (int k = 0; k < 3; ++k) sums[corner[k]] += cross;
        }
        return sums;
    }

    void readTarget(Primitive& primitive, size_t index) {
        const auto& attributes = source_.targets[index];
        const std::string what = fmt::format("{}.targets[{}]", what_, index);
        Primitive::MorphTarget& target = primitive.targets.emplace_back();
        target.positions = floats<3>(attributes, "POSITION", what);
        if (!primitive.normals.empty()) target.normals = floats<3>(attributes, "NORMAL", what);
        if (!primitive.tangents.empty()) target.tangents = floats<3>(attributes, "TANGENT", what);
        for (const auto& [name, accessor] : attributes)
            if (name != "POSITION" && name != "NORMAL" && name != "TANGENT")
                context_.warn(fmt::format("morph targets of {} are ignored", name));
    }

    GltfContext& context_;
    const tinygltf::Primitive& source_;
    int indices_; // accessor; -1: none
    std::string what_;
    DracoPrimitive draco_;
    int positionAccessor_ = -1;
    std::vector<std::uint32_t> kept_; // the file's vertices that triangles use
};

bool isDrawn(GltfContext& context, const tinygltf::Primitive& primitive) {
    if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
        context.warn(
            fmt::format("primitives of mode {}, which Kestrel does not know, are not drawn", primitive.mode));
        return false;
    }
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
        context.warn("points and lines are not drawn");
        return false;
    }
    if (!primitive.attributes.contains("POSITION")) {
        context.warn("primitives without POSITION are not drawn");
        return false;
    }
    return true;
}

Mesh readMesh(GltfContext& context, size_t index, std::uint64_t& trianglesLeft) {
    const tinygltf::Mesh& source = context.model.meshes[index];
    Mesh mesh;
    mesh.name = source.name;
    for (size_t i = 0; i < source.primitives.size(); ++i) {
        if (!isDrawn(context, source.primitives[i])) continue;
        const std::string what = fmt::format("meshes[{}].primitives[{}]", index, i);
        Primitive primitive = PrimitiveReader(context, index, i, what).read();
        if (primitive.indices.empty()) continue;
        if (primitive.indices.size() / 3 > trianglesLeft)
            context.fail(fmt::format("the meshes have more than {} triangles", maxTriangles));
        trianglesLeft -= primitive.indices.size() / 3;
        if (!mesh.primitives.empty() && mesh.primitives[0].targets.size() != primitive.targets.size())
            context.fail(what + " has another number of morph targets than the primitives before it");
        mesh.primitives.push_back(std::move(primitive));
    }
    const size_t targets = mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
    if (!mesh.primitives.empty() && !source.weights.empty() && source.weights.size() != targets)
        context.fail(fmt::format("meshes[{}] has {} weights for {} morph targets", index,
                                 source.weights.size(), targets));
    if (targets != 0) mesh.weights.assign(source.weights.begin(), source.weights.end());
    return mesh;
}

} // namespace

void readGltfMeshes(GltfContext& context) {
    std::uint64_t trianglesLeft = maxTriangles;
    for (size_t i = 0; i < context.model.meshes.size(); ++i)
        context.scene.meshes.push_back(readMesh(context, i, trianglesLeft));
}

} // namespace kestrel
