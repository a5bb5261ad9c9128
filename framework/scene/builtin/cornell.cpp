// `cornell`: the Cornell box (Goral et al., "Modeling the Interaction of Light Between Diffuse Surfaces",
// 1984) with its two white boxes, scaled to a cube of 2 m.
#include "scene/builtin/rooms.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

namespace kestrel::builtin {

Scene makeCornell(Detail) {
    SceneBuilder b;
    const int white = b.add(matte("white", {0.73f, 0.73f, 0.73f}));
    const int red = b.add(matte("red", {0.63f, 0.065f, 0.05f}));
    const int green = b.add(matte("green", {0.14f, 0.45f, 0.091f}));
    b.addInstance("room", b.add(roomMesh({-1, 0, -1}, {1, 2, 1}, {red, green, white, white, white, -1})));

    Primitive box;
    addBox(box, glm::mat4(1), glm::vec3(1));
    const int mesh = b.addMesh("box", std::move(box), white);
    const glm::dvec3 up(0, 1, 0);
    b.addInstance("tall box", mesh, {-0.34, 0.6, -0.28}, glm::angleAxis(glm::radians(17.0), up),
                  {0.3, 0.6, 0.3});
    b.addInstance("short box", mesh, {0.35, 0.3, 0.38}, glm::angleAxis(glm::radians(-17.0), up),
                  {0.3, 0.3, 0.3});
    addCeilingLight(b, "lamp", {0, 1.98, 0}, {0.24f, 0.19f}, {1, 0.77f, 0.45f}, 17);

    b.addCamera("front", {0, 1, 4.2}, {0, 1, 0}, 36, 0.1f, 20);
    b.addCamera("inside", {0.85, 1.7, 0.95}, {-0.3, 0.5, -0.4}, 60, 0.05f, 20);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
