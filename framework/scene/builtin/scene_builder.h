// Puts a scene together: materials, meshes, nodes, cameras and lights by short calls.
#pragma once
#include "scene/scene.h"
#include <string>

namespace kestrel::builtin {

// Orientation of a camera or light (looking along -z, y up) at `eye` that looks at `target`.
glm::dquat lookRotation(const glm::dvec3& eye, const glm::dvec3& target);

// A rough, non-metallic material of that linear colour.
Material matte(std::string name, const glm::vec3& colour, float roughness = 0.8f);

class SceneBuilder {
public:
    int add(Material material);
    int add(TextureImage image);
    int add(Mesh mesh);
    // A mesh of one primitive.
    int addMesh(std::string name, Primitive primitive, int material);
    // Every node is a root unless it has a parent.
    int add(Node node);
    int addInstance(std::string name, int mesh, const glm::dvec3& translation = glm::dvec3(0),
                    const glm::dquat& rotation = {1, 0, 0, 0}, const glm::dvec3& scale = glm::dvec3(1));
    // A camera of its own node; returns the node. The vertical field of view is in degrees.
    int addCamera(std::string name, const glm::dvec3& eye, const glm::dvec3& target, float fovDegrees,
                  float nearPlane, float farPlane);
    // A light of its own node at `position`, shining at `target`; returns the node.
    int addLight(Light light, const glm::dvec3& position, const glm::dvec3& target);

    Scene scene;
};

} // namespace kestrel::builtin
