// Parts that several rooms share.
#pragma once
#include "scene/builtin/scene_builder.h"
#include <glm/glm.hpp>
#include <string>

namespace kestrel::builtin {

// The inner sides of a box from `low` to `high`, each of its own primitive, front sides inward.
struct RoomMaterials {
    int left, right, floor, ceiling, back, front; // at -x, +x, -y, +y, -z, +z; -1 leaves the side open
};
Mesh roomMesh(const glm::vec3& low, const glm::vec3& high, const RoomMaterials& materials,
              float texPerUnit = 1);

// A rectangle that hangs below a ceiling and shines down: the light itself and a mesh that glows alike.
// `centre` is the middle of the rectangle, halfSize along x and z, `radiance` what each of its points sends
// out.
void addCeilingLight(SceneBuilder& b, const std::string& name, const glm::dvec3& centre,
                     const glm::vec2& halfSize, const glm::vec3& colour, float radiance);

} // namespace kestrel::builtin
