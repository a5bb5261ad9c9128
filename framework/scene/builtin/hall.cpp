// `hall`: a nave between two colonnades with arches, cloth that hangs between the columns, a ribbed barrel
// vault. A spot light falls on the floor; one camera stands, one walks.
#include "scene/builtin/noise.h"
#include "scene/builtin/scene_builder.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel::builtin {
namespace {

constexpr int bays = 7;
constexpr float bay = 3.2f, halfLength = 0.5f * bays * bay;
constexpr float rowX = 3.2f;      // the colonnades stand at x = -rowX and rowX
constexpr float wallX = 6.2f;     // outer walls of the aisles
constexpr float springing = 3.6f; // where the arches begin
constexpr float archRadius = 1.2f, archDepth = 0.35f;
constexpr float wallTop = 6.2f; // where the vault begins
constexpr float columnRadius = 0.3f;

float columnZ(int i) { return -halfLength + bay * static_cast<float>(i); }

Primitive makeColumn(Detail detail) {
    Primitive column;
    const glm::mat4 frame(1);
    const int sides = detail.steps(48, 8);
    addBox(column, glm::translate(frame, {0, 0.1f, 0}), {0.45f, 0.1f, 0.45f});
    std::vector<glm::vec2> base{{0.43f, 0.2f}};
    const int turns = detail.steps(6, 2);
    for (int i = 0; i <= turns; ++i) {
        const float a = pi * (static_cast<float>(i) / static_cast<float>(turns) - 0.5f);
        base.emplace_back(0.36f + 0.07f * std::cos(a), 0.29f + 0.08f * std::sin(a));
    }
    base.emplace_back(columnRadius + 0.02f, 0.42f);
    base.emplace_back(columnRadius - 0.06f, 0.425f);
    addLathe(column, frame, base, sides);
    // The shaft: flutes, and the slight swelling that makes it look straight.
    constexpr float bottom = 0.42f, top = springing - 0.5f;
    const int flutes = 16, across = std::max(16, 16 * detail.steps(5, 1));
    addGrid(column, detail.steps(14, 2), across,
            [&](float u, float v) {
                const float a = -2 * pi * v;
                const float flute = std::abs(std::sin(0.5f * flutes * a));
                const float r = columnRadius * (1 - 0.16f * u * u) - 0.028f * flute * std::sqrt(flute);
                return glm::vec3(r * std::sin(a), glm::mix(bottom, top, u), r * std::cos(a));
            },
            {.closedU = false, .closedV = true, .texScale = glm::vec2(1), .flat = false});
    std::vector<glm::vec2> capital{
        {0.18f, top - 0.01f}, {0.285f, top}, {0.29f, top + 0.03f}, {0.26f, top + 0.06f}};
    const int curve = detail.steps(8, 2);
    for (int i = 0; i <= curve; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(curve);
        capital.emplace_back(0.26f + 0.17f * t * t, top + 0.08f + 0.28f * t);
    }
    addLathe(column, frame, capital, sides);
    addBox(column, glm::translate(frame, {0, springing - 0.07f, 0}), {0.47f, 0.07f, 0.47f});
    return column;
}

// A border of the wall over one bay: up its left side, along its top, down its right side; u from 0 to 1.
glm::vec2 bayBorder(float u) {
    const float half = 0.5f * bay;
    if (u < 0.25f) return {-half, glm::mix(springing, wallTop, 4 * u)};
    if (u > 0.75f) return {half, glm::mix(springing, wallTop, 4 - 4 * u)};
    return {half * (4 * u - 2), wallTop};
}

// The wall over one bay, from arch to top, around z = 0; thickness 2 archDepth along x, with mouldings.
Primitive makeArch(Detail detail) {
    Primitive arch;
    const int cells = 4 * detail.steps(10, 2); // the border's corners fall on vertices
    const auto opening = [](float u) {
        const float a = pi * u;
        return glm::vec2(-archRadius * std::cos(a), springing + archRadius * std::sin(a));
    };
    const auto face = [&](float u, float v, float x) {
        const glm::vec2 p = glm::mix(opening(u), bayBorder(u), v);
        return glm::vec3(x, p.y, p.x);
    };
    const int rows = detail.steps(10, 2);
    addGrid(arch, rows, cells, [&](float u, float v) { return face(v, u, archDepth); });
    addGrid(arch, cells, rows, [&](float u, float v) { return face(u, v, -archDepth); });
    addGrid(arch, detail.steps(4, 1), cells, [&](float u, float v) {
        const glm::vec2 p = opening(v);
        return glm::vec3(glm::mix(-archDepth, archDepth, u), p.y, p.x);
    });
    for (const float x : {-archDepth, archDepth}) {
        std::vector<glm::vec3> path;
        for (int i = 0; i <= cells; ++i) {
            const glm::vec2 p = opening(static_cast<float>(i) / static_cast<float>(cells));
            path.emplace_back(x, p.y + 0.02f, p.x * 1.02f);
        }
        addTube(arch, path, std::vector<float>(path.size(), 0.06f), detail.steps(10, 4));
    }
    return arch;
}

// A half barrel over the nave with coffers between its ribs.
Primitive makeVault(Detail detail) {
    Primitive vault;
    addGrid(vault, detail.steps(44, 8), detail.steps(40 * bays, 2 * bays), [](float u, float v) {
        const float a = pi * u;
        const float along = std::abs(std::sin(pi * 2 * bays * v)), round = std::abs(std::sin(9 * a));
        const float coffer =
            0.12f * glm::smoothstep(0.25f, 0.45f, along) * glm::smoothstep(0.25f, 0.45f, round);
        const float r = rowX + coffer;
        return glm::vec3(-r * std::cos(a), wallTop + 0.8f * r * std::sin(a), halfLength * (2 * v - 1));
    });
    return vault;
}

Primitive makeRib(Detail detail) {
    std::vector<glm::vec3> path;
    const int cells = detail.steps(48, 8);
    for (int i = 0; i <= cells; ++i) {
        const float a = pi * static_cast<float>(i) / static_cast<float>(cells);
        path.emplace_back(-rowX * std::cos(a), wallTop + 0.8f * rowX * std::sin(a), 0);
    }
    Primitive rib;
    addTube(rib, path, std::vector<float>(path.size(), 0.16f), detail.steps(12, 4));
    return rib;
}

// Cloth that hangs from a bar between two columns: folds that deepen downward, a sagging hem.
Primitive makeHanging(Detail detail, std::uint32_t seed) {
    Primitive cloth;
    RandomSequence random(seed);
    const float phase = random.between(0, 2 * pi), lift = random.between(0, 0.4f);
    addGrid(cloth, detail.steps(64, 10), detail.steps(56, 8), [=](float u, float v) {
        const float down = 1 - v;
        const float z = (u - 0.5f) * 2.1f * (1 - 0.10f * down);
        const float folds = std::sin(22 * u + phase + 2 * gradientNoise({3 * u, 2 * v, phase}));
        const float x =
            0.10f * (0.25f + 0.75f * down) * folds + 0.06f * gradientNoise({4 * u, 3 * v, 9 + phase});
        const float hem = 0.12f * std::sin(pi * u) * down * down;
        return glm::vec3(x, 3.5f - (2.35f - lift) * down - hem - 0.10f * std::sin(pi * u) * (1 - down), z);
    });
    return cloth;
}

void addShell(SceneBuilder& b, int stone, int floorMaterial, Detail detail) {
    Primitive floor;
    addQuad(floor, {-wallX, 0, -halfLength}, {0, 0, 2 * halfLength}, {2 * wallX, 0, 0},
            {2 * halfLength, 2 * wallX}, 1, 1);
    b.addInstance("floor", b.addMesh("floor", std::move(floor), floorMaterial));
    Primitive walls;
    const glm::vec3 along(0, 0, 2 * halfLength), up(0, wallTop, 0), deep(wallX - rowX, 0, 0);
    const float high = wallTop + 0.8f * rowX + 0.2f;
    addQuad(walls, {-wallX, 0, -halfLength}, up, along, {1, 1}, detail.steps(4, 1), detail.steps(16, 1));
    addQuad(walls, {wallX, 0, -halfLength}, along, up, {1, 1}, detail.steps(16, 1), detail.steps(4, 1));
    addQuad(walls, {-wallX, wallTop, -halfLength}, deep, along);
    addQuad(walls, {rowX, wallTop, -halfLength}, deep, along);
    addQuad(walls, {-wallX, 0, -halfLength}, {2 * wallX, 0, 0}, {0, high, 0});
    addQuad(walls, {-wallX, 0, halfLength}, {0, high, 0}, {2 * wallX, 0, 0});
    // Pilasters answer the columns on the outer walls.
    for (int i = 0; i <= bays; ++i) {
        for (const float x : {-wallX, wallX}) {
            const glm::vec3 centre(x, 0.5f * wallTop, columnZ(i));
            addBox(walls, glm::translate(glm::mat4(1), centre), {0.18f, 0.5f * wallTop, 0.35f});
        }
    }
    b.addInstance("walls", b.addMesh("walls", std::move(walls), stone));
}

// A camera that walks the nave down one side and back up the other.
void addWalk(SceneBuilder& b) {
    const int node = b.addCamera("path", {0, 1.7, 9.5}, {0, 2.2, 0}, 60, 0.05f, 60);
    AnimationChannel move, turn;
    move.node = turn.node = node;
    move.path = AnimatedPath::Translation;
    turn.path = AnimatedPath::Rotation;
    constexpr int keys = 48;
    constexpr float seconds = 16;
    glm::dquat last(1, 0, 0, 0);
    for (int i = 0; i <= keys; ++i) {
        const double a = 2 * std::numbers::pi * (i % keys) / keys;
        const glm::dvec3 eye(1.9 * std::sin(a), 1.7 + 0.3 * std::sin(2 * a), 9.0 * std::cos(a));
        const glm::dvec3 target = eye + glm::dvec3(1.5 * std::cos(a) - 0.8 * std::sin(3 * a), 0.35, -4.0);
        glm::dquat q = lookRotation(eye, target);
        if (i > 0 && glm::dot(q, last) < 0) q = -q; // the short way round
        last = q;
        const float time = seconds * static_cast<float>(i) / keys;
        move.times.push_back(time);
        turn.times.push_back(time);
        for (int k = 0; k < 3; ++k) move.values.push_back(static_cast<float>(eye[k]));
        for (const double c : {q.x, q.y, q.z, q.w}) turn.values.push_back(static_cast<float>(c));
    }
    Animation walk;
    walk.name = "walk";
    walk.channels = {std::move(move), std::move(turn)};
    b.scene.animations.push_back(std::move(walk));
}

void addColonnades(SceneBuilder& b, int stone, int pale, Detail detail) {
    const int column = b.addMesh("column", makeColumn(detail), pale);
    const int arch = b.addMesh("arch", makeArch(detail), stone);
    const int rib = b.addMesh("rib", makeRib(detail), pale);
    for (int i = 0; i <= bays; ++i) {
        for (const float x : {-rowX, rowX}) b.addInstance("column", column, {x, 0, columnZ(i)});
        b.addInstance("rib", rib, {0, 0, columnZ(i)});
    }
    for (int i = 0; i < bays; ++i)
        for (const float x : {-rowX, rowX}) b.addInstance("arch", arch, {x, 0, columnZ(i) + 0.5f * bay});
}

void addHangings(SceneBuilder& b, Detail detail) {
    const glm::vec3 dyes[] = {{0.55f, 0.06f, 0.05f}, {0.07f, 0.20f, 0.42f}, {0.62f, 0.42f, 0.06f}};
    int cloths[3], dyed[3];
    for (int i = 0; i < 3; ++i) {
        const char* names[] = {"red cloth", "blue cloth", "golden cloth"};
        Material cloth = matte(names[i], dyes[i], 0.9f);
        cloth.doubleSided = true;
        dyed[i] = b.add(std::move(cloth));
        cloths[i] = b.addMesh(names[i], makeHanging(detail, static_cast<std::uint32_t>(7 + i)), dyed[i]);
    }
    Primitive bar;
    addTube(bar, {{0, 3.52f, -1.35f}, {0, 3.52f, 1.35f}}, {0.035f, 0.035f}, detail.steps(10, 4));
    const int pole = b.addMesh("pole", std::move(bar), b.add(matte("iron", {0.12f, 0.11f, 0.10f}, 0.5f)));
    for (int i = 0; i < bays; ++i) {
        for (const int side : {0, 1}) {
            if ((i + side) % 2 != 0) continue;
            const glm::dvec3 at(side == 0 ? -rowX : rowX, 0, columnZ(i) + 0.5f * bay);
            b.addInstance("hanging", cloths[(i + side) / 2 % 3], at);
            b.addInstance("pole", pole, at);
        }
    }
}

} // namespace

Scene makeHall(Detail detail) {
    SceneBuilder b;
    const int stone = b.add(matte("sandstone", {0.60f, 0.52f, 0.40f}));
    const int pale = b.add(matte("limestone", {0.72f, 0.68f, 0.60f}, 0.7f));
    const int tiles = b.add(matte("floor", {0.36f, 0.33f, 0.30f}, 0.35f));
    addShell(b, stone, tiles, detail);
    addColonnades(b, stone, pale, detail);
    b.addInstance("vault", b.addMesh("vault", makeVault(detail), stone));
    addHangings(b, detail);

    Light spot;
    spot.name = "window";
    spot.kind = LightKind::Spot;
    spot.colour = {1, 0.88f, 0.70f};
    spot.intensity = 900;
    spot.innerCone = 0.35f;
    spot.outerCone = 0.52f;
    b.addLight(std::move(spot), {-1.5, 8.2, -7}, {1.2, 0, 1.5});

    b.addCamera("nave", {0.9, 1.75, 10.6}, {-0.1, 3.0, 0}, 58, 0.05f, 60);
    b.addCamera("aisle", {-4.6, 1.9, 9.8}, {-2.6, 2.1, 0}, 58, 0.05f, 60);
    b.addCamera("above", {2.2, 5.4, 9.6}, {-1.2, 1.6, -2}, 60, 0.05f, 60);
    addWalk(b);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
