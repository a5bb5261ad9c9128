#include "scene/builtin/stress_scenes.h"
#include "scene/builtin/rooms.h"
#include "scene/builtin/scene_builder.h"
#include "scene/builtin/shapes.h"
#include <cmath>
#include <iterator>

namespace kestrel::builtin {
namespace {

// Triangles of one double-sided material about the origin, about 2 wide, in one light, seen from +z.
Scene seen(Primitive primitive, bool lit = true, float farPlane = 20) {
    SceneBuilder b;
    Material material = matte("grey", glm::vec3(0.7f));
    material.doubleSided = true;
    const int grey = b.add(std::move(material));
    if (!primitive.indices.empty()) b.addInstance("mesh", b.addMesh("mesh", std::move(primitive), grey));
    b.addCamera("front", {0.1, 0.2, 4}, {0, 0, 0}, 40, 0.1f, farPlane);
    if (lit) {
        Light light;
        light.name = "lamp";
        light.kind = LightKind::Point;
        light.intensity = 40;
        b.addLight(light, {1.5, 2, 3}, {0, 0, 0});
    }
    return std::move(b.scene);
}

void addTriangle(Primitive& to, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    for (const glm::vec3& p : {a, b, c}) {
        to.indices.push_back(static_cast<std::uint32_t>(to.positions.size()));
        to.positions.push_back(p);
    }
}

// A square of half side `half` about (x, y, z), facing +z; without normals, as addTriangle() makes them.
void addSquare(Primitive& to, const glm::vec3& at, float half) {
    const glm::vec3 u(half, 0, 0), v(0, half, 0);
    addTriangle(to, at - u - v, at + u - v, at + u + v);
    addTriangle(to, at - u - v, at + u + v, at - u + v);
}

void addFloor(Primitive& to) {
    addTriangle(to, {-1, -1, -1}, {-1, -1, 1}, {1, -1, 1});
    addTriangle(to, {-1, -1, -1}, {1, -1, 1}, {1, -1, -1});
}

Scene empty(int) { return seen({}); }

Scene one(int) {
    Primitive p;
    addTriangle(p, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0.5f});
    return seen(std::move(p));
}

// A point, a line, and a triangle whose corners are one up to the last bit.
Scene degenerate(int) {
    Primitive p;
    addFloor(p);
    addTriangle(p, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    addTriangle(p, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0});
    addTriangle(p, {0.5f, 0.5f, 0}, {std::nextafter(0.5f, 1.0f), 0.5f, 0}, {0.5f, 0.5f, 0});
    return seen(std::move(p));
}

Scene onePoint(int) {
    Primitive p;
    addTriangle(p, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    return seen(std::move(p));
}

Scene slivers(int) {
    Primitive p;
    addFloor(p);
    for (int i = 0; i < 32; ++i) {
        const float y = -0.9f + 0.06f * static_cast<float>(i), z = -0.5f + 0.03f * static_cast<float>(i);
        addTriangle(p, {-1, y, z}, {1, y + 0.1f, z}, {1, y + 0.1f + 1e-7f, z});
        addTriangle(p, {-1, y, z}, {1, y, z}, {0, y + 1e-7f, z});
    }
    return seen(std::move(p));
}

// Needles along each axis, as wide as a millionth of their length.
Scene needles(int) {
    Primitive p;
    addFloor(p);
    for (int i = 0; i < 24; ++i) {
        const float at = -0.92f + 0.08f * static_cast<float>(i);
        addTriangle(p, {-1, at, 0}, {1, at, 0}, {1, at + 2e-6f, 0});
        addTriangle(p, {at, -1, 0.1f}, {at, 1, 0.1f}, {at + 2e-6f, 1, 0.1f});
        addTriangle(p, {at, at, -1}, {at, at, 1}, {at + 2e-6f, at, 1});
    }
    return seen(std::move(p));
}

// The same square several times, and twice more turned round.
Scene coincident(int) {
    Primitive p;
    addFloor(p);
    for (int i = 0; i < 4; ++i) addSquare(p, glm::vec3(0), 0.7f);
    for (int i = 0; i < 2; ++i) {
        addTriangle(p, {-0.7f, -0.7f, 0}, {0.7f, 0.7f, 0}, {0.7f, -0.7f, 0});
        addTriangle(p, {-0.7f, -0.7f, 0}, {-0.7f, 0.7f, 0}, {0.7f, 0.7f, 0});
    }
    return seen(std::move(p));
}

// Squares of other sizes in one plane.
Scene coplanar(int) {
    Primitive p;
    addFloor(p);
    for (int i = 1; i <= 6; ++i)
        addSquare(p, {0.05f * static_cast<float>(i), 0, 0}, 0.12f * static_cast<float>(i));
    return seen(std::move(p));
}

Scene interpenetrating(int) {
    Primitive p;
    addFloor(p);
    for (int i = 0; i < 12; ++i) {
        const float angle = 2 * pi * static_cast<float>(i) / 12;
        const glm::vec3 u(std::cos(angle), std::sin(angle), 0.3f), v(-0.2f * std::sin(angle), 0.1f, 0.8f);
        addTriangle(p, -u, u, v);
    }
    return seen(std::move(p));
}

// All of them in what is one column of pixels in a small picture.
Scene column(int count) {
    Primitive p;
    addFloor(p);
    for (int i = 0; i < count; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(count);
        const float y = -0.95f + 1.9f * std::fmod(t * 97, 1.0f), z = -0.9f + 1.8f * t;
        addTriangle(p, {0, y, z}, {0.004f, y, z}, {0.002f, y + 0.01f, z});
    }
    return seen(std::move(p));
}

// It reaches a hundred times farther than the far plane, and behind the eye.
Scene huge(int) {
    Primitive p;
    addTriangle(p, {-3000, -1, -2000}, {0, -1, 4000}, {3000, -1, -2000});
    addSquare(p, glm::vec3(0), 0.5f);
    return seen(std::move(p));
}

// A grid of squares that lies within one cell of a map of 256 about the whole, which two far posts make wide.
Scene voxel(int) {
    Primitive p;
    for (int i = 0; i < 5; ++i)
        addSquare(p, {0.0003f * static_cast<float>(i), 0, 0.0002f * static_cast<float>(i)}, 0.001f);
    addSquare(p, {-1, 0.3f, -0.5f}, 0.05f);
    addSquare(p, {1, -0.3f, 0.5f}, 0.05f);
    return seen(std::move(p));
}

// Squares at multiples of what is a cell's edge in maps of every power of two.
Scene borders(int) {
    Primitive p;
    for (const float at : {-1.0f, -0.5f, 0.0f, 0.25f, 1.0f}) {
        addSquare(p, {0, 0, at}, 1);
        addTriangle(p, {-1, at, -1}, {1, at, -1}, {1, at, 1});
        addTriangle(p, {at, -1, -1}, {at, 1, -1}, {at, 1, 1});
    }
    return seen(std::move(p));
}

// Boxes whose edges and corners lie on a lattice, seen along an axis: rays meet edges and corners.
Scene corners(int) {
    Primitive p;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                addBox(p,
                       glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0),
                                 glm::vec4(0.5f * static_cast<float>(x), 0.5f * static_cast<float>(y),
                                           0.5f * static_cast<float>(z), 1)),
                       glm::vec3(0.125f));
    Scene scene = seen(std::move(p));
    scene.nodes[static_cast<size_t>(scene.cameras[0].node)].translation = {0, 0, 4};
    scene.nodes[static_cast<size_t>(scene.cameras[0].node)].rotation = lookRotation({0, 0, 4}, {0, 0, 0});
    return scene;
}

// Squares one behind the other, from the nearest to the farthest, each a little smaller than what it would
// take to hide all of the next one's rim.
Scene layers(int count) {
    Primitive p;
    for (int i = 0; i < count; ++i) {
        const float t = count > 1 ? static_cast<float>(i) / static_cast<float>(count - 1) : 0;
        addSquare(p, {0.1f * t, 0, 1 - 2 * t}, 0.9f);
    }
    return seen(std::move(p));
}

// The same within a hundred thousandth of the depth, one square far behind: one bucket of equal width has
// all.
Scene bucket(int count) {
    Primitive p;
    for (int i = 0; i < count; ++i)
        addSquare(p, {0, 0, -1e-5f * static_cast<float>(i) / static_cast<float>(count)}, 0.9f);
    addSquare(p, {0, 0, -1}, 1);
    return seen(std::move(p));
}

// All at one depth: a pixel's least and greatest are equal.
Scene equal(int count) {
    Primitive p;
    for (int i = 0; i < count; ++i) addSquare(p, glm::vec3(0), 0.9f);
    return seen(std::move(p));
}

// The eye in a closed box of which every point shines with radiance 1 and reflects half of what arrives.
Scene furnace(int) {
    SceneBuilder b;
    Material wall = matte("wall", glm::vec3(0.5f), 1);
    wall.emission = glm::vec3(1);
    const int material = b.add(std::move(wall));
    b.addInstance("room", b.add(roomMesh({-1, -1, -1}, {1, 1, 1},
                                         {material, material, material, material, material, material})));
    b.addCamera("inside", {0.3, 0.1, 0.5}, {-0.2, -0.1, -0.6}, 70, 0.02f, 10);
    return std::move(b.scene);
}

// A closed room whose walls are `count` tenths of a cell thick, of an occupancy map of 128 cells an edge
// about it: what is seen of the outside from within has leaked. Turned, so that no wall lies along the cells.
Scene sealed(int count) {
    SceneBuilder b;
    const float cell = 2 * std::sqrt(3.0f) / 126;
    const float within = 1 - 0.1f * static_cast<float>(count) * cell;
    const int grey = b.add(matte("grey", glm::vec3(0.7f)));
    const glm::dquat turned(glm::dvec3(0.3, 0.5, 0.2));
    Primitive outside;
    addBox(outside, glm::mat4(1), glm::vec3(1));
    b.addInstance("outside", b.addMesh("outside", std::move(outside), grey), glm::dvec3(0), turned);
    b.addInstance(
        "inside",
        b.add(roomMesh(glm::vec3(-within), glm::vec3(within), {grey, grey, grey, grey, grey, grey})),
        glm::dvec3(0), turned);
    b.addCamera("inside", turned * glm::dvec3(0.7, 0.6, 0.8), turned * glm::dvec3(-0.6, -0.7, -0.8), 75,
                0.02f, 10);
    return std::move(b.scene);
}

constexpr StressScene scenes[] = {
    {"empty", "No triangle", empty, 0, 0},
    {"one", "One triangle", one, 0, 0},
    {"point", "A triangle without extent and nothing else", onePoint, 0, 0},
    {"degenerate", "A point, a line and a triangle of one last bit as triangles", degenerate, 0, 0},
    {"slivers", "Triangles as high as 1e-7 of their length", slivers, 0, 0},
    {"needles", "Needles along the axes, as wide as 1e-6 of their length", needles, 0, 0},
    {"coincident", "The same square six times, twice turned round", coincident, 0, 0},
    {"coplanar", "Squares of other sizes in one plane", coplanar, 0, 0},
    {"interpenetrating", "Triangles that cut each other", interpenetrating, 0, 0},
    {"column", "Many triangles in one column of pixels", column, 10'000, 1'000'000},
    {"huge", "A triangle far larger than the far plane", huge, 0, 0},
    {"voxel", "A mesh inside one cell of a map", voxel, 0, 0},
    {"borders", "Squares on the borders of cells", borders, 0, 0},
    {"corners", "Boxes on a lattice, seen along an axis", corners, 0, 0},
    {"layers", "Squares one behind the other", layers, 10, 10'000},
    {"bucket", "Squares within a hundred thousandth of the depth, and one far behind", bucket, 64, 10'000},
    {"equal", "Squares at one depth", equal, 32, 10'000},
    {"furnace", "A closed room that shines with radiance 1 and reflects half", furnace, 0, 0},
    {"sealed", "A closed room with walls as thick as tenths of a map's cell", sealed, 10, 200},
};

} // namespace

std::span<const StressScene> stressScenes() { return scenes; }

} // namespace kestrel::builtin
