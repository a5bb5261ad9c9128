// Nodes, cameras, lights and skins into a glTF file.
#include "scene/gltf_writer.h"

namespace kestrel {
namespace {

OrderedJson nodeJson(const Node& node, const std::vector<int>& meshIndex) {
    OrderedJson json = OrderedJson::object();
    if (!node.name.empty()) json["name"] = node.name;
    if (!node.children.empty()) json["children"] = node.children;
    if (node.matrix) {
        OrderedJson& matrix = json["matrix"] = OrderedJson::array();
        for (int i = 0; i < 16; ++i) matrix.push_back((*node.matrix)[i / 4][i % 4]);
    }
    if (node.translation != glm::dvec3(0)) json["translation"] = jsonNumbers(node.translation, 3);
    if (const glm::dquat& q = node.rotation; q != glm::dquat(1, 0, 0, 0))
        json["rotation"] = {q.x, q.y, q.z, q.w};
    if (node.scale != glm::dvec3(1)) json["scale"] = jsonNumbers(node.scale, 3);
    if (node.mesh >= 0 && meshIndex[static_cast<size_t>(node.mesh)] >= 0) {
        json["mesh"] = meshIndex[static_cast<size_t>(node.mesh)];
        if (node.skin >= 0) json["skin"] = node.skin;
    }
    if (!node.weights.empty()) json["weights"] = node.weights;
    return json;
}

OrderedJson cameraJson(const Camera& camera) {
    OrderedJson json;
    if (!camera.name.empty()) json["name"] = camera.name;
    json["type"] = camera.orthographic ? "orthographic" : "perspective";
    OrderedJson lens;
    if (camera.orthographic) {
        // Both factors are floats, so that their product and quotient are exact in double.
        lens["xmag"] = double(camera.halfHeight) * (camera.aspect > 0 ? double(camera.aspect) : 1.0);
        lens["ymag"] = double(camera.halfHeight);
        if (camera.aspect <= 0) json["extras"]["KESTREL_frame_aspect"] = true;
    } else {
        lens["yfov"] = double(camera.verticalFov);
        if (camera.aspect > 0) lens["aspectRatio"] = double(camera.aspect);
    }
    lens["znear"] = double(camera.nearPlane);
    if (camera.farPlane > 0) lens["zfar"] = double(camera.farPlane);
    json[camera.orthographic ? "orthographic" : "perspective"] = std::move(lens);
    return json;
}

OrderedJson punctualJson(const Light& light) {
    OrderedJson json;
    if (!light.name.empty()) json["name"] = light.name;
    json["type"] = light.kind == LightKind::Spot          ? "spot"
                   : light.kind == LightKind::Directional ? "directional"
                                                          : "point";
    json["color"] = jsonNumbers(light.colour, 3);
    json["intensity"] = double(light.intensity);
    if (light.range > 0) json["range"] = double(light.range);
    if (light.kind == LightKind::Spot)
        json["spot"] = {{"innerConeAngle", double(light.innerCone)},
                        {"outerConeAngle", double(light.outerCone)}};
    return json;
}

OrderedJson areaLightJson(const Light& light, size_t index) {
    OrderedJson json;
    json["kind"] = light.kind == LightKind::Sphere ? "sphere" : "rectangle";
    if (!light.name.empty()) json["name"] = light.name;
    json["colour"] = jsonNumbers(light.colour, 3);
    json["intensity"] = double(light.intensity);
    json["half_size"] = jsonNumbers(light.halfSize, 2);
    json["index"] = index;
    return json;
}

class NodeWriter {
public:
    NodeWriter(GltfWriter& writer, const Scene& scene)
        : writer_(writer)
        , scene_(scene) {}

    void write(const std::vector<int>& meshIndex) {
        for (const Node& node : scene_.nodes) nodes_.push_back(nodeJson(node, meshIndex));
        roots_ = scene_.roots;
        for (const Camera& camera : scene_.cameras) {
            const size_t index = writer_.append("cameras", cameraJson(camera));
            nodeWithout(camera.node,
                        [](const OrderedJson& node) { return node.contains("camera"); })["camera"] = index;
        }
        for (size_t i = 0; i < scene_.lights.size(); ++i) writeLight(scene_.lights[i], i);
        if (scene_.rootTransform != glm::dmat4(1)) putUnderRootTransform();
        if (!nodes_.empty()) writer_.document["nodes"] = nodes_;
        OrderedJson scene = OrderedJson::object();
        if (!roots_.empty()) scene["nodes"] = roots_;
        writer_.document["scene"] = 0;
        writer_.append("scenes", std::move(scene));
    }

private:
    // The JSON of node `index`, or of a new one below it (a new root for -1) where `isTaken` says that the
    // node has such a thing already.
    template<class Taken>
    OrderedJson& nodeWithout(int index, const Taken& isTaken) {
        if (index >= 0 && !isTaken(nodes_[static_cast<size_t>(index)]))
            return nodes_[static_cast<size_t>(index)];
        const int added = static_cast<int>(nodes_.size());
        nodes_.push_back(OrderedJson::object());
        if (index < 0)
            roots_.push_back(added);
        else
            nodes_[static_cast<size_t>(index)]["children"].push_back(added);
        return nodes_.back();
    }

    void writeLight(const Light& light, size_t index) {
        const auto isTaken = [](const OrderedJson& node) {
            return node.contains("extensions") || node.contains("extras");
        };
        OrderedJson& node = nodeWithout(light.node, isTaken);
        if (light.kind == LightKind::Rectangle || light.kind == LightKind::Sphere) {
            node["extras"]["KESTREL_area_light"] = areaLightJson(light, index);
            return;
        }
        writer_.use("KHR_lights_punctual");
        OrderedJson& lights = writer_.document["extensions"]["KHR_lights_punctual"]["lights"];
        lights.push_back(punctualJson(light));
        node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
    }

    void putUnderRootTransform() {
        Node above;
        above.name = "root transform";
        above.children = roots_;
        above.matrix = scene_.rootTransform;
        roots_ = {static_cast<int>(nodes_.size())};
        nodes_.push_back(nodeJson(above, {}));
    }

    GltfWriter& writer_;
    const Scene& scene_;
    std::vector<OrderedJson> nodes_;
    std::vector<int> roots_;
};

} // namespace

void writeGltfNodes(GltfWriter& writer, const Scene& scene, const std::vector<int>& meshIndex) {
    NodeWriter(writer, scene).write(meshIndex);
    for (const Skin& skin : scene.skins) {
        OrderedJson json;
        if (!skin.name.empty()) json["name"] = skin.name;
        json["joints"] = skin.joints;
        if (!skin.inverseBind.empty())
            json["inverseBindMatrices"] =
                writer.addFloats(&skin.inverseBind[0][0][0], skin.inverseBind.size(), 16);
        writer.append("skins", std::move(json));
    }
}

} // namespace kestrel
