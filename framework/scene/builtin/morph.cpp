// `morph`: a creature in a room that stretches, squats and bristles by three animated morph targets.
#include "scene/builtin/noise.h"
#include "scene/builtin/rooms.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"
#include <array>

namespace kestrel::builtin {
namespace {

enum class Pose { Rest, Stretch, Squat, Bristle };
constexpr std::array targets{Pose::Stretch, Pose::Squat, Pose::Bristle};

// Where the point of the skin in direction d of the creature lies; its foot is near y = 0.
glm::vec3 skin(const glm::vec3& d, Pose pose) {
    const float wobble = 0.05f * fractalNoise(1.7f * d + 4.0f, 3);
    glm::vec3 p = (0.55f + wobble) * d;
    p.y += 0.55f;
    const float up = p.y / 1.1f; // 0 at the foot, 1 at the crown
    if (pose == Pose::Stretch) {
        const float waist = 0.62f + 0.25f * (1 - up);
        p = glm::vec3(p.x * waist, p.y * 1.55f, p.z * waist + 0.22f * up * up);
    } else if (pose == Pose::Squat) {
        const float bulge = 1.35f + 0.35f * (1 - up);
        p = glm::vec3(p.x * bulge, p.y * 0.52f, p.z * bulge);
    } else if (pose == Pose::Bristle) {
        const Cellular spots = cellularNoise(4.2f * d);
        const float spike = 1 - glm::smoothstep(0.0f, 0.42f, spots.nearest);
        // The face stays bare.
        const float face = glm::smoothstep(0.75f, 0.35f, glm::dot(d, glm::normalize(glm::vec3(0, 0.25f, 1))));
        p += 0.34f * spike * spike * face * d;
    }
    // It rests on the floor.
    constexpr float soft = 0.08f;
    p.y = 0.5f * (p.y + std::sqrt(p.y * p.y + soft * soft)) - 0.35f * soft;
    return p;
}

const glm::vec3 eyeDirection = glm::normalize(glm::vec3(0.36f, 0.42f, 0.85f));

// One of the two eyes: a ball on the skin, which goes where the skin below it goes.
void addEye(Primitive& to, Pose pose, float side, float radius, float outward, int n) {
    const glm::vec3 d(side * eyeDirection.x, eyeDirection.y, eyeDirection.z);
    const glm::vec3 centre = skin(d, pose) + outward * d;
    addCubeSphere(to, n, [=](const glm::vec3& e) { return centre + radius * e; });
}

// A primitive in the rest pose with its displacements in the three others; `make` builds it in one pose,
// always with the same vertices.
template<class Make>
Primitive withTargets(int material, Make&& make) {
    Primitive primitive = make(Pose::Rest);
    primitive.material = material;
    for (const Pose pose : targets) {
        const Primitive moved = make(pose);
        Primitive::MorphTarget target;
        for (size_t i = 0; i < moved.positions.size(); ++i) {
            target.positions.push_back(moved.positions[i] - primitive.positions[i]);
            target.normals.push_back(moved.normals[i] - primitive.normals[i]);
        }
        primitive.targets.push_back(std::move(target));
    }
    return primitive;
}

Mesh makeCreature(SceneBuilder& b, Detail detail) {
    const int hide = b.add(matte("hide", {0.22f, 0.48f, 0.30f}, 0.5f));
    const int white = b.add(matte("eye white", {0.85f, 0.85f, 0.80f}, 0.2f));
    const int black = b.add(matte("pupil", {0.02f, 0.02f, 0.02f}, 0.1f));
    const int n = detail.steps(34, 6), eyes = detail.steps(9, 3);
    Mesh mesh;
    mesh.name = "creature";
    mesh.weights.assign(targets.size(), 0);
    mesh.primitives.push_back(withTargets(hide, [n](Pose pose) {
        Primitive body;
        addCubeSphere(body, n, [pose](const glm::vec3& d) { return skin(d, pose); });
        return body;
    }));
    for (const bool pupil : {false, true}) {
        mesh.primitives.push_back(withTargets(pupil ? black : white, [=](Pose pose) {
            Primitive both;
            for (const float side : {-1.0f, 1.0f})
                addEye(both, pose, side, pupil ? 0.055f : 0.11f, pupil ? 0.09f : 0.02f, eyes);
            return both;
        }));
    }
    return mesh;
}

} // namespace

Scene makeMorph(Detail detail) {
    SceneBuilder b;
    const int paint = b.add(matte("paint", {0.70f, 0.66f, 0.58f}));
    const int blue = b.add(matte("blue paint", {0.25f, 0.36f, 0.55f}));
    const int red = b.add(matte("red paint", {0.60f, 0.22f, 0.14f}));
    const int boards = b.add(matte("boards", {0.42f, 0.30f, 0.20f}, 0.6f));
    b.addInstance("room",
                  b.add(roomMesh({-2, 0, -1.8f}, {2, 2.6f, 1.8f}, {red, blue, boards, paint, paint, -1})));
    const int creature = b.addInstance("creature", b.add(makeCreature(b, detail)), {0, 0, -0.2});
    addCeilingLight(b, "lamp", {0, 2.57, 0.1}, {0.6f, 0.4f}, {1, 0.92f, 0.80f}, 10);

    AnimationChannel channel;
    channel.node = creature;
    channel.path = AnimatedPath::Weights;
    channel.times = {0, 0.8f, 1.6f, 2.4f, 3.2f, 4.0f, 4.8f};
    channel.values = {0, 0, 0, 1, 0, 0, 0, 0.2f, 0, 0, 1, 0, 0.15f, 0.3f, 1, 0.3f, 0, 0.6f, 0, 0, 0};
    Animation moods;
    moods.name = "moods";
    moods.channels.push_back(std::move(channel));
    b.scene.animations.push_back(std::move(moods));

    b.addCamera("front", {0.9, 1.25, 3.6}, {0, 0.78, -0.2}, 38, 0.05f, 20);
    b.addCamera("side", {1.8, 1.6, 1.5}, {-0.2, 0.7, -0.3}, 56, 0.05f, 20);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
