#include "draw/near_scene.h"

namespace kestrel {

bool isWide(const SceneFacts& facts, const CameraState& camera) {
    return !camera.orthographic && camera.nearPlane > 0 && facts.sphere.radius > wideScene * camera.nearPlane;
}

Sphere nearScene(const SceneFacts& facts, const CameraState& camera) {
    if (!isWide(facts, camera)) return facts.sphere;
    const glm::vec3 ahead = -glm::vec3(camera.view[0][2], camera.view[1][2], camera.view[2][2]);
    const float reach = nearSceneReach * camera.nearPlane;
    return {camera.position + reach * ahead, reach};
}

} // namespace kestrel
