// `skinned`: a long four-legged creature that walks on the spot; one skinned mesh of tubes around a skeleton.
#include "scene/builtin/noise.h"
#include "scene/builtin/scene_builder.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"
#include "scene/skin_weights.h"
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

namespace kestrel::builtin {
namespace {

struct Joint {
    std::string name;
    int parent; // index of a joint, -1: the skeleton's root node
    glm::vec3 position;
};

// A chain of joints with the tube around it: a radius at each joint and at the tip.
struct Limb {
    std::vector<int> joints;
    glm::vec3 tip;
    std::vector<float> radii;
};

class Creature {
public:
    Creature() {
        // The spine from the hips forward, neck and head, then the tail backward.
        std::vector<int> spine;
        for (int i = 0; i < 5; ++i)
            spine.push_back(
                add(fmt::format("spine {}", i), i == 0 ? -1 : spine.back(),
                    {0, 0.78f + 0.03f * static_cast<float>(i % 3), -0.72f + 0.36f * static_cast<float>(i)}));
        const int neck = add("neck", spine[4], {0, 0.90f, 1.00f});
        const int head = add("head", neck, {0, 1.28f, 1.22f});
        std::vector<int> body = spine;
        body.push_back(neck);
        body.push_back(head);
        limbs_.push_back({body, {0, 1.22f, 1.68f}, {0.20f, 0.25f, 0.25f, 0.26f, 0.27f, 0.19f, 0.17f, 0.07f}});
        const int tail0 = add("tail 0", spine[0], {0, 0.82f, -0.69f});
        const int tail1 = add("tail 1", tail0, {0, 1.02f, -1.16f});
        limbs_.push_back({{tail0, tail1}, {0, 1.36f, -1.36f}, {0.09f, 0.06f, 0.015f}});
        for (const int end : {0, 4}) {
            for (const float side : {-1.0f, 1.0f}) addLeg(spine[static_cast<size_t>(end)], side, end == 4);
        }
        for (const float side : {-1.0f, 1.0f}) {
            const int ear = add(side < 0 ? "ear right" : "ear left", head, {0.11f * side, 1.38f, 1.20f});
            limbs_.push_back({{ear}, {0.24f * side, 1.16f, 1.12f}, {0.05f, 0.075f}});
            ears_.push_back(ear);
        }
    }

    [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }
    [[nodiscard]] const std::vector<std::pair<int, double>>& hips() const { return hips_; }

    [[nodiscard]] Primitive mesh(Detail detail) const {
        Primitive p;
        for (const Limb& limb : limbs_) {
            const size_t first = p.positions.size();
            std::vector<glm::vec3> points = pointsOf(limb);
            const int rows =
                detail.steps(static_cast<int>(8 * points.size()), static_cast<int>(2 * points.size()));
            std::vector<glm::vec3> path;
            std::vector<float> radii;
            for (int i = 0; i <= rows; ++i) {
                const float t = static_cast<float>(i) / static_cast<float>(rows);
                path.push_back(splinePoint(points, t));
                radii.push_back(radiusAt(limb, t));
            }
            addTube(p, path, radii, detail.steps(28, 6));
            bind(p, first, limb, points);
        }
        return p;
    }

private:
    int add(std::string name, int parent, const glm::vec3& position) {
        joints_.push_back({std::move(name), parent, position});
        return static_cast<int>(joints_.size()) - 1;
    }

    void addLeg(int spine, float side, bool front) {
        const float z = front ? 0.72f : -0.70f;
        const std::string where = fmt::format("{} {}", front ? "front" : "hind", side < 0 ? "right" : "left");
        const int hip = add("hip " + where, spine, {0.17f * side, 0.72f, z});
        const int knee = add("knee " + where, hip, {0.19f * side, 0.42f, z + (front ? -0.03f : 0.06f)});
        const int foot = add("foot " + where, knee, {0.19f * side, 0.08f, z});
        limbs_.push_back(
            {{hip, knee, foot}, {0.19f * side, 0.055f, z + 0.17f}, {0.13f, 0.085f, 0.06f, 0.05f}});
        // Diagonal legs swing together.
        hips_.emplace_back(hip, (front == (side > 0)) ? 0 : std::numbers::pi);
    }

    [[nodiscard]] std::vector<glm::vec3> pointsOf(const Limb& limb) const {
        std::vector<glm::vec3> points;
        for (const int joint : limb.joints) points.push_back(joints_[static_cast<size_t>(joint)].position);
        points.push_back(limb.tip);
        return points;
    }

    static float radiusAt(const Limb& limb, float t) {
        const float x = t * static_cast<float>(limb.radii.size() - 1);
        const auto i = std::min(static_cast<size_t>(x), limb.radii.size() - 2);
        const float base = glm::mix(limb.radii[i], limb.radii[i + 1],
                                    glm::smoothstep(0.0f, 1.0f, x - static_cast<float>(i)));
        // Both ends are rounded off.
        const float end = std::min(t, 1 - t) * 14;
        return base * (end < 1 ? std::sqrt(std::max(0.04f, end * (2 - end))) : 1.0f);
    }

    // Each vertex follows the bone that it is nearest to, half of it and half the neighbour at a joint.
    void bind(Primitive& p, size_t first, const Limb& limb, const std::vector<glm::vec3>& points) const {
        p.joints.resize(p.positions.size(), glm::uvec4(0));
        p.weights.resize(p.positions.size(), glm::vec4(0));
        const auto bones = static_cast<int>(limb.joints.size());
        const int before = joints_[static_cast<size_t>(limb.joints[0])].parent;
        const auto boneAt = [&](int i) {
            if (i < 0) return before < 0 ? limb.joints[0] : before;
            return limb.joints[static_cast<size_t>(std::min(i, bones - 1))];
        };
        for (size_t v = first; v < p.positions.size(); ++v) {
            int nearest = 0;
            float at = 0, distance = 1e9f;
            for (int i = 0; i < bones; ++i) {
                const glm::vec3 a = points[static_cast<size_t>(i)],
                                edge = points[static_cast<size_t>(i) + 1] - a;
                const float f =
                    glm::clamp(glm::dot(p.positions[v] - a, edge) / glm::dot(edge, edge), 0.0f, 1.0f);
                const float d = glm::length(p.positions[v] - a - f * edge);
                if (d < distance) {
                    distance = d;
                    nearest = i;
                    at = f;
                }
            }
            const int other = at < 0.5f ? nearest - 1 : nearest + 1;
            const float share = std::abs(at - 0.5f);
            p.joints[v] = glm::uvec4(boneAt(nearest), boneAt(other), 0, 0);
            p.weights[v] = glm::vec4(1 - share, share, 0, 0);
            mergeJoints(p.joints[v], p.weights[v]);
        }
    }

    std::vector<Joint> joints_;
    std::vector<Limb> limbs_;
    std::vector<std::pair<int, double>> hips_; // joint and phase; knee and foot are the two joints behind it
    std::vector<int> ears_;
};

// The walk: one rotation channel a joint, and the bobbing of the root. Ends as it begins.
class Walk {
public:
    explicit Walk(SceneBuilder& b)
        : b_(b) {
        animation_.name = "walk";
    }
    // `angle` tells the turn around `axis` at a phase from 0 to two pi.
    template<class Angle>
    void turn(int node, const glm::dvec3& axis, Angle&& angle) {
        AnimationChannel channel = begin(node, AnimatedPath::Rotation);
        for (int i = 0; i <= keys; ++i) {
            const glm::dquat q = glm::angleAxis(double{angle(phase(i))}, axis);
            for (const double c : {q.x, q.y, q.z, q.w}) channel.values.push_back(static_cast<float>(c));
        }
        animation_.channels.push_back(std::move(channel));
    }
    template<class Height>
    void bob(int node, Height&& height) {
        AnimationChannel channel = begin(node, AnimatedPath::Translation);
        for (int i = 0; i <= keys; ++i)
            for (const double c : {0.0, double{height(phase(i))}, 0.0})
                channel.values.push_back(static_cast<float>(c));
        animation_.channels.push_back(std::move(channel));
    }
    void finish() { b_.scene.animations.push_back(std::move(animation_)); }

private:
    static constexpr int keys = 24;
    static constexpr float seconds = 1.6f;
    static double phase(int i) { return 2 * std::numbers::pi * (i % keys) / keys; }
    static AnimationChannel begin(int node, AnimatedPath path) {
        AnimationChannel channel;
        channel.node = node;
        channel.path = path;
        for (int i = 0; i <= keys; ++i) channel.times.push_back(seconds * static_cast<float>(i) / keys);
        return channel;
    }
    SceneBuilder& b_;
    Animation animation_;
};

void animate(SceneBuilder& b, const Creature& creature, int root, const std::vector<int>& nodes) {
    Walk walk(b);
    const glm::dvec3 x(1, 0, 0), y(0, 1, 0);
    walk.bob(root, [](double a) { return 0.025 * std::cos(2 * a); });
    const auto& joints = creature.joints();
    for (size_t i = 0; i < joints.size(); ++i) {
        const std::string& name = joints[i].name;
        if (name.starts_with("spine") && name != "spine 0") {
            const double lag = static_cast<double>(i) * 0.7;
            walk.turn(nodes[i], y, [=](double a) { return 0.16 * std::sin(a + lag); });
        } else if (name == "neck" || name == "head") {
            walk.turn(nodes[i], x, [=](double a) { return 0.12 * std::sin(2 * a + static_cast<double>(i)); });
        } else if (name.starts_with("tail")) {
            walk.turn(nodes[i], y, [=](double a) { return 0.55 * std::sin(2 * a - static_cast<double>(i)); });
        } else if (name.starts_with("ear")) {
            walk.turn(nodes[i], x, [=](double a) { return 0.25 * std::sin(2 * a + 1); });
        }
    }
    for (const auto& [hip, start] : creature.hips()) {
        const auto h = static_cast<size_t>(hip);
        const double offset = start;
        walk.turn(nodes[h], x, [=](double a) { return 0.5 * std::sin(a + offset); });
        walk.turn(nodes[h + 1], x, [=](double a) { return 0.45 * (1 + std::sin(a + offset + 1.3)); });
        walk.turn(nodes[h + 2], x, [=](double a) { return -0.3 - 0.35 * std::sin(a + offset + 0.8); });
    }
    walk.finish();
}

// Nodes of the skeleton and the skin over them.
int addSkeleton(SceneBuilder& b, const Creature& creature, int root, std::vector<int>& nodes) {
    Skin skin;
    skin.name = "creature";
    for (const Joint& joint : creature.joints()) {
        Node node;
        node.name = joint.name;
        node.parent = joint.parent < 0 ? root : nodes[static_cast<size_t>(joint.parent)];
        const glm::vec3 origin =
            joint.parent < 0 ? glm::vec3(0) : creature.joints()[static_cast<size_t>(joint.parent)].position;
        node.translation = joint.position - origin;
        nodes.push_back(b.add(std::move(node)));
        skin.joints.push_back(nodes.back());
        skin.inverseBind.push_back(glm::translate(glm::mat4(1), -joint.position));
    }
    b.scene.skins.push_back(std::move(skin));
    return static_cast<int>(b.scene.skins.size()) - 1;
}

} // namespace

Scene makeSkinned(Detail detail) {
    SceneBuilder b;
    const Creature creature;
    const int coat = b.add(matte("coat", {0.60f, 0.36f, 0.18f}, 0.7f));
    const int sand = b.add(matte("sand", {0.62f, 0.55f, 0.42f}));
    const int rock = b.add(matte("rock", {0.40f, 0.40f, 0.42f}));

    Node rootNode;
    rootNode.name = "skeleton";
    const int root = b.add(std::move(rootNode));
    std::vector<int> nodes;
    const int skin = addSkeleton(b, creature, root, nodes);
    Node body;
    body.name = "creature";
    body.mesh = b.addMesh("creature", creature.mesh(detail), coat);
    body.skin = skin;
    b.add(std::move(body));
    animate(b, creature, root, nodes);

    Primitive floor;
    const int cells = detail.steps(40, 6);
    addGrid(floor, cells, cells, [](float u, float v) {
        const float x = 3 * (2 * v - 1), z = 3 * (2 * u - 1);
        const float dune = 0.35f * glm::smoothstep(1.2f, 3.0f, glm::length(glm::vec2(x, z)));
        return glm::vec3(x, dune * (0.5f + fractalNoise({0.7f * x, 0.7f * z, 2}, 3)), z);
    });
    b.addInstance("sand", b.addMesh("sand", std::move(floor), sand));
    Primitive stone;
    addCubeSphere(stone, detail.steps(14, 3), [](const glm::vec3& d) {
        return glm::vec3(0.5f, 0.4f, 0.45f) * d * (1 + 0.35f * fractalNoise(1.6f * d, 4));
    });
    const int mesh = b.addMesh("rock", std::move(stone), rock);
    b.addInstance("rock", mesh, {-1.7, 0.25, -0.9});
    b.addInstance("rock", mesh, {1.5, 0.12, -1.8}, glm::angleAxis(2.0, glm::dvec3(0, 1, 0)), glm::dvec3(0.6));

    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::Directional;
    sun.colour = {1, 0.94f, 0.84f};
    sun.intensity = 3;
    b.addLight(std::move(sun), {4, 7, 3}, {0, 0, 0});
    b.addCamera("front", {2.9, 1.6, 2.4}, {0.0, 0.65, 0.15}, 40, 0.05f, 30);
    b.addCamera("side", {3.8, 1.0, 0.1}, {0, 0.65, 0.1}, 38, 0.05f, 30);
    return std::move(b.scene);
}

} // namespace kestrel::builtin
