#include "scene/builtin/rooms.h"
#include "scene/builtin/shapes.h"
#include <utility>

namespace kestrel::builtin {

Mesh roomMesh(const glm::vec3& low, const glm::vec3& high, const RoomMaterials& materials, float texPerUnit) {
    Mesh mesh;
    mesh.name = "room";
    const glm::vec3 size = high - low;
    const glm::vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    const auto side = [&](int material, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
        if (material < 0) return;
        Primitive quad;
        addQuad(quad, corner, u, v, texPerUnit * glm::vec2(glm::length(u), glm::length(v)));
        quad.material = material;
        mesh.primitives.push_back(std::move(quad));
    };
    side(materials.left, low, y, z);
    side(materials.right, low + x, z, y);
    side(materials.floor, low, z, x);
    side(materials.ceiling, low + y, x, z);
    side(materials.back, low, x, y);
    side(materials.front, low + z, y, x);
    return mesh;
}

void addCeilingLight(SceneBuilder& b, const std::string& name, const glm::dvec3& centre,
                     const glm::vec2& halfSize, const glm::vec3& colour, float radiance) {
    Light light;
    light.name = name;
    light.kind = LightKind::Rectangle;
    light.colour = colour;
    light.intensity = radiance;
    light.halfSize = halfSize;
    b.addLight(std::move(light), centre, centre - glm::dvec3(0, 1, 0));

    Material glow = matte(name, {0.78f, 0.78f, 0.78f});
    glow.emission = colour * radiance;
    Primitive quad;
    addQuad(quad, {-halfSize.x, 0, -halfSize.y}, {2 * halfSize.x, 0, 0}, {0, 0, 2 * halfSize.y});
    b.addInstance(name + " panel", b.addMesh(name + " panel", std::move(quad), b.add(std::move(glow))),
                  centre);
}

} // namespace kestrel::builtin
