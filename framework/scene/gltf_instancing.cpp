// EXT_mesh_gpu_instancing: one mesh at many places under a node. Each place becomes a node below it.
#include "scene/animation.h"
#include "scene/gltf_context.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

constexpr const char* extensionName = "EXT_mesh_gpu_instancing";

// A node whose mesh stands at `count` places, of which `kept` are taken.
struct Instanced {
    size_t node = 0, count = 0, kept = 0;
    std::uint64_t triangles = 0, vertices = 0; // of the mesh
};

const nlohmann::json* attributesOf(const GltfContext& context, size_t node) {
    const nlohmann::json& json = context.file.document["nodes"][node];
    const auto extensions = json.find("extensions");
    if (extensions == json.end()) return nullptr;
    const auto found = extensions->find(extensionName);
    return found == extensions->end() ? nullptr : &(*found)["attributes"];
}

// How many places the attributes tell; they must agree. Names what is no place.
size_t countOf(GltfContext& context, const nlohmann::json& attributes, const std::string& what) {
    size_t count = 0;
    std::string first;
    for (const auto& [name, accessor] : attributes.items()) {
        if (name != "TRANSLATION" && name != "ROTATION" && name != "SCALE") {
            context.warn(fmt::format("the attribute {} of instances is ignored", name.substr(0, 60)));
            continue;
        }
        const size_t here = context.accessors.count(accessor.get<int>());
        if (!first.empty() && here != count)
            context.fail(fmt::format("{}: there are {} of {}, but {} of {}", what, here, name, count, first));
        first = name;
        count = here;
    }
    return count;
}

// The nodes with instances that are drawn, and how much a whole one takes.
std::vector<Instanced> instancedNodes(GltfContext& context) {
    std::vector<Instanced> found;
    std::vector<int> nodes = nodesInScene(context.scene);
    std::sort(nodes.begin(), nodes.end());
    for (const int index : nodes) {
        const Node& node = context.scene.nodes[static_cast<size_t>(index)];
        const nlohmann::json* attributes = attributesOf(context, static_cast<size_t>(index));
        if (attributes == nullptr || node.mesh < 0) continue;
        if (node.skin >= 0) {
            context.warn("the instances of skinned meshes are ignored");
            continue;
        }
        Instanced one;
        one.node = static_cast<size_t>(index);
        one.count = countOf(context, *attributes, fmt::format("nodes[{}].{}", index, extensionName));
        for (const Primitive& primitive : context.scene.meshes[static_cast<size_t>(node.mesh)].primitives) {
            one.triangles += primitive.indices.size() / 3;
            one.vertices += primitive.positions.size();
        }
        if (one.count > 0) found.push_back(one);
    }
    return found;
}

// The share of `wanted` that `most` bears.
double shareOf(double wanted, std::uint64_t most) {
    return wanted > double(most) ? double(most) / wanted : 1;
}

// Chooses how many instances of each node are kept: all, or evenly fewer where all together are too many.
void keepWhatIsBorne(GltfContext& context, std::vector<Instanced>& nodes) {
    double count = 0, triangles = 0, vertices = 0;
    for (const Instanced& one : nodes) {
        count += double(one.count);
        triangles += double(one.count) * double(one.triangles);
        vertices += double(one.count) * double(one.vertices);
    }
    const GltfLimits& limits = context.file.limits;
    const double share = std::min({shareOf(count, limits.instances), shareOf(triangles, limits.triangles),
                                   shareOf(vertices, limits.triangles)});
    double kept = 0;
    for (Instanced& one : nodes) {
        one.kept = share == 1 ? one.count : static_cast<size_t>(double(one.count) * share);
        kept += double(one.kept);
    }
    if (share < 1)
        context.warn(fmt::format(
            "the scene has {:.0f} instances of {:.0f} triangles and {:.0f} vertices in all; at "
            "most {}, {} and {} are drawn: {:.0f} of them are, evenly chosen",
            count, triangles, vertices, limits.instances, limits.triangles, limits.triangles, kept));
}

class InstanceReader {
public:
    InstanceReader(GltfContext& context, const Instanced& instanced)
        : context_(context)
        , instanced_(instanced)
        , what_(fmt::format("nodes[{}].{}", instanced.node, extensionName)) {}

    // Gives the node's mesh to nodes of its own below it.
    void read() {
        const std::vector<float>* translation = values("TRANSLATION", 3);
        const std::vector<float>* rotation = values("ROTATION", 4);
        const std::vector<float>* scale = values("SCALE", 3);
        std::vector<Node>& nodes = context_.scene.nodes;
        context_.spend(instanced_.kept, sizeof(Node), what_);
        nodes.reserve(nodes.size() + instanced_.kept);
        for (size_t k = 0; k < instanced_.kept; ++k) {
            // Evenly spread over all of them.
            const size_t i =
                static_cast<size_t>(double(k) * double(instanced_.count) / double(instanced_.kept));
            Node& above = nodes[instanced_.node];
            Node node;
            node.parent = static_cast<int>(instanced_.node);
            node.mesh = above.mesh;
            node.weights = above.weights;
            if (translation) node.translation = vectorAt(*translation, i);
            if (scale) node.scale = vectorAt(*scale, i);
            if (rotation) node.rotation = rotationAt(*rotation, i);
            above.children.push_back(static_cast<int>(nodes.size()));
            nodes.push_back(std::move(node));
        }
        nodes[instanced_.node].mesh = -1;
        nodes[instanced_.node].weights.clear();
    }

private:
    const std::vector<float>* values(const char* name, int components) {
        const nlohmann::json& attributes = *attributesOf(context_, instanced_.node);
        const auto accessor = attributes.find(name);
        if (accessor == attributes.end()) return nullptr;
        return &context_.accessors.floats(accessor->get<int>(), components, what_ + "." + name);
    }

    static glm::dvec3 vectorAt(const std::vector<float>& values, size_t i) {
        return {double(values[3 * i]), double(values[3 * i + 1]), double(values[3 * i + 2])};
    }

    // Unit; what has no length turns nothing.
    static glm::dquat rotationAt(const std::vector<float>& values, size_t i) {
        const float* q = values.data() + 4 * i;
        const glm::dquat rotation{double(q[3]), double(q[0]), double(q[1]), double(q[2])};
        const double length = std::sqrt(glm::dot(rotation, rotation));
        return length > 0 ? rotation / length : glm::dquat(1, 0, 0, 0);
    }

    GltfContext& context_;
    const Instanced& instanced_;
    std::string what_;
};

} // namespace

void readGltfInstances(GltfContext& context) {
    std::vector<Instanced> nodes = instancedNodes(context);
    keepWhatIsBorne(context, nodes);
    for (const Instanced& one : nodes) InstanceReader(context, one).read();
}

} // namespace kestrel
