#include "scene/timeline_bounds.h"
#include "scene/bounds.h"
#include "scene/deform.h"
#include <algorithm>
#include <cmath>
#include <list>

namespace kestrel {
namespace {

// Vertices times samples that may be evaluated; beyond that corners of boxes stand for the vertices.
constexpr double maxEvaluations = 1e7;
constexpr double verticesPerNode = 8; // what placing a node costs, in vertices

struct DoubleBox {
    glm::dvec3 min{std::numeric_limits<double>::infinity()};
    glm::dvec3 max{-std::numeric_limits<double>::infinity()};
    void add(const glm::dvec3& p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
};

// The box of one vertex along its path, and the last two samples of the present stretch.
struct VertexPath {
    DoubleBox box;
    glm::dvec3 last{0}, beforeLast{0}, widening{0};
};

// When to sample: the number of samples since the last discontinuity tells which differences have a meaning.
struct Sample {
    double time;
    int sinceJump; // 0 right at a key: a Step channel may have jumped
};

// Steps between two keys: turns about several joints and cubic curves need fine ones; where keys are dense,
// as in baked animations, what happens between two of them is nearly straight.
int stepsPerKey(const Scene& scene, size_t keys) {
    constexpr size_t dense = 16;
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels)
            if (channel.interpolation == Interpolation::CubicSpline) return 8;
    return keys > dense ? 4 : 8;
}

std::vector<Sample> samplesBetweenKeys(const std::vector<double>& keys, int steps) {
    std::vector<Sample> samples;
    for (size_t i = 0; i + 1 < keys.size(); ++i)
        for (int step = 0; step <= steps; ++step) {
            const double time = keys[i] + (keys[i + 1] - keys[i]) * step / steps;
            // The end of a stretch is taken just before the next key, where a Step channel has not jumped
            // yet.
            samples.push_back({step < steps ? time : std::nextafter(keys[i + 1], keys[i]), step});
        }
    if (!keys.empty()) samples.push_back({keys.back(), 0});
    return samples;
}

std::vector<Sample> evenSamples(const std::vector<double>& keys, size_t count) {
    std::vector<Sample> samples;
    for (size_t i = 0; i < count; ++i) {
        const double s = static_cast<double>(i) / static_cast<double>(count - 1);
        samples.push_back({keys.front() + s * (keys.back() - keys.front()), static_cast<int>(i)});
    }
    return samples;
}

// The largest size that the weight of each target reaches along the timeline.
std::vector<double> largestWeights(const Scene& scene, const Instance& instance) {
    std::vector<double> largest(instance.primitive->targets.size(), 0.0);
    const Node& node = scene.nodes[static_cast<size_t>(instance.node)];
    const Mesh& mesh = scene.meshes[static_cast<size_t>(node.mesh)];
    const std::vector<float>& rest = node.weights.empty() ? mesh.weights : node.weights;
    for (size_t k = 0; k < largest.size() && k < rest.size(); ++k) largest[k] = std::abs(double(rest[k]));
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels) {
            if (channel.node != instance.node || channel.path != AnimatedPath::Weights) continue;
            double interval = 0;
            for (size_t i = 0; i + 1 < channel.times.size(); ++i)
                interval = std::max(interval, double(channel.times[i + 1]) - double(channel.times[i]));
            // Between two keys a cubic mixes the values with weights that sum to 1 and adds at most 4/27 of
            // each tangent times the interval.
            const bool cubic = channel.interpolation == Interpolation::CubicSpline;
            std::vector<double> values(largest.size(), 0.0), tangents(largest.size(), 0.0);
            for (size_t i = 0; i < channel.values.size(); ++i) {
                const bool tangent = cubic && i / largest.size() % 3 != 1;
                double& bound = (tangent ? tangents : values)[i % largest.size()];
                bound = std::max(bound, std::abs(double(channel.values[i])));
            }
            for (size_t k = 0; k < largest.size(); ++k)
                largest[k] = std::max(largest[k], values[k] + 8.0 / 27.0 * interval * tangents[k]);
        }
    return largest;
}

// The box of some vertices with all their morph displacements at the largest weights.
Box morphedBox(const Primitive& primitive, const std::vector<double>& weights, const auto& wanted) {
    Box box;
    glm::vec3 reach(0);
    for (size_t i = 0; i < primitive.positions.size(); ++i)
        if (wanted(i)) box.add(primitive.positions[i]);
    for (size_t k = 0; k < weights.size(); ++k) {
        glm::vec3 largest(0);
        for (const glm::vec3& displacement : primitive.targets[k].positions)
            largest = glm::max(largest, glm::abs(displacement));
        reach += static_cast<float>(weights[k]) * largest;
    }
    if (box.empty()) return box;
    box.min -= reach;
    box.max += reach;
    return box;
}

void addCorners(Primitive& proxy, const Box& box, std::uint32_t joint, bool skinned) {
    for (int corner = 0; corner < 8 && !box.empty(); ++corner) {
        proxy.positions.emplace_back(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                     corner & 4 ? box.max.z : box.min.z);
        if (!skinned) continue;
        proxy.joints.emplace_back(joint, 0, 0, 0);
        proxy.weights.emplace_back(1, 0, 0, 0);
    }
}

// A primitive of few vertices whose hull contains the primitive's at every pose: a skinned vertex is a convex
// combination of itself as each of its joints carries it, so a box a joint contains it.
Primitive proxyOf(const Scene& scene, const Instance& instance) {
    const Primitive& primitive = *instance.primitive;
    const std::vector<double> weights = largestWeights(scene, instance);
    Primitive proxy;
    if (!instance.skinned) {
        addCorners(proxy, morphedBox(primitive, weights, [](size_t) { return true; }), 0, false);
        return proxy;
    }
    const int skin = scene.nodes[static_cast<size_t>(instance.node)].skin;
    std::vector<Box> boxes(scene.skins[static_cast<size_t>(skin)].joints.size());
    const Box reach = morphedBox(primitive, weights, [](size_t i) { return i == 0; });
    for (size_t i = 0; i < primitive.positions.size(); ++i)
        for (int k = 0; k < 4; ++k) {
            if (primitive.weights[i][k] == 0) continue;
            Box& box = boxes[primitive.joints[i][k]];
            box.add(primitive.positions[i] + (reach.min - primitive.positions[0]));
            box.add(primitive.positions[i] + (reach.max - primitive.positions[0]));
        }
    for (size_t j = 0; j < boxes.size(); ++j)
        addCorners(proxy, boxes[j], static_cast<std::uint32_t>(j), true);
    return proxy;
}

class BoundsGatherer {
public:
    explicit BoundsGatherer(const Scene& scene)
        : scene_(scene)
        , instances_(instancesOf(scene))
        , motion_(instanceMotion(scene, instances_))
        , keys_(keyTimes(scene)) {}

    TimelineBounds gather(const glm::dmat4& rootTransform) {
        chooseSamples();
        paths_.resize(instances_.size());
        for (const Sample& sample : samples_) addPose(poseAt(scene_, sample.time, rootTransform), sample);
        return summary();
    }

private:
    [[nodiscard]] double pointsToMove() const {
        double points = verticesPerNode * static_cast<double>(scene_.nodes.size());
        for (size_t i = 0; i < instances_.size(); ++i)
            if (motion_[i].moves) points += static_cast<double>(instances_[i].primitive->positions.size());
        return points;
    }

    void chooseSamples() {
        const int steps = stepsPerKey(scene_, keys_.size());
        const double count = static_cast<double>(keys_.size()) * (steps + 1);
        if (keys_.empty()) {
            samples_ = {{0, 0}};
            return;
        }
        if (count * pointsToMove() > maxEvaluations) useProxies();
        if (count * pointsToMove() > maxEvaluations) {
            even_ = true;
            samples_ = evenSamples(
                keys_, static_cast<size_t>(std::clamp(maxEvaluations / pointsToMove(), 16.0, count)));
        } else {
            samples_ = samplesBetweenKeys(keys_, steps);
        }
    }

    void useProxies() {
        for (size_t i = 0; i < instances_.size(); ++i) {
            if (!motion_[i].moves || instances_[i].primitive->positions.empty()) continue;
            proxies_.push_back(proxyOf(scene_, instances_[i]));
            instances_[i].primitive = &proxies_.back();
        }
    }

    void addPose(const Pose& pose, const Sample& sample) {
        const bool first = &sample == samples_.data();
        for (size_t i = 0; i < instances_.size(); ++i) {
            if (!first && !motion_[i].moves) continue;
            const Deformation deformation(scene_, pose, instances_[i]);
            std::vector<VertexPath>& paths = paths_[i];
            paths.resize(instances_[i].primitive->positions.size());
            for (size_t v = 0; v < paths.size(); ++v) follow(paths[v], deformation.position(v), sample);
        }
    }

    void follow(VertexPath& path, const glm::dvec3& position, const Sample& sample) const {
        path.box.add(position);
        if (even_ && sample.sinceJump > 0)
            path.widening = glm::max(path.widening, glm::abs(position - path.last));
        if (!even_ && sample.sinceJump > 1)
            path.widening =
                glm::max(path.widening, 0.5 * glm::abs(position - 2.0 * path.last + path.beforeLast));
        path.beforeLast = path.last;
        path.last = position;
    }

    [[nodiscard]] TimelineBounds summary() const {
        DoubleBox box;
        TimelineBounds bounds;
        for (const std::vector<VertexPath>& paths : paths_)
            for (const VertexPath& path : paths) {
                bounds.empty = false;
                box.add(path.box.min - path.widening);
                box.add(path.box.max + path.widening);
            }
        if (bounds.empty) return bounds;
        bounds.min = box.min;
        bounds.max = box.max;
        const glm::dvec3 centre = bounds.centre();
        double squared = 0;
        for (const std::vector<VertexPath>& paths : paths_)
            for (const VertexPath& path : paths) {
                const glm::dvec3 far = glm::max(glm::abs(path.box.min - path.widening - centre),
                                                glm::abs(path.box.max + path.widening - centre));
                squared = std::max(squared, glm::dot(far, far));
            }
        bounds.radius = std::sqrt(squared);
        return bounds;
    }

    const Scene& scene_;
    std::vector<Instance> instances_;
    std::vector<InstanceMotion> motion_;
    std::vector<double> keys_;
    std::vector<Sample> samples_;
    bool even_ = false; // too many keys: even samples, widened by whole steps
    std::list<Primitive> proxies_;
    std::vector<std::vector<VertexPath>> paths_;
};

} // namespace

TimelineBounds timelineBounds(const Scene& scene, const glm::dmat4& rootTransform) {
    return BoundsGatherer(scene).gather(rootTransform);
}

} // namespace kestrel
