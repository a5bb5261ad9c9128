#include "scene/builtin/scene_builder.h"
#include <cmath>
#include <utility>

namespace kestrel::builtin {

glm::dquat lookRotation(const glm::dvec3& eye, const glm::dvec3& target) {
    const glm::dvec3 back = glm::normalize(eye - target);
    const glm::dvec3 up = std::abs(back.y) > 0.999 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(up, back));
    return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)));
}

Material matte(std::string name, const glm::vec3& colour, float roughness) {
    Material m;
    m.name = std::move(name);
    m.baseColour = glm::vec4(colour, 1);
    m.metallic = 0;
    m.roughness = roughness;
    return m;
}

int SceneBuilder::add(Material material) {
    scene.materials.push_back(std::move(material));
    return static_cast<int>(scene.materials.size()) - 1;
}

int SceneBuilder::add(TextureImage image) {
    scene.images.push_back(std::move(image));
    return static_cast<int>(scene.images.size()) - 1;
}

int SceneBuilder::add(Mesh mesh) {
    scene.meshes.push_back(std::move(mesh));
    return static_cast<int>(scene.meshes.size()) - 1;
}

int SceneBuilder::addMesh(std::string name, Primitive primitive, int material) {
    primitive.material = material;
    Mesh mesh;
    mesh.name = std::move(name);
    mesh.primitives.push_back(std::move(primitive));
    return add(std::move(mesh));
}

int SceneBuilder::add(Node node) {
    const int index = static_cast<int>(scene.nodes.size());
    if (node.parent < 0) {
        scene.roots.push_back(index);
    } else {
        scene.nodes[static_cast<size_t>(node.parent)].children.push_back(index);
    }
    scene.nodes.push_back(std::move(node));
    return index;
}

int SceneBuilder::addInstance(std::string name, int mesh, const glm::dvec3& translation,
                              const glm::dquat& rotation, const glm::dvec3& scale) {
    Node node;
    node.name = std::move(name);
    node.mesh = mesh;
    node.translation = translation;
    node.rotation = rotation;
    node.scale = scale;
    return add(std::move(node));
}

int SceneBuilder::addCamera(std::string name, const glm::dvec3& eye, const glm::dvec3& target,
                            float fovDegrees, float nearPlane, float farPlane) {
    Node node;
    node.name = name;
    node.translation = eye;
    node.rotation = lookRotation(eye, target);
    node.camera = static_cast<int>(scene.cameras.size());
    Camera camera;
    camera.name = std::move(name);
    camera.verticalFov = glm::radians(fovDegrees);
    camera.nearPlane = nearPlane;
    camera.farPlane = farPlane;
    const int index = add(std::move(node));
    camera.node = index;
    scene.cameras.push_back(std::move(camera));
    return index;
}

int SceneBuilder::addLight(Light light, const glm::dvec3& position, const glm::dvec3& target) {
    Node node;
    node.name = light.name;
    node.translation = position;
    node.rotation = lookRotation(position, target);
    node.light = static_cast<int>(scene.lights.size());
    const int index = add(std::move(node));
    light.node = index;
    scene.lights.push_back(std::move(light));
    return index;
}

} // namespace kestrel::builtin
