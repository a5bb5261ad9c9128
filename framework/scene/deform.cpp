#include "scene/deform.h"
#include <algorithm>
#include <cmath>

namespace kestrel {
namespace {

using Displacements = std::vector<glm::vec3> Primitive::MorphTarget::*;

// The unit vector along `v`, or `otherwise` where `v` is too short or too long to have a direction.
glm::dvec3 directionOf(const glm::dvec3& v, const glm::dvec3& otherwise) {
    // The largest component is divided out first, so that squares neither underflow nor overflow.
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0) || !std::isfinite(largest)) return otherwise;
    const glm::dvec3 scaled = v / largest;
    return scaled / std::sqrt(glm::dot(scaled, scaled));
}

// A morph target's vectors of one kind for vertex `i`, weighted and added to `base`.
glm::dvec3 morphed(const glm::vec3& base, size_t i, const auto& targets, Displacements member) {
    glm::dvec3 sum(base);
    for (const auto& active : targets) {
        const std::vector<glm::vec3>& displacements = active.target->*member;
        if (!displacements.empty()) sum += active.weight * glm::dvec3(displacements[i]);
    }
    return sum;
}

bool anyJointMoves(const Skin& skin, const std::vector<bool>& moving) {
    for (const int joint : skin.joints)
        if (moving[static_cast<size_t>(joint)]) return true;
    return false;
}

} // namespace

std::vector<Instance> instancesOf(const Scene& scene) {
    std::vector<Instance> instances;
    for (const int index : nodesInScene(scene)) {
        const Node& node = scene.nodes[static_cast<size_t>(index)];
        if (node.mesh < 0) continue;
        for (const Primitive& primitive : scene.meshes[static_cast<size_t>(node.mesh)].primitives)
            instances.push_back({.node = index,
                                 .primitive = &primitive,
                                 .skinned = node.skin >= 0 && !primitive.joints.empty()});
    }
    return instances;
}

std::vector<InstanceMotion> instanceMotion(const Scene& scene, std::span<const Instance> instances) {
    const std::vector<bool> moving = movingNodes(scene), morphing = morphingNodes(scene);
    std::vector<InstanceMotion> motion;
    motion.reserve(instances.size());
    for (const Instance& instance : instances) {
        const size_t node = static_cast<size_t>(instance.node);
        const bool bends = instance.skinned &&
                           anyJointMoves(scene.skins[static_cast<size_t>(scene.nodes[node].skin)], moving);
        const bool morphs = morphing[node] && !instance.primitive->targets.empty();
        // A skin places its vertices by the joints alone: the node's own transform has no effect
        // (glTF 3.7.3).
        const bool carried = !instance.skinned && moving[node];
        motion.push_back({.moves = bends || morphs || carried, .deforms = bends || morphs});
    }
    return motion;
}

Affine Affine::of(const glm::dmat4& matrix) { return {glm::dmat3(matrix), glm::dvec3(matrix[3])}; }

glm::dmat3 normalMatrix(const glm::dmat3& linear) {
    const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                               glm::cross(linear[0], linear[1]));
    return glm::dot(linear[0], cofactors[0]) < 0 ? -cofactors : cofactors;
}

Deformation::Deformation(const Scene& scene, const Pose& pose, const Instance& instance)
    : primitive_(*instance.primitive) {
    const size_t nodeIndex = static_cast<size_t>(instance.node);
    const std::vector<float>& weights = pose.weights[nodeIndex];
    for (size_t i = 0; i < primitive_.targets.size() && i < weights.size(); ++i)
        if (weights[i] != 0) targets_.push_back({&primitive_.targets[i], double(weights[i])});
    if (instance.skinned) {
        const Skin& skin = scene.skins[static_cast<size_t>(scene.nodes[nodeIndex].skin)];
        joints_.reserve(skin.joints.size());
        for (size_t j = 0; j < skin.joints.size(); ++j)
            joints_.push_back(Affine::of(pose.worlds[static_cast<size_t>(skin.joints[j])] *
                                         glm::dmat4(skin.inverseBind[j])));
    }
    rigid_ = joints_.empty() ? Affine::of(pose.worlds[nodeIndex]) : joints_.front();
    rigidNormal_ = normalMatrix(rigid_.linear);
    mirrors_ = glm::determinant(rigid_.linear) < 0;
}

Affine Deformation::affineAt(size_t i) const {
    Affine blend{glm::dmat3(0), glm::dvec3(0)};
    for (int k = 0; k < 4; ++k) {
        const double weight = double(primitive_.weights[i][k]);
        if (weight == 0) continue;
        const Affine& joint = joints_[primitive_.joints[i][k]];
        blend.linear += weight * joint.linear;
        blend.translation += weight * joint.translation;
    }
    return blend;
}

glm::dvec3 Deformation::position(size_t i) const {
    const glm::dvec3 local =
        morphed(primitive_.positions[i], i, targets_, &Primitive::MorphTarget::positions);
    return joints_.empty() ? rigid_.point(local) : affineAt(i).point(local);
}

void Deformation::normalAndTangent(size_t i, VertexAttributes& out) const {
    const bool rigid = joints_.empty();
    const glm::dmat3 linear = rigid ? rigid_.linear : affineAt(i).linear;
    const glm::dvec3 own = morphed(primitive_.normals[i], i, targets_, &Primitive::MorphTarget::normals);
    const glm::dvec3 fallback = directionOf(glm::dvec3(primitive_.normals[i]), glm::dvec3(0, 0, 1));
    const glm::dvec3 normal = directionOf((rigid ? rigidNormal_ : normalMatrix(linear)) * own, fallback);
    out.normal = glm::vec3(normal);
    if (primitive_.tangents.empty()) return;
    const glm::vec4& tangent = primitive_.tangents[i];
    const glm::dvec3 along =
        linear * morphed(glm::vec3(tangent), i, targets_, &Primitive::MorphTarget::tangents);
    const glm::dvec3 unit = directionOf(along, glm::dvec3(0));
    const glm::dvec3 flat = directionOf(unit - glm::dot(unit, normal) * normal, glm::dvec3(0));
    const bool lost = flat == glm::dvec3(0);
    const double handedness = double(tangent.w) * (glm::determinant(linear) < 0 ? -1 : 1);
    out.tangent = glm::vec4(flat, lost ? 0.0 : handedness);
}

} // namespace kestrel
