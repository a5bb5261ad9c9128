// Where the vertices of one instance stand at one time: morph targets, then the skin or the node's transform.
// All in double precision; the caller rounds after it has subtracted the scene's origin.
#pragma once
#include "scene/animation.h"
#include "scene/geometry.h"
#include "scene/scene.h"
#include <span>
#include <vector>

namespace kestrel {

// A primitive under a node. One mesh under several nodes gives several instances.
struct Instance {
    int node = -1;
    const Primitive* primitive = nullptr;
    bool skinned = false; // the node has a skin and the primitive has joints
};

// The instances that are drawn, in the order of nodesInScene() and of the mesh's primitives.
std::vector<Instance> instancesOf(const Scene& scene);

// One an instance: whether its vertices move along the timeline, and whether they do so against each other.
struct InstanceMotion {
    bool moves = false, deforms = false;
};
std::vector<InstanceMotion> instanceMotion(const Scene& scene, std::span<const Instance> instances);

// An affine map of world space.
struct Affine {
    glm::dmat3 linear{1};
    glm::dvec3 translation{0};
    [[nodiscard]] glm::dvec3 point(const glm::dvec3& p) const { return linear * p + translation; }
    static Affine of(const glm::dmat4& matrix);
};

// The matrix that takes normals along with `linear`: the cofactors with the determinant's sign, which is the
// inverse transpose up to a positive factor and stays finite for singular matrices.
glm::dmat3 normalMatrix(const glm::dmat3& linear);

// The vertices of one instance at one pose. Valid as long as scene and pose are.
class Deformation {
public:
    Deformation(const Scene& scene, const Pose& pose, const Instance& instance);

    // Vertex `i` in world space.
    [[nodiscard]] glm::dvec3 position(size_t i) const;
    // Normal (unit) and tangent of vertex `i` in world space; other members are left. A normal that the
    // transform squeezes to nothing stays as it is in the mesh; such a tangent gets w = 0.
    void normalAndTangent(size_t i, VertexAttributes& out) const;
    // Whether triangles change their winding.
    [[nodiscard]] bool mirrors() const { return mirrors_; }

private:
    struct ActiveTarget {
        const Primitive::MorphTarget* target;
        double weight;
    };
    [[nodiscard]] Affine affineAt(size_t i) const;

    const Primitive& primitive_;
    std::vector<ActiveTarget> targets_;
    std::vector<Affine> joints_; // empty: rigid
    Affine rigid_;
    glm::dmat3 rigidNormal_{1};
    bool mirrors_ = false;
};

} // namespace kestrel
