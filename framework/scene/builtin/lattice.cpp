// `lattice`: sixty layers of bars behind one another, alternately upright and lying. A view ray meets up to
// about a hundred surfaces; how many changes from pixel to pixel, since every layer has its own spacing and
// phase.
#include "scene/builtin/noise.h"
#include "scene/builtin/scene_builder.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel::builtin {
namespace {

constexpr int barLayers = 60;
constexpr float spacing = 0.08f; // from layer to layer
constexpr float halfWidth = 1.6f, halfHeight = 0.9f;

// The bars of one layer in the plane z = 0.
Primitive makeLayer(int layer, Detail detail) {
    RandomSequence random(static_cast<std::uint32_t>(layer) + 1);
    const bool upright = layer % 2 == 0;
    const float length = upright ? halfHeight : halfWidth, across = upright ? halfWidth : halfHeight;
    const int bars = detail.count(upright ? 32 : 18, 3);
    const float pitch = 2 * across / static_cast<float>(bars);
    // Half a bar's share of the pitch: thin in front, so that one sees far into the depth.
    const float share = glm::mix(0.12f, 0.42f, static_cast<float>(layer) / (barLayers - 1));
    Primitive bar;
    for (int i = 0; i < bars; ++i) {
        const float half = pitch * (share + random.between(-0.05f, 0.05f));
        const float at =
            -across + pitch * (static_cast<float>(i) + 0.5f) + pitch * random.between(-0.08f, 0.08f);
        const glm::vec3 centre = upright ? glm::vec3(at, 0, 0) : glm::vec3(0, at, 0);
        const glm::vec3 halfSize =
            upright ? glm::vec3(half, length, 0.2f * spacing) : glm::vec3(length, half, 0.2f * spacing);
        addBox(bar, glm::translate(glm::mat4(1), centre), halfSize);
    }
    return bar;
}

} // namespace

Scene makeLattice(Detail detail) {
    SceneBuilder b;
    const glm::vec3 front(0.85f, 0.45f, 0.16f), back(0.10f, 0.32f, 0.60f);
    constexpr int colours = 10;
    for (int i = 0; i < colours; ++i)
        b.add(matte(fmt::format("bars {}", i), glm::mix(front, back, static_cast<float>(i) / (colours - 1)),
                    0.6f));
    for (int i = 0; i < barLayers; ++i) {
        const std::string name = fmt::format("layer {}", i);
        b.addInstance(name, b.addMesh(name, makeLayer(i, detail), i * colours / barLayers),
                      {0, 0, -static_cast<double>(spacing) * i});
    }
    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::Directional;
    sun.intensity = 3;
    b.addLight(std::move(sun), {2, 3, 4}, {0, 0, -2});

    b.addCamera("front", {0, 0, 3.2}, {0, 0, -2}, 34, 0.1f, 30);
    b.addCamera("corner", {2.6, 1.6, 2.4}, {0, -0.1, -1.6}, 40, 0.1f, 30);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
