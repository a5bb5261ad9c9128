#include "draw/light_faces.h"
#include "core/error.h"
#include "shared/light_map.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {

std::uint32_t lightFaces(const LightState& light) {
    switch (light.kind) {
    case LightKind::Directional:
        return 0;
    case LightKind::Spot:
        return light.outerCone > wideSpotCone ? 5 : 1;
    case LightKind::Rectangle:
        return 5;
    case LightKind::Point:
    case LightKind::Sphere:
        break;
    }
    return 6;
}

LightFaces lightFacesOver(const LightState& light, const Sphere& scene) {
    const float radius = scene.radius > 0 ? scene.radius : 1;
    LightFaces faces;
    faces.origin = light.position;
    if (light.kind == LightKind::Directional) {
        // The slab of the scene's bounding sphere, a little wider than rounding.
        const float wide = 1.001f * radius;
        faces.origin = scene.centre - wide * light.direction;
        faces.halfWidth = wide;
        faces.farPlane = 2 * wide;
        return faces;
    }
    // Depth is one over the distance, in float: a near plane costs no precision far away, so it can be so
    // near that a wide scene takes nothing from what stands beside a lamp (a millimetre of 100 km).
    faces.nearPlane = 1e-8f * radius;
    // A panel that glows in a rectangle's place casts no shadow of it, also where rounding has moved it a
    // little to the front.
    if (light.kind == LightKind::Rectangle)
        faces.nearPlane = std::max(faces.nearPlane, 1e-3f * std::max(light.halfSize.x, light.halfSize.y));
    if (light.kind == LightKind::Sphere) faces.nearPlane = std::max(faces.nearPlane, light.halfSize.x);
    if (lightFaces(light) == 1) faces.halfWidth = std::tan(std::clamp(light.outerCone, 1e-3f, wideSpotCone));
    return faces;
}

CameraState lightCamera(const LightState& light, int face, const Sphere& scene) {
    const auto count = static_cast<int>(std::max(1U, lightFaces(light)));
    if (face < 0 || face >= count)
        throw InputError(fmt::format("a view looks from face {} of a light that has {}", face, count));
    const LightFaces faces = lightFacesOver(light, scene);
    // Rows of the map's turn: what it makes of the light's axes, by its own inverse.
    const auto number = static_cast<std::uint32_t>(face);
    glm::vec3 right(0), up(0), ahead(0);
    const glm::vec3 axes[] = {light.tangent, light.bitangent, light.direction};
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 unit(0);
        unit[axis] = 1;
        const glm::vec3 turned = shared::lightMapTurned(unit, number);
        right += turned.x * axes[axis];
        up += turned.y * axes[axis];
        ahead += turned.z * axes[axis];
    }
    if (glm::dot(glm::cross(right, up), ahead) > 0) right = -right;
    CameraState camera;
    camera.position = faces.origin;
    const glm::vec3 rows[] = {right, up, -ahead};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) camera.view[column][row] = rows[row][column];
        camera.view[3][row] = -glm::dot(rows[row], faces.origin);
    }
    camera.nearPlane = faces.nearPlane;
    camera.farPlane = faces.farPlane;
    camera.orthographic = light.kind == LightKind::Directional;
    if (camera.orthographic)
        camera.halfHeight = faces.halfWidth;
    else
        camera.verticalFov = 2 * std::atan(faces.halfWidth);
    return camera;
}

} // namespace kestrel
