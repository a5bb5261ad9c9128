// The nodes of a scene at one time: interpolation of animation channels, local and world transforms.
#pragma once
#include "scene/scene.h"
#include <vector>

namespace kestrel {

// What animations and hierarchy make of the nodes at one time.
struct Pose {
    std::vector<glm::dmat4> worlds; // one a node: node space to world space, Scene::rootTransform included
    // One a node: the weights of its mesh's morph targets, empty where the mesh has none.
    std::vector<std::vector<float>> weights;
};

// The pose at `time` seconds. Each channel holds its first value before its first key and its last after its
// last (glTF 2.0, appendix C). Where several channels drive one property, the last one wins.
Pose poseAt(const Scene& scene, double time);
// With another transform in the place of Scene::rootTransform.
Pose poseAt(const Scene& scene, double time, const glm::dmat4& rootTransform);

// The channel's value at `time`: 3, 4 (x y z w, unit) or the number of weights. Step, linear (spherical for
// rotations, along the shorter arc) and cubic Hermite interpolation as in glTF 2.0, appendix C.
std::vector<double> sampleChannel(const AnimationChannel& channel, double time);

// Whether the channel's value changes along the timeline.
bool channelVaries(const AnimationChannel& channel);

// One a node: whether its world transform changes along the timeline.
std::vector<bool> movingNodes(const Scene& scene);

// One a node: whether its morph weights change along the timeline.
std::vector<bool> morphingNodes(const Scene& scene);

// The nodes of the scene graph that hangs on Scene::roots, parents before children, depth first.
std::vector<int> nodesInScene(const Scene& scene);

// The transform of a node without animation, relative to its parent.
glm::dmat4 localMatrix(const Node& node);

// All distinct key times of channels that vary, rising. Empty if nothing is animated.
std::vector<double> keyTimes(const Scene& scene);

} // namespace kestrel
