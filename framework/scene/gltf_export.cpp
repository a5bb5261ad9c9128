#include "scene/gltf_export.h"
#include "core/error.h"
#include "core/files.h"
#include "scene/gltf_writer.h"
#include "scene/skin_weights.h"
#include <algorithm>
#include <limits>

namespace kestrel {
namespace {

constexpr int typeFloat = 5126, typeUnsignedInt = 5125, typeUnsignedShort = 5123;

void appendWord(std::vector<std::byte>& bytes, std::uint32_t word) {
    const auto* first = reinterpret_cast<const std::byte*>(&word);
    bytes.insert(bytes.end(), first, first + sizeof word);
}

template<int N>
size_t addVectors(GltfWriter& writer, const std::vector<glm::vec<N, float>>& values, bool bounds = false) {
    static_assert(sizeof(glm::vec<N, float>) == N * sizeof(float));
    return writer.addFloats(&values[0][0], values.size(), N, bounds);
}

template<int N>
void addAttribute(GltfWriter& writer, OrderedJson& attributes, const char* name,
                  const std::vector<glm::vec<N, float>>& values) {
    if (!values.empty())
        attributes[name] = addVectors<N>(writer, values, std::string_view(name) == "POSITION");
}

// glTF has joints of 16 bits at most.
size_t addJoints(GltfWriter& writer, const std::vector<glm::uvec4>& joints) {
    std::vector<std::uint16_t> values;
    values.reserve(4 * joints.size());
    for (const glm::uvec4& joint : joints)
        for (int k = 0; k < 4; ++k) {
            if (joint[k] > std::numeric_limits<std::uint16_t>::max())
                throw InputError("a glTF file cannot hold a skin of more than 65536 joints");
            values.push_back(static_cast<std::uint16_t>(joint[k]));
        }
    return writer.addAccessor(values.data(), joints.size(), 4, "VEC4", typeUnsignedShort);
}

OrderedJson targetJson(GltfWriter& writer, const Primitive::MorphTarget& target, size_t vertices) {
    OrderedJson json = OrderedJson::object();
    addAttribute<3>(writer, json, "POSITION", target.positions);
    addAttribute<3>(writer, json, "NORMAL", target.normals);
    addAttribute<3>(writer, json, "TANGENT", target.tangents);
    // A target must have something: without a buffer view an accessor is zero.
    if (json.empty())
        json["POSITION"] = writer.append("accessors", {{"componentType", typeFloat},
                                                       {"count", vertices},
                                                       {"type", "VEC3"},
                                                       {"min", {0.0, 0.0, 0.0}},
                                                       {"max", {0.0, 0.0, 0.0}}});
    return json;
}

OrderedJson primitiveJson(GltfWriter& writer, const Primitive& primitive) {
    OrderedJson attributes = OrderedJson::object();
    addAttribute<3>(writer, attributes, "POSITION", primitive.positions);
    // Flat normals are what glTF asks a reader to make where there are none.
    if (!primitive.flatNormals) {
        addAttribute<3>(writer, attributes, "NORMAL", primitive.normals);
        addAttribute<4>(writer, attributes, "TANGENT", primitive.tangents);
    }
    addAttribute<2>(writer, attributes, "TEXCOORD_0", primitive.texCoords);
    addAttribute<2>(writer, attributes, "TEXCOORD_1", primitive.texCoords1);
    addAttribute<4>(writer, attributes, "COLOR_0", primitive.colours);
    std::vector<glm::uvec4> joints = primitive.joints;
    std::vector<glm::vec4> weights = primitive.weights;
    for (size_t i = 0; i < weights.size(); ++i) mergeJoints(joints[i], weights[i]);
    addAttribute<4>(writer, attributes, "WEIGHTS_0", weights);
    if (!joints.empty()) attributes["JOINTS_0"] = addJoints(writer, joints);
    OrderedJson json;
    json["attributes"] = std::move(attributes);
    json["indices"] =
        writer.addAccessor(primitive.indices.data(), primitive.indices.size(), 1, "SCALAR", typeUnsignedInt);
    if (primitive.material >= 0) json["material"] = primitive.material;
    for (const Primitive::MorphTarget& target : primitive.targets)
        json["targets"].push_back(targetJson(writer, target, primitive.positions.size()));
    return json;
}

const char* pathName(AnimatedPath path) {
    switch (path) {
    case AnimatedPath::Translation:
        return "translation";
    case AnimatedPath::Rotation:
        return "rotation";
    case AnimatedPath::Scale:
        return "scale";
    case AnimatedPath::Weights:
        break;
    }
    return "weights";
}

const char* interpolationName(Interpolation interpolation) {
    switch (interpolation) {
    case Interpolation::Step:
        return "STEP";
    case Interpolation::CubicSpline:
        return "CUBICSPLINE";
    case Interpolation::Linear:
        break;
    }
    return "LINEAR";
}

OrderedJson animationJson(GltfWriter& writer, const Animation& animation) {
    OrderedJson json;
    if (!animation.name.empty()) json["name"] = animation.name;
    for (size_t i = 0; i < animation.channels.size(); ++i) {
        const AnimationChannel& channel = animation.channels[i];
        int components = channel.path == AnimatedPath::Rotation ? 4 : 3;
        if (channel.path == AnimatedPath::Weights) components = 1;
        const size_t input = writer.addFloats(channel.times.data(), channel.times.size(), 1, true);
        const size_t output = writer.addFloats(
            channel.values.data(), channel.values.size() / static_cast<size_t>(components), components);
        json["channels"].push_back(
            {{"sampler", i}, {"target", {{"node", channel.node}, {"path", pathName(channel.path)}}}});
        json["samplers"].push_back({{"input", input},
                                    {"output", output},
                                    {"interpolation", interpolationName(channel.interpolation)}});
    }
    return json;
}

} // namespace

size_t GltfWriter::addView(std::span<const std::byte> bytes) {
    binary_.resize((binary_.size() + 3) / 4 * 4); // accessors are aligned to their components
    const size_t offset = binary_.size();
    binary_.insert(binary_.end(), bytes.begin(), bytes.end());
    return append("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
}

size_t GltfWriter::addFloats(const float* values, size_t count, int components, bool bounds) {
    constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    return addAccessor(values, count, components, components == 16 ? "MAT4" : types[components - 1],
                       typeFloat, bounds);
}

size_t GltfWriter::append(const char* array, OrderedJson element) {
    document[array].push_back(std::move(element));
    return document[array].size() - 1;
}

void GltfWriter::use(const char* extension) {
    OrderedJson& used = document["extensionsUsed"];
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
}

std::vector<std::byte> GltfWriter::finish() {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    if (!binary_.empty()) append("buffers", {{"byteLength", binary_.size()}});
    std::string json = document.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint64_t length = 12 + 8 + json.size() + (binary_.empty() ? 0 : 8 + binary_.size());
    if (length > std::numeric_limits<std::uint32_t>::max())
        throw InputError("the scene is too large for a .glb file (4 GiB)");
    std::vector<std::byte> bytes;
    bytes.reserve(length);
    appendWord(bytes, 0x46546C67); // "glTF"
    appendWord(bytes, 2);
    appendWord(bytes, static_cast<std::uint32_t>(length));
    appendWord(bytes, static_cast<std::uint32_t>(json.size()));
    appendWord(bytes, 0x4E4F534A); // "JSON"
    const std::span<const std::byte> text = std::as_bytes(std::span(json));
    bytes.insert(bytes.end(), text.begin(), text.end());
    if (binary_.empty()) return bytes;
    appendWord(bytes, static_cast<std::uint32_t>(binary_.size()));
    appendWord(bytes, 0x004E4942); // "BIN"
    bytes.insert(bytes.end(), binary_.begin(), binary_.end());
    return bytes;
}

std::vector<int> writeGltfMeshes(GltfWriter& writer, const Scene& scene) {
    std::vector<int> meshIndex;
    for (const Mesh& mesh : scene.meshes) {
        OrderedJson json;
        if (!mesh.name.empty()) json["name"] = mesh.name;
        for (const Primitive& primitive : mesh.primitives)
            if (!primitive.indices.empty()) json["primitives"].push_back(primitiveJson(writer, primitive));
        if (!mesh.weights.empty()) json["weights"] = mesh.weights;
        const bool drawn = json.contains("primitives");
        meshIndex.push_back(drawn ? static_cast<int>(writer.append("meshes", std::move(json))) : -1);
    }
    return meshIndex;
}

void writeGltfAnimations(GltfWriter& writer, const Scene& scene) {
    for (const Animation& animation : scene.animations)
        if (!animation.channels.empty()) writer.append("animations", animationJson(writer, animation));
}

std::vector<std::byte> exportedGlb(const Scene& scene) {
    GltfWriter writer;
    writeGltfMaterials(writer, scene);
    const std::vector<int> meshIndex = writeGltfMeshes(writer, scene);
    writeGltfNodes(writer, scene, meshIndex);
    writeGltfAnimations(writer, scene);
    return writer.finish();
}

void exportScene(const Scene& scene, const std::filesystem::path& file) {
    writeFile(file, exportedGlb(scene));
}

} // namespace kestrel
