// `pool`: a tiled bath with water, glass and mirrors, under a bright panel and a small lamp.
#include "scene/builtin/noise.h"
#include "scene/builtin/rooms.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"
#include "scene/builtin/textures.h"
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel::builtin {
namespace {

const glm::vec3 roomLow(-4, 0, -3), roomHigh(4, 3.2f, 3);
const glm::vec2 basin(2.4f, 1.3f); // half the size of the basin
constexpr float depth = 1.3f, waterLevel = -0.16f;

Material tiled(const char* name, int image, float roughness) {
    Material m = matte(name, {1, 1, 1}, roughness);
    m.baseColourTexture.image = image;
    return m;
}

Material glass(const char* name, const glm::vec3& colour, float ior) {
    Material m = matte(name, colour, 0);
    m.transmission = 1;
    m.ior = ior;
    m.doubleSided = true;
    return m;
}

Material mirror(const char* name, const glm::vec3& colour) {
    Material m = matte(name, colour, 0);
    m.metallic = 1;
    return m;
}

// The floor around the basin: four strips.
Primitive makeDeck() {
    Primitive deck;
    const auto strip = [&](float x0, float x1, float z0, float z1) {
        addQuad(deck, {x0, 0, z0}, {0, 0, z1 - z0}, {x1 - x0, 0, 0}, {z1 - z0, x1 - x0});
    };
    strip(roomLow.x, -basin.x, roomLow.z, roomHigh.z);
    strip(basin.x, roomHigh.x, roomLow.z, roomHigh.z);
    strip(-basin.x, basin.x, roomLow.z, -basin.y);
    strip(-basin.x, basin.x, basin.y, roomHigh.z);
    return deck;
}

Primitive makeWater(Detail detail) {
    Primitive water;
    const int cells = detail.steps(72, 6);
    addGrid(water, cells, 2 * cells, [](float u, float v) {
        const float x = basin.x * (2 * v - 1), z = basin.y * (2 * u - 1);
        const float ripple =
            0.012f * gradientNoise({2.2f * x, 2.2f * z, 1}) + 0.005f * gradientNoise({6 * x, 6 * z, 4});
        return glm::vec3(x, waterLevel + ripple, z);
    });
    return water;
}

Primitive makeTorus(float radius, float thickness, int around, int across) {
    Primitive torus;
    addGrid(torus, around, across,
            [=](float u, float v) {
                const float a = 2 * pi * u, c = 2 * pi * v;
                const float r = radius + thickness * std::cos(c);
                return glm::vec3(r * std::cos(a), thickness * std::sin(c), -r * std::sin(a));
            },
            {.closedU = true, .closedV = true, .texScale = {8, 2}, .flat = false});
    // u runs clockwise seen from above, so that the front is outside.
    return torus;
}

Primitive makeSphere(float radius, int n) {
    Primitive sphere;
    addCubeSphere(sphere, n, [=](const glm::vec3& d) { return radius * d; });
    return sphere;
}

// Two bent rails and three rungs that lead into the basin.
Primitive makeLadder(Detail detail) {
    Primitive ladder;
    const int sides = detail.steps(14, 4), rows = detail.steps(28, 6);
    for (const float z : {-0.25f, 0.25f}) {
        const std::vector<glm::vec3> bend{{-0.45f, 0, z},   {-0.42f, 0.55f, z}, {-0.2f, 0.78f, z},
                                          {0.05f, 0.6f, z}, {0.1f, 0, z},       {0.1f, -0.95f, z}};
        std::vector<glm::vec3> path;
        for (int i = 0; i <= rows; ++i)
            path.push_back(splinePoint(bend, static_cast<float>(i) / static_cast<float>(rows)));
        addTube(ladder, path, std::vector<float>(path.size(), 0.025f), sides);
    }
    for (const float y : {-0.25f, -0.55f, -0.85f})
        addTube(ladder, {{0.1f, y, -0.25f}, {0.1f, y, 0.25f}}, {0.022f, 0.022f}, sides);
    return ladder;
}

// A slim vase with a wall, so that light passes two surfaces on each side.
Primitive makeVase(Detail detail) {
    Primitive vase;
    std::vector<glm::vec2> profile{{0, 0}, {0.10f, 0}};
    const int rows = detail.steps(24, 5);
    const auto outer = [](float t) {
        return glm::vec2(0.10f +
                             0.09f * std::sin(pi * (0.15f + 1.25f * t)) * std::sin(pi * (0.15f + 1.25f * t)),
                         0.02f + 0.58f * t);
    };
    for (int i = 0; i <= rows; ++i)
        profile.push_back(outer(static_cast<float>(i) / static_cast<float>(rows)));
    for (int i = rows; i >= 0; --i) {
        const glm::vec2 p = outer(static_cast<float>(i) / static_cast<float>(rows));
        profile.emplace_back(p.x - 0.015f, std::max(p.y, 0.04f));
    }
    profile.emplace_back(0, 0.04f);
    addLathe(vase, glm::mat4(1), profile, detail.steps(40, 8));
    return vase;
}

void addObjects(SceneBuilder& b, Detail detail) {
    const int clear = b.add(glass("glass", {0.97f, 0.99f, 0.98f}, 1.5f));
    const int green = b.add(glass("green glass", {0.55f, 0.88f, 0.68f}, 1.5f));
    const int silver = b.add(mirror("silver", {0.95f, 0.95f, 0.94f}));
    const int gold = b.add(mirror("gold", {1, 0.77f, 0.34f}));
    const int plaster = b.add(matte("plaster", {0.72f, 0.66f, 0.58f}));
    const int coral = b.add(matte("coral", {0.72f, 0.20f, 0.12f}, 0.5f));

    Primitive plinth;
    addBox(plinth, glm::translate(glm::mat4(1), {0, 0.3f, 0}), {0.28f, 0.3f, 0.28f});
    const int plinthMesh = b.addMesh("plinth", std::move(plinth), plaster);
    b.addInstance("left plinth", plinthMesh, {-2.0, 0, -2.2});
    b.addInstance("right plinth", plinthMesh, {2.0, 0, -2.2});

    const int n = detail.steps(24, 4);
    b.addInstance("glass ball", b.addMesh("glass ball", makeSphere(0.36f, n), clear), {-2.0, 0.965, -2.2});
    b.addInstance("vase", b.addMesh("vase", makeVase(detail), green), {2.0, 0.605, -2.2});
    b.addInstance("mirror ball", b.addMesh("mirror ball", makeSphere(0.5f, n), silver), {3.1, 0.505, -0.3});
    b.addInstance("golden ball", b.addMesh("golden ball", makeSphere(0.22f, n), gold), {-3.0, 0.225, 0.6});
    b.addInstance(
        "ring", b.addMesh("ring", makeTorus(0.42f, 0.12f, detail.steps(64, 10), detail.steps(24, 6)), coral),
        {-0.7, waterLevel + 0.05, 0.25});
    b.addInstance("sunken ball", b.addMesh("sunken ball", makeSphere(0.3f, n), plaster),
                  {0.7, -depth + 0.305, -0.3});
    b.addInstance("ladder", b.addMesh("ladder", makeLadder(detail), silver), {-2.36, 0, 0.2});

    Primitive frame, pane;
    addBox(frame, glm::mat4(1), {1.28f, 0.78f, 0.03f});
    addQuad(pane, {-1.2f, -0.7f, 0.035f}, {2.4f, 0, 0}, {0, 1.4f, 0});
    b.addInstance("mirror frame", b.addMesh("mirror frame", std::move(frame), plaster), {0, 1.55, -2.96});
    b.addInstance("mirror", b.addMesh("mirror", std::move(pane), silver), {0, 1.55, -2.96});
}

} // namespace

Scene makePool(Detail detail) {
    SceneBuilder b;
    const int wallTiles = b.add(tileTexture(128, 4, {0.90f, 0.90f, 0.86f}, {0.62f, 0.62f, 0.60f}));
    const int blueTiles = b.add(tileTexture(128, 8, {0.30f, 0.62f, 0.72f}, {0.80f, 0.84f, 0.84f}));
    const int deckTiles = b.add(tileTexture(128, 2, {0.66f, 0.52f, 0.42f}, {0.44f, 0.40f, 0.36f}));
    const int wall = b.add(tiled("wall tiles", wallTiles, 0.3f));
    const int blue = b.add(tiled("blue tiles", blueTiles, 0.25f));
    const int deck = b.add(tiled("deck tiles", deckTiles, 0.5f));
    const int ceiling = b.add(matte("ceiling", {0.80f, 0.80f, 0.78f}));
    b.addInstance("room", b.add(roomMesh(roomLow, roomHigh, {wall, wall, -1, ceiling, wall, wall})));
    b.addInstance("basin", b.add(roomMesh({-basin.x, -depth, -basin.y}, {basin.x, 0, basin.y},
                                          {blue, blue, blue, -1, blue, blue})));
    b.addInstance("deck", b.addMesh("deck", makeDeck(), deck));
    b.addInstance("water",
                  b.addMesh("water", makeWater(detail), b.add(glass("water", {0.86f, 0.96f, 0.97f}, 1.33f))));
    addObjects(b, detail);

    addCeilingLight(b, "skylight", {0, 3.17, 0.2}, {1.2f, 0.6f}, {1, 0.97f, 0.92f}, 9);
    Light lamp;
    lamp.name = "lamp";
    lamp.kind = LightKind::Point;
    lamp.colour = {1, 0.72f, 0.42f};
    lamp.intensity = 6;
    b.addLight(std::move(lamp), {-3.3, 2.3, -2.2}, {-3.3, 0, -2.2});

    b.addCamera("bath", {2.6, 1.9, 2.75}, {-0.35, 0.35, -0.8}, 62, 0.03f, 40);
    b.addCamera("water", {-1.9, 0.55, 2.3}, {0.5, -0.3, -0.9}, 58, 0.03f, 40);
    b.addCamera("glass", {-0.9, 1.35, -0.6}, {-1.9, 0.95, -2.2}, 50, 0.03f, 40);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
