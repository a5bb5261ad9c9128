#include "scene/animation.h"
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace kestrel {
namespace {

size_t keyStride(const AnimationChannel& channel) {
    return channel.times.empty() ? 0 : channel.values.size() / channel.times.size();
}

// glTF 2.0, appendix C.5: the keys' in-tangent, value and out-tangent stand behind each other.
std::vector<double> sampleCubic(const AnimationChannel& channel, size_t key, double s, double interval) {
    const size_t stride = keyStride(channel), components = stride / 3;
    const float* left = channel.values.data() + key * stride;
    const float* right = left + stride;
    const double s2 = s * s, s3 = s2 * s;
    std::vector<double> value(components);
    for (size_t i = 0; i < components; ++i)
        value[i] = (2 * s3 - 3 * s2 + 1) * double(left[components + i]) +
                   interval * (s3 - 2 * s2 + s) * double(left[2 * components + i]) +
                   (3 * s2 - 2 * s3) * double(right[components + i]) +
                   interval * (s3 - s2) * double(right[i]);
    return value;
}

std::vector<double> sampleSlerp(const float* left, const float* right, double s) {
    double cosine = 0;
    for (int i = 0; i < 4; ++i) cosine += double(left[i]) * double(right[i]);
    const double sign = cosine < 0 ? -1 : 1;
    cosine = std::min(std::abs(cosine), 1.0);
    const double angle = std::acos(cosine), sine = std::sin(angle);
    // Nearly parallel: the arc is its chord to double precision, and the quotient below loses all digits.
    const bool chord = sine < 1e-7;
    const double a = chord ? 1 - s : std::sin((1 - s) * angle) / sine;
    const double b = sign * (chord ? s : std::sin(s * angle) / sine);
    std::vector<double> value(4);
    for (size_t i = 0; i < 4; ++i) value[i] = a * double(left[i]) + b * double(right[i]);
    return value;
}

std::vector<double> keyValue(const AnimationChannel& channel, size_t key) {
    const size_t stride = keyStride(channel);
    const bool cubic = channel.interpolation == Interpolation::CubicSpline;
    const size_t components = cubic ? stride / 3 : stride;
    const float* first = channel.values.data() + key * stride + (cubic ? components : 0);
    return {first, first + components};
}

std::vector<double> sampleBetweenKeys(const AnimationChannel& channel, double time) {
    const auto after = std::upper_bound(channel.times.begin(), channel.times.end(), time,
                                        [](double t, float key) { return t < double(key); });
    if (after == channel.times.begin()) return keyValue(channel, 0);
    const size_t key = static_cast<size_t>(after - channel.times.begin()) - 1;
    if (after == channel.times.end() || channel.interpolation == Interpolation::Step)
        return keyValue(channel, key);
    const double start = double(channel.times[key]), interval = double(*after) - start;
    const double s = (time - start) / interval;
    if (channel.interpolation == Interpolation::CubicSpline) return sampleCubic(channel, key, s, interval);
    const size_t stride = keyStride(channel);
    const float* left = channel.values.data() + key * stride;
    const float* right = left + stride;
    if (channel.path == AnimatedPath::Rotation) return sampleSlerp(left, right, s);
    std::vector<double> value(stride);
    for (size_t i = 0; i < stride; ++i) value[i] = double(left[i]) + s * (double(right[i]) - double(left[i]));
    return value;
}

glm::dquat unitQuaternion(const glm::dquat& q) {
    const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return length > 0 ? glm::dquat(q.w / length, q.x / length, q.y / length, q.z / length)
                      : glm::dquat(1, 0, 0, 0);
}

void applyChannel(const AnimationChannel& channel, double time, Node& node, std::vector<float>& weights) {
    const std::vector<double> value = sampleChannel(channel, time);
    switch (channel.path) {
    case AnimatedPath::Translation:
        node.translation = {value[0], value[1], value[2]};
        break;
    case AnimatedPath::Rotation:
        node.rotation = glm::dquat(value[3], value[0], value[1], value[2]);
        break;
    case AnimatedPath::Scale:
        node.scale = {value[0], value[1], value[2]};
        break;
    case AnimatedPath::Weights:
        weights.assign(value.begin(), value.end());
        break;
    }
}

// All nodes, parents before children, whether or not they hang on a root.
std::vector<int> parentsFirst(const Scene& scene) {
    std::vector<int> order;
    order.reserve(scene.nodes.size());
    for (size_t i = 0; i < scene.nodes.size(); ++i)
        if (scene.nodes[i].parent < 0) order.push_back(static_cast<int>(i));
    for (size_t i = 0; i < order.size(); ++i) {
        for (const int child : scene.nodes[static_cast<size_t>(order[i])].children) order.push_back(child);
    }
    return order;
}

std::vector<float> restWeights(const Scene& scene, const Node& node) {
    if (node.mesh < 0) return {};
    const Mesh& mesh = scene.meshes[static_cast<size_t>(node.mesh)];
    const size_t targets = mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
    std::vector<float> weights = node.weights.empty() ? mesh.weights : node.weights;
    weights.resize(targets, 0.0f);
    return weights;
}

} // namespace

double Scene::duration() const {
    float last = 0;
    for (const Animation& animation : animations)
        for (const AnimationChannel& channel : animation.channels)
            if (!channel.times.empty()) last = std::max(last, channel.times.back());
    double end = double(last);
    for (const Camera& each : cameras)
        if (!each.path.empty()) end = std::max(end, each.path.back().time);
    return end;
}

std::vector<double> sampleChannel(const AnimationChannel& channel, double time) {
    std::vector<double> value = sampleBetweenKeys(channel, time);
    if (channel.path == AnimatedPath::Rotation) {
        const glm::dquat unit = unitQuaternion(glm::dquat(value[3], value[0], value[1], value[2]));
        value = {unit.x, unit.y, unit.z, unit.w};
    }
    return value;
}

bool channelVaries(const AnimationChannel& channel) {
    const size_t stride = keyStride(channel);
    const bool cubic = channel.interpolation == Interpolation::CubicSpline;
    const size_t first = cubic ? stride / 3 : 0, last = cubic ? 2 * stride / 3 : stride;
    for (size_t key = 0; key < channel.times.size(); ++key)
        for (size_t i = 0; i < stride; ++i) {
            const float value = channel.values[key * stride + i];
            const bool tangent = i < first || i >= last;
            // Tangents count only inside the curve; those of a single key do not.
            if (tangent ? channel.times.size() > 1 && value != 0 : value != channel.values[i]) return true;
        }
    return false;
}

glm::dmat4 localMatrix(const Node& node) {
    if (node.matrix) return *node.matrix;
    glm::dmat4 matrix = glm::mat4_cast(unitQuaternion(node.rotation));
    for (int i = 0; i < 3; ++i) matrix[i] *= node.scale[i];
    matrix[3] = glm::dvec4(node.translation, 1);
    return matrix;
}

Pose poseAt(const Scene& scene, double time) { return poseAt(scene, time, scene.rootTransform); }

Pose poseAt(const Scene& scene, double time, const glm::dmat4& rootTransform) {
    Pose pose;
    const size_t count = scene.nodes.size();
    pose.worlds.resize(count);
    pose.weights.resize(count);
    for (size_t i = 0; i < count; ++i) pose.weights[i] = restWeights(scene, scene.nodes[i]);

    // Only the transform of an animated node is copied, so that names and children are not.
    std::vector<int> animatedIndex(count, -1);
    std::vector<Node> animated;
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels) {
            const size_t target = static_cast<size_t>(channel.node);
            if (animatedIndex[target] < 0) {
                animatedIndex[target] = static_cast<int>(animated.size());
                const Node& source = scene.nodes[target];
                Node& copy = animated.emplace_back();
                copy.translation = source.translation;
                copy.rotation = source.rotation;
                copy.scale = source.scale;
                copy.matrix = source.matrix;
            }
            std::vector<float>& weights = pose.weights[target];
            const size_t targets = weights.size();
            applyChannel(channel, time, animated[static_cast<size_t>(animatedIndex[target])], weights);
            weights.resize(targets, 0.0f);
        }

    for (const int index : parentsFirst(scene)) {
        const size_t i = static_cast<size_t>(index);
        const Node& node = scene.nodes[i];
        const Node& moved = animatedIndex[i] < 0 ? node : animated[static_cast<size_t>(animatedIndex[i])];
        const glm::dmat4& above =
            node.parent < 0 ? rootTransform : pose.worlds[static_cast<size_t>(node.parent)];
        pose.worlds[i] = above * localMatrix(moved);
    }
    return pose;
}

std::vector<bool> movingNodes(const Scene& scene) {
    std::vector<bool> moving(scene.nodes.size(), false);
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels)
            if (channel.path != AnimatedPath::Weights && channelVaries(channel))
                moving[static_cast<size_t>(channel.node)] = true;
    for (const int index : parentsFirst(scene)) {
        const int parent = scene.nodes[static_cast<size_t>(index)].parent;
        if (parent >= 0 && moving[static_cast<size_t>(parent)]) moving[static_cast<size_t>(index)] = true;
    }
    return moving;
}

std::vector<bool> morphingNodes(const Scene& scene) {
    std::vector<bool> morphing(scene.nodes.size(), false);
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels)
            if (channel.path == AnimatedPath::Weights && channelVaries(channel))
                morphing[static_cast<size_t>(channel.node)] = true;
    return morphing;
}

std::vector<int> nodesInScene(const Scene& scene) {
    std::vector<int> order, open(scene.roots.rbegin(), scene.roots.rend());
    while (!open.empty()) {
        const int index = open.back();
        open.pop_back();
        order.push_back(index);
        const std::vector<int>& children = scene.nodes[static_cast<size_t>(index)].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
    return order;
}

std::vector<double> keyTimes(const Scene& scene) {
    std::vector<double> times;
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels)
            if (channelVaries(channel)) times.insert(times.end(), channel.times.begin(), channel.times.end());
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

} // namespace kestrel
