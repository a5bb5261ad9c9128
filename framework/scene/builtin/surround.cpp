#include "scene/builtin/surround.h"
#include "scene/facts.h"

namespace kestrel::builtin {
namespace {

// A tetrahedron that stands on one of its faces.
void addPost(Primitive& primitive, const glm::vec3& foot, float size) {
    const auto first = static_cast<std::uint32_t>(primitive.positions.size());
    for (const glm::vec3& corner :
         {glm::vec3(1, 0, 0), glm::vec3(-0.5f, 0, 0.866f), glm::vec3(-0.5f, 0, -0.866f), glm::vec3(0, 2, 0)})
        primitive.positions.push_back(foot + size * corner);
    for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 3u, 1u, 1u, 3u, 2u, 2u, 3u, 0u})
        primitive.indices.push_back(first + corner);
}

} // namespace

void surround(Scene& scene, double extent) {
    if (extent <= 1) return;
    Scene finished = scene;
    finishScene(finished);
    const SceneFacts facts = gatherFacts(finished);
    if (facts.triangles == 0) return;
    // Facts are in render space, which finishing moves to the scene's own middle.
    const glm::vec3 centre(glm::dvec3(facts.sphere.centre) + finished.origin);
    const float away = static_cast<float>(extent) * facts.sphere.radius;
    Primitive primitive;
    for (const glm::vec3& side :
         {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)})
        addPost(primitive, centre + away * side, 0.02f * facts.sphere.radius);
    primitive.material = static_cast<int>(scene.materials.size());
    Material material;
    material.name = "posts";
    material.doubleSided = true;
    scene.materials.push_back(material);
    Node node;
    node.name = "posts";
    node.mesh = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back({"posts", {primitive}, {}});
    scene.roots.push_back(static_cast<int>(scene.nodes.size()));
    scene.nodes.push_back(node);
}

} // namespace kestrel::builtin
