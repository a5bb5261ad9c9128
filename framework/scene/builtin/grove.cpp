// `grove`: trees whose leaves are alpha-masked cards, grass of the same kind, on uneven ground, in sunlight.
#include "scene/builtin/noise.h"
#include "scene/builtin/scene_builder.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"
#include "scene/builtin/textures.h"
#include <array>

namespace kestrel::builtin {
namespace {

constexpr float groundSize = 11.5f; // half the side

float groundHeight(float x, float z) {
    const float path = x - 1.2f * std::sin(0.28f * z);
    const float hills =
        0.55f * gradientNoise({0.22f * x, 3.5f, 0.22f * z}) + 0.08f * gradientNoise({x, 7.5f, z});
    return hills * glm::smoothstep(0.3f, 2.2f, std::abs(path));
}

struct TreeMeshes {
    Primitive bark, leaves;
};

class TreeGrower {
public:
    TreeGrower(Detail detail, std::uint32_t seed)
        : detail_(detail)
        , random_(seed)
        , cardsATwig_(detail.count(44, 3)) {}

    TreeMeshes grow() {
        const float height = random_.between(2.3f, 3.0f);
        const glm::vec3 lean(random_.between(-0.3f, 0.3f), height, random_.between(-0.3f, 0.3f));
        addBranch({0, -0.25f, 0}, lean, 0.19f, 0);
        return std::move(meshes_);
    }

private:
    // A branch of a level (0: the trunk) and what grows out of it.
    void addBranch(const glm::vec3& foot, const glm::vec3& along, float radius, int level) {
        static constexpr std::array<int, 3> steps{12, 8, 4}, sides{14, 8, 5};
        static constexpr std::array<int, 2> children{7, 4};
        const auto kind = static_cast<size_t>(level);
        const float length = glm::length(along);
        const int rows = detail_.steps(steps[kind], 2);
        std::vector<glm::vec3> path;
        std::vector<float> radii;
        const float phase = random_.between(0, 50);
        for (int i = 0; i <= rows; ++i) {
            const float t = static_cast<float>(i) / static_cast<float>(rows);
            const glm::vec3 bend(gradientNoise({2 * t, phase, 0}), 0, gradientNoise({2 * t, phase, 9}));
            // Branches rise at their ends.
            path.push_back(foot + along * t +
                           0.12f * length * t * (bend + glm::vec3(0, level > 0 ? t : 0, 0)));
            const float flare = level == 0 ? 0.7f * std::exp(-9 * t) : 0.0f;
            radii.push_back(radius * (1 - 0.72f * t + flare));
        }
        addTube(meshes_.bark, path, radii, detail_.steps(sides[kind], 3));
        if (level == 2) {
            addLeaves(path, along);
            return;
        }
        const int count = children[kind];
        const float turn = random_.between(0, 2 * pi);
        for (int i = 0; i < count; ++i) {
            const float t =
                level == 0 ? glm::mix(0.45f, 1.0f, (static_cast<float>(i) + 0.5f) / static_cast<float>(count))
                           : glm::mix(0.4f, 1.0f, static_cast<float>(i + 1) / static_cast<float>(count));
            const glm::vec3 out = sideways(along, turn + 2.4f * static_cast<float>(i));
            const glm::vec3 direction =
                glm::normalize(0.75f * out + 0.45f * glm::normalize(along) + 0.15f * random_.onSphere());
            const float reach = (level == 0 ? 1.35f - 0.5f * t : 0.75f) * random_.between(0.8f, 1.1f);
            addBranch(splinePoint(path, t), reach * direction, radius * (0.55f - 0.2f * t), level + 1);
        }
    }

    static glm::vec3 sideways(const glm::vec3& along, float angle) {
        const glm::vec3 d = glm::normalize(along);
        const glm::vec3 helper = std::abs(d.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
        const glm::vec3 x = glm::normalize(glm::cross(helper, d)), y = glm::cross(d, x);
        return x * std::cos(angle) + y * std::sin(angle);
    }

    void addLeaves(const std::vector<glm::vec3>& twig, const glm::vec3& along) {
        // Fewer cards are larger ones, so that the crown stays as dense.
        const float size = 0.25f * std::sqrt(44.0f / static_cast<float>(cardsATwig_));
        for (int i = 0; i < cardsATwig_; ++i) {
            const glm::vec3 foot = splinePoint(twig, random_.between(0.15f, 1)) +
                                   random_.between(0.02f, 0.22f) * random_.onSphere();
            const glm::vec3 up =
                glm::normalize(random_.onSphere() + 0.6f * glm::normalize(along) + glm::vec3(0, 0.2f, 0));
            const glm::vec3 right = sideways(up, random_.between(0, 2 * pi));
            const float s = size * random_.between(0.7f, 1.2f);
            addCard(meshes_.leaves, foot, s * right, s * up);
        }
    }

public:
    // A card that stands on the middle of its lower side; texture coordinates as of an upright image.
    static void addCard(Primitive& to, const glm::vec3& foot, const glm::vec3& right, const glm::vec3& up) {
        const size_t first = to.texCoords.size();
        addQuad(to, foot - 0.5f * right, right, up);
        for (size_t i = first; i < to.texCoords.size(); ++i) to.texCoords[i].y = 1 - to.texCoords[i].y;
    }

private:
    Detail detail_;
    RandomSequence random_;
    int cardsATwig_;
    TreeMeshes meshes_;
};

Material foliage(const char* name, int image) {
    Material m = matte(name, {0.85f, 0.9f, 0.8f}, 0.9f);
    m.alphaMode = AlphaMode::Mask;
    m.alphaCutoff = 0.5f;
    m.doubleSided = true;
    m.baseColourTexture.image = image;
    m.baseColourTexture.wrapS = m.baseColourTexture.wrapT = Wrap::ClampToEdge;
    return m;
}

Primitive makeGround(Detail detail) {
    Primitive ground;
    const int cells = detail.steps(64, 8);
    addGrid(ground, cells, cells, [](float u, float v) {
        const float x = groundSize * (2 * v - 1), z = groundSize * (2 * u - 1);
        return glm::vec3(x, groundHeight(x, z), z);
    });
    return ground;
}

Primitive makeGrass(Detail detail) {
    Primitive grass;
    RandomSequence random(77);
    const int tufts = detail.count(2600, 60);
    const float size = 0.34f * std::pow(2600.0f / static_cast<float>(tufts), 0.25f);
    for (int i = 0; i < tufts; ++i) {
        const float x = groundSize * random.between(-1, 1), z = groundSize * random.between(-1, 1);
        const float angle = random.between(0, pi), s = size * random.between(0.6f, 1.2f);
        // The path stays free; every tuft draws the same numbers all the same.
        if (std::abs(x - 1.2f * std::sin(0.28f * z)) < 0.75f) continue;
        const glm::vec3 foot(x, groundHeight(x, z) - 0.02f, z);
        for (const float a : {angle, angle + 0.5f * pi})
            TreeGrower::addCard(grass, foot, s * glm::vec3(std::cos(a), 0, std::sin(a)), {0, s, 0});
    }
    return grass;
}

} // namespace

Scene makeGrove(Detail detail) {
    SceneBuilder b;
    const int bark = b.add(matte("bark", {0.24f, 0.17f, 0.11f}, 0.95f));
    const int earth = b.add(matte("earth", {0.20f, 0.21f, 0.09f}, 0.95f));
    const int leaves = b.add(foliage("leaves", b.add(sprigTexture(128))));
    const int blades = b.add(foliage("grass", b.add(grassTexture(128))));
    b.addInstance("ground", b.addMesh("ground", makeGround(detail), earth));
    b.addInstance("grass", b.addMesh("grass", makeGrass(detail), blades));

    int trees[3];
    for (int i = 0; i < 3; ++i) {
        TreeMeshes tree = TreeGrower(detail, static_cast<std::uint32_t>(101 + 17 * i)).grow();
        tree.bark.material = bark;
        tree.leaves.material = leaves;
        Mesh mesh;
        mesh.name = "tree";
        mesh.primitives.push_back(std::move(tree.bark));
        mesh.primitives.push_back(std::move(tree.leaves));
        trees[i] = b.add(std::move(mesh));
    }
    RandomSequence random(5);
    constexpr int count = 20;
    for (int i = 0; i < count; ++i) {
        // Both sides of the path, alternately, with room between the trees.
        const float z = 9.5f - 20.0f * static_cast<float>(i) / (count - 1) + random.between(-0.4f, 0.4f);
        const float side = i % 2 == 0 ? 1.0f : -1.0f;
        const float x = 1.2f * std::sin(0.28f * z) + side * random.between(2.3f, i % 4 < 2 ? 3.4f : 6.5f);
        b.addInstance("tree", trees[i % 3], {x, groundHeight(x, z), z},
                      glm::angleAxis(double{random.between(0, 2 * pi)}, glm::dvec3(0, 1, 0)),
                      glm::dvec3(random.between(0.85f, 1.25f)));
    }

    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::Directional;
    sun.colour = {1, 0.94f, 0.80f};
    sun.intensity = 4;
    b.addLight(std::move(sun), {9, 14, 6}, {0, 0, 0});
    b.addCamera("path", {0.2, 1.75, 11.5}, {0.5, 1.9, 0}, 52, 0.05f, 80);
    b.addCamera("crown", {2.6, 3.4, 8.6}, {4.0, 3.1, 4.6}, 50, 0.05f, 80);
    b.addCamera("overview", {11, 8, 14}, {0.3, 0.8, 0}, 42, 0.1f, 80);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
