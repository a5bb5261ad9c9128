// Nodes of a glTF file with their hierarchy, cameras, lights, skins.
#include "scene/animation.h"
#include "scene/gltf_context.h"
#include "scene/gltf_schema.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>

namespace kestrel {
namespace {

glm::dvec3 vec3Of(const std::vector<double>& values, glm::dvec3 otherwise) {
    return values.size() == 3 ? glm::dvec3(values[0], values[1], values[2]) : otherwise;
}

void readTransform(const GltfContext& context, const tinygltf::Node& source, size_t index, Node& node) {
    node.translation = vec3Of(source.translation, node.translation);
    node.scale = vec3Of(source.scale, node.scale);
    if (source.rotation.size() == 4) {
        const std::vector<double>& q = source.rotation;
        node.rotation = glm::dquat(q[3], q[0], q[1], q[2]);
        if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0)
            context.fail(fmt::format("nodes[{}].rotation is zero", index));
    }
    if (source.matrix.size() != 16) return;
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = source.matrix[static_cast<size_t>(i)];
    const glm::dvec4 lastRow(matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3]);
    if (glm::any(glm::greaterThan(glm::abs(lastRow - glm::dvec4(0, 0, 0, 1)), glm::dvec4(gltfRounding))))
        context.fail(fmt::format("nodes[{}].matrix is not affine", index));
    for (int i = 0; i < 4; ++i) matrix[i][3] = i == 3 ? 1 : 0;
    node.matrix = matrix;
}

void readOneNode(GltfContext& context, size_t index) {
    const tinygltf::Node& source = context.model.nodes[index];
    Node& node = context.scene.nodes[index];
    node.name = source.name;
    readTransform(context, source, index, node);
    node.mesh = source.mesh;
    node.skin = source.skin;
    node.weights.assign(source.weights.begin(), source.weights.end());
    node.children = source.children;
    for (const int child : source.children) {
        Node& below = context.scene.nodes[static_cast<size_t>(child)];
        if (below.parent >= 0)
            context.fail(fmt::format("nodes[{}] has two parents, {} and {}", child, below.parent, index));
        below.parent = static_cast<int>(index);
    }
    if (source.mesh < 0) return;
    const Mesh& mesh = context.scene.meshes[static_cast<size_t>(source.mesh)];
    const size_t targets = mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
    if (!mesh.primitives.empty() && !source.weights.empty() && source.weights.size() != targets)
        context.fail(fmt::format("nodes[{}] has {} weights for {} morph targets", index,
                                 source.weights.size(), targets));
}

// With one parent at most, a node is on a cycle if going up never ends.
void refuseCycles(const GltfContext& context) {
    const std::vector<Node>& nodes = context.scene.nodes;
    std::vector<char> safe(nodes.size(), 0);
    for (size_t start = 0; start < nodes.size(); ++start) {
        std::vector<size_t> path;
        for (int at = static_cast<int>(start); at >= 0 && !safe[static_cast<size_t>(at)];
             at = nodes[static_cast<size_t>(at)].parent) {
            path.push_back(static_cast<size_t>(at));
            if (path.size() > nodes.size())
                context.fail(fmt::format("nodes[{}] is above itself: the hierarchy has a cycle", at));
        }
        for (const size_t node : path) safe[node] = 1;
    }
}

void chooseRoots(GltfContext& context) {
    Scene& scene = context.scene;
    if (context.model.scenes.empty()) {
        for (size_t i = 0; i < scene.nodes.size(); ++i)
            if (scene.nodes[i].parent < 0) scene.roots.push_back(static_cast<int>(i));
        return;
    }
    const size_t chosen = static_cast<size_t>(std::max(context.model.defaultScene, 0));
    if (context.model.scenes.size() > 1)
        context.warn(
            fmt::format("the file has {} scenes; scene {} is loaded", context.model.scenes.size(), chosen));
    scene.roots = context.model.scenes[chosen].nodes;
    std::vector<char> seen(scene.nodes.size(), 0);
    for (const int root : scene.roots) {
        if (scene.nodes[static_cast<size_t>(root)].parent >= 0)
            context.fail(
                fmt::format("scenes[{}] has nodes[{}] at its root, which has a parent", chosen, root));
        if (seen[static_cast<size_t>(root)]++)
            context.fail(fmt::format("scenes[{}] has nodes[{}] twice", chosen, root));
    }
}

Camera readCamera(const GltfContext& context, size_t index) {
    const tinygltf::Camera& source = context.model.cameras[index];
    const nlohmann::json& json = context.file.document["cameras"][index];
    Camera camera;
    camera.name = source.name;
    camera.orthographic = source.type == "orthographic";
    double aspect = 0, near = 0, far = 0, size = 0;
    if (camera.orthographic) {
        aspect = source.orthographic.xmag / source.orthographic.ymag;
        size = source.orthographic.ymag;
        near = source.orthographic.znear;
        far = source.orthographic.zfar;
        if (json.contains("extras") && json["extras"].is_object() &&
            json["extras"].value("KESTREL_frame_aspect", false))
            aspect = 0;
        camera.halfHeight = static_cast<float>(size);
    } else {
        aspect = source.perspective.aspectRatio;
        size = source.perspective.yfov;
        near = source.perspective.znear;
        far = source.perspective.zfar;
        camera.verticalFov = static_cast<float>(size);
        if (size >= std::numbers::pi) context.fail(fmt::format("cameras[{}] has a yfov of {}", index, size));
    }
    camera.aspect = static_cast<float>(aspect);
    camera.nearPlane = static_cast<float>(near);
    camera.farPlane = static_cast<float>(far);
    const bool depth = (camera.orthographic ? near >= 0 : near > 0) &&
                       (camera.farPlane > camera.nearPlane || (far == 0 && !camera.orthographic));
    if (!(size > 0) || !(aspect >= 0) || !std::isfinite(aspect) || !depth)
        context.fail(fmt::format("cameras[{}] has no volume (aspect {}, size {}, near {}, far {})", index,
                                 aspect, size, near, far));
    return camera;
}

Light readLight(const tinygltf::Light& source) {
    Light light;
    light.name = source.name;
    light.kind = source.type == "spot"          ? LightKind::Spot
                 : source.type == "directional" ? LightKind::Directional
                                                : LightKind::Point;
    light.colour = glm::vec3(vec3Of(source.color, glm::dvec3(1)));
    light.intensity = static_cast<float>(source.intensity);
    light.range = static_cast<float>(source.range);
    if (light.kind != LightKind::Spot) return light;
    light.innerCone = static_cast<float>(source.spot.innerConeAngle);
    light.outerCone = static_cast<float>(source.spot.outerConeAngle);
    return light;
}

// The light of a node by KHR_lights_punctual, or -1.
int punctualLight(const tinygltf::Node& node) {
    const tinygltf::Value* extension = gltfExtension(node.extensions, "KHR_lights_punctual");
    return extension ? static_cast<int>(gltfNumber(*extension, "light", -1)) : -1;
}

struct AreaLight {
    Light light;
    size_t index = 0; // its place among all lights
};

std::vector<AreaLight> readAreaLights(GltfContext& context, const std::vector<int>& nodes) {
    std::vector<AreaLight> lights;
    for (const int node : nodes) {
        const nlohmann::json& json = context.file.document["nodes"][static_cast<size_t>(node)];
        if (!json.contains("extras") || !json["extras"].is_object()) continue;
        const auto found = json["extras"].find("KESTREL_area_light");
        if (found == json["extras"].end()) continue;
        const std::string& kind = (*found)["kind"].get_ref<const std::string&>();
        if (kind != "sphere" && kind != "rectangle") {
            context.warn(
                fmt::format("nodes[{}] has an area light of the kind '{}', which Kestrel does not know, "
                            "and is ignored",
                            node, kind.substr(0, 60)));
            continue;
        }
        AreaLight area;
        area.light.kind = kind == "sphere" ? LightKind::Sphere : LightKind::Rectangle;
        area.light.name = found->value("name", "");
        const std::vector<float> colour = found->value("colour", std::vector<float>{1, 1, 1});
        area.light.colour = {colour[0], colour[1], colour[2]};
        area.light.intensity = found->value("intensity", 1.0f);
        area.light.halfSize = {(*found)["half_size"][0].get<float>(), (*found)["half_size"][1].get<float>()};
        area.light.node = node;
        area.index = found->value("index", size_t{0});
        lights.push_back(std::move(area));
    }
    std::stable_sort(lights.begin(), lights.end(),
                     [](const AreaLight& a, const AreaLight& b) { return a.index < b.index; });
    return lights;
}

// The name of an element under a node: its own, or the node's where it has none or shares it with others.
std::string nameUnder(const Node& node, const std::string& own, bool shared) {
    return node.name.empty() || (!own.empty() && !shared) ? own : node.name;
}

// Cameras and lights become one for each node that uses them, in the order of the file's list. Only nodes of
// the loaded scene count.
void readCamerasAndLights(GltfContext& context) {
    Scene& scene = context.scene;
    const std::vector<int> nodes = nodesInScene(scene);
    std::vector<std::vector<int>> cameraUsers(context.model.cameras.size()),
        lightUsers(context.model.lights.size());
    std::vector<int> ordered = nodes;
    std::sort(ordered.begin(), ordered.end());
    for (const int index : ordered) {
        const tinygltf::Node& source = context.model.nodes[static_cast<size_t>(index)];
        if (source.camera >= 0) cameraUsers[static_cast<size_t>(source.camera)].push_back(index);
        if (const int light = punctualLight(source); light >= 0)
            lightUsers[static_cast<size_t>(light)].push_back(index);
    }
    std::map<std::string, size_t> named; // how many nodes have a camera of this name
    for (size_t i = 0; i < cameraUsers.size(); ++i)
        named[context.model.cameras[i].name] += cameraUsers[i].size();
    for (size_t i = 0; i < cameraUsers.size(); ++i) {
        const Camera read = readCamera(context, i);
        for (const int user : cameraUsers[i]) {
            Node& node = scene.nodes[static_cast<size_t>(user)];
            Camera camera = read;
            camera.name = nameUnder(node, camera.name, named[camera.name] > 1);
            camera.node = user;
            scene.cameras.push_back(std::move(camera));
        }
    }
    for (size_t i = 0; i < lightUsers.size(); ++i)
        for (const int user : lightUsers[i]) {
            Light light = readLight(context.model.lights[i]);
            light.node = user;
            scene.lights.push_back(std::move(light));
        }
    for (AreaLight& area : readAreaLights(context, ordered)) {
        const size_t place = std::min(area.index, scene.lights.size());
        scene.lights.insert(scene.lights.begin() + static_cast<std::ptrdiff_t>(place), std::move(area.light));
    }
    for (size_t i = 0; i < scene.cameras.size(); ++i)
        scene.nodes[static_cast<size_t>(scene.cameras[i].node)].camera = static_cast<int>(i);
    for (size_t i = 0; i < scene.lights.size(); ++i)
        scene.nodes[static_cast<size_t>(scene.lights[i].node)].light = static_cast<int>(i);
}

void checkJoints(const GltfContext& context, size_t nodeIndex) {
    const Node& node = context.scene.nodes[nodeIndex];
    const size_t joints = context.scene.skins[static_cast<size_t>(node.skin)].joints.size();
    for (const Primitive& primitive : context.scene.meshes[static_cast<size_t>(node.mesh)].primitives)
        for (size_t i = 0; i < primitive.joints.size(); ++i)
            for (int k = 0; k < 4; ++k)
                if (primitive.weights[i][k] != 0 && primitive.joints[i][k] >= joints)
                    context.fail(
                        fmt::format("nodes[{}]: a vertex of meshes[{}] has the joint {}, but skins[{}] has "
                                    "{} joints",
                                    nodeIndex, node.mesh, primitive.joints[i][k], node.skin, joints));
}

} // namespace

void readGltfNodes(GltfContext& context) {
    context.scene.nodes.resize(context.model.nodes.size());
    for (size_t i = 0; i < context.model.nodes.size(); ++i) readOneNode(context, i);
    refuseCycles(context);
    chooseRoots(context);
    readCamerasAndLights(context);
}

void readGltfSkins(GltfContext& context) {
    for (size_t i = 0; i < context.model.skins.size(); ++i) {
        const tinygltf::Skin& source = context.model.skins[i];
        Skin skin;
        skin.name = source.name;
        skin.joints = source.joints;
        skin.inverseBind.assign(skin.joints.size(), glm::mat4(1));
        if (skin.joints.empty()) context.fail(fmt::format("skins[{}] has no joints", i));
        if (source.inverseBindMatrices >= 0) {
            const std::string what = fmt::format("skins[{}].inverseBindMatrices", i);
            const std::vector<float>& values = context.accessors.floats(source.inverseBindMatrices, 16, what);
            if (values.size() / 16 < skin.joints.size())
                context.fail(fmt::format("{} has {} matrices for {} joints", what, values.size() / 16,
                                         skin.joints.size()));
            for (size_t j = 0; j < skin.joints.size(); ++j)
                for (int k = 0; k < 16; ++k)
                    skin.inverseBind[j][k / 4][k % 4] = values[16 * j + static_cast<size_t>(k)];
        }
        context.scene.skins.push_back(std::move(skin));
    }
    std::uint64_t joints = 0;
    for (size_t i = 0; i < context.scene.nodes.size(); ++i) {
        const Node& node = context.scene.nodes[i];
        if (node.skin < 0 || node.mesh < 0) continue;
        checkJoints(context, i);
        joints += context.scene.skins[static_cast<size_t>(node.skin)].joints.size();
        if (joints > context.file.limits.joints)
            context.fail(fmt::format("the skinned nodes have more than {} joints in total",
                                     context.file.limits.joints));
    }
}

} // namespace kestrel
