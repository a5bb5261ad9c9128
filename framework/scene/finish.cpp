// Completing a scene: flat normals, tangents, origin, a default camera.
#include "core/error.h"
#include "scene/camera_names.h"
#include "scene/geometry.h"
#include "scene/scene.h"
#include "scene/timeline_bounds.h"
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numeric>

namespace kestrel {
namespace {

template<class T>
void gather(std::vector<T>& attribute, const std::vector<std::uint32_t>& vertices) {
    if (attribute.empty()) return;
    std::vector<T> gathered;
    gathered.reserve(vertices.size());
    for (const std::uint32_t vertex : vertices) gathered.push_back(attribute[vertex]);
    attribute = std::move(gathered);
}

// Makes `vertices` (of the present ones, each as often as wanted) the vertices of the primitive; the indices
// are the caller's.
void gatherVertices(Primitive& primitive, const std::vector<std::uint32_t>& vertices) {
    gather(primitive.positions, vertices);
    gather(primitive.normals, vertices);
    gather(primitive.tangents, vertices);
    gather(primitive.texCoords, vertices);
    gather(primitive.texCoords1, vertices);
    gather(primitive.colours, vertices);
    gather(primitive.joints, vertices);
    gather(primitive.weights, vertices);
    for (Primitive::MorphTarget& target : primitive.targets) {
        gather(target.positions, vertices);
        gather(target.normals, vertices);
        gather(target.tangents, vertices);
    }
}

// Vertices without a triangle would widen the bounds and cost time each frame.
void dropUnusedVertices(Primitive& primitive) {
    constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> newIndex(primitive.positions.size(), unused), kept;
    for (const std::uint32_t index : primitive.indices) newIndex[index] = 0;
    for (std::uint32_t i = 0; i < newIndex.size(); ++i) {
        if (newIndex[i] == unused) continue;
        newIndex[i] = static_cast<std::uint32_t>(kept.size());
        kept.push_back(i);
    }
    if (kept.size() == primitive.positions.size()) return;
    gatherVertices(primitive, kept);
    for (std::uint32_t& index : primitive.indices) index = newIndex[index];
}

// Gives each triangle three vertices of its own, with its normal.
void makeFlatNormals(Primitive& primitive) {
    const std::vector<std::uint32_t> corners = primitive.indices;
    gatherVertices(primitive, corners);
    std::iota(primitive.indices.begin(), primitive.indices.end(), 0u);
    primitive.flatNormals = true;
    primitive.tangents.clear();
    // Displacements of normals that the mesh does not have displace nothing.
    for (Primitive::MorphTarget& target : primitive.targets) {
        target.normals.clear();
        target.tangents.clear();
    }
    primitive.normals.assign(primitive.positions.size(), glm::vec3(0, 0, 1));
    for (size_t i = 0; i + 2 < primitive.positions.size(); i += 3) {
        const glm::dvec3 a(primitive.positions[i]);
        const glm::dvec3 cross = glm::cross(glm::dvec3(primitive.positions[i + 1]) - a,
                                            glm::dvec3(primitive.positions[i + 2]) - a);
        const double length = std::sqrt(glm::dot(cross, cross));
        for (size_t k = 0; k < 3 && length > 0; ++k) primitive.normals[i + k] = glm::vec3(cross / length);
    }
}

bool needsTangents(const Scene& scene, const Primitive& primitive) {
    return primitive.tangents.empty() && primitive.material >= 0 &&
           scene.materials[static_cast<size_t>(primitive.material)].normalTexture.present();
}

// A unit vector at a right angle to `normal`, which is unit.
glm::dvec3 anyTangent(const glm::dvec3& normal) {
    const glm::dvec3 axis = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(glm::cross(axis, normal));
}

// Tangents along the texture's u direction, summed over a vertex's triangles and made orthogonal to the
// normal (E. Lengyel, "Computing Tangent Space Basis Vectors for an Arbitrary Mesh", 2001). The bitangent
// runs up in the picture, against v: what a normal map calls +y (glTF 2.0, normalTexture) while v counts from
// the top.
void makeTangents(Primitive& primitive, int texCoordSet) {
    const std::vector<glm::vec2>& uv = texCoordSet == 1 ? primitive.texCoords1 : primitive.texCoords;
    const size_t count = primitive.positions.size();
    std::vector<glm::dvec3> alongU(count, glm::dvec3(0)), alongV(count, glm::dvec3(0));
    for (size_t i = 0; i + 2 < primitive.indices.size() && !uv.empty(); i += 3) {
        const std::uint32_t* corner = primitive.indices.data() + i;
        const glm::dvec3 origin(primitive.positions[corner[0]]);
        const glm::dvec3 e1 = glm::dvec3(primitive.positions[corner[1]]) - origin;
        const glm::dvec3 e2 = glm::dvec3(primitive.positions[corner[2]]) - origin;
        const glm::dvec2 d1 = glm::dvec2(uv[corner[1]]) - glm::dvec2(uv[corner[0]]);
        const glm::dvec2 d2 = glm::dvec2(uv[corner[2]]) - glm::dvec2(uv[corner[0]]);
        const double determinant = d1.x * d2.y - d2.x * d1.y;
        if (determinant == 0) continue;
        const glm::dvec3 u = (e1 * d2.y - e2 * d1.y) / determinant;
        const glm::dvec3 v = (e2 * d1.x - e1 * d2.x) / determinant;
        for (int k = 0; k < 3; ++k) {
            alongU[corner[k]] += u;
            alongV[corner[k]] += v;
        }
    }
    primitive.tangents.resize(count);
    for (size_t i = 0; i < count; ++i) {
        const glm::dvec3 normal(primitive.normals[i]);
        const glm::dvec3 flat = alongU[i] - glm::dot(alongU[i], normal) * normal;
        const double length = std::sqrt(glm::dot(flat, flat));
        const bool usable = length > 0 && std::isfinite(length);
        const glm::dvec3 tangent = usable ? flat / length : anyTangent(normal);
        const double handedness = glm::dot(glm::cross(normal, tangent), alongV[i]) > 0 ? -1 : 1;
        primitive.tangents[i] = glm::vec4(glm::vec3(tangent), static_cast<float>(handedness));
    }
}

void completePrimitives(Scene& scene) {
    for (Mesh& mesh : scene.meshes)
        for (Primitive& primitive : mesh.primitives) {
            dropUnusedVertices(primitive);
            if (primitive.normals.empty() && !primitive.positions.empty()) makeFlatNormals(primitive);
            if (needsTangents(scene, primitive))
                makeTangents(primitive,
                             scene.materials[static_cast<size_t>(primitive.material)].normalTexture.texCoord);
        }
}

// A camera to the front, the right and above that sees the whole of the bounds, in square frames too.
// `bounds` are those without rootTransform, below which the camera hangs like everything else.
void addDefaultCamera(Scene& scene, const TimelineBounds& bounds) {
    constexpr double fov = 0.8;
    const glm::dvec3 centre = bounds.centre();
    const glm::dvec3 away = glm::normalize(glm::dvec3(0.6, 0.45, 1.0));
    const glm::dmat3 axes = glm::transpose(glm::dmat3(glm::lookAt(away, glm::dvec3(0), glm::dvec3(0, 1, 0))));
    const double unit = bounds.radius > 0 ? bounds.radius : 1;
    // How far the eye must stand off for each corner of the box, on the axes of the camera, to be in view.
    double distance = 0.5 * unit, nearest = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 corner((i & 1) != 0 ? bounds.max.x : bounds.min.x,
                                (i & 2) != 0 ? bounds.max.y : bounds.min.y,
                                (i & 4) != 0 ? bounds.max.z : bounds.min.z);
        const glm::dvec3 seen = glm::transpose(axes) * (corner - centre);
        nearest = std::max(nearest, seen.z);
        distance =
            std::max(distance, seen.z + std::max(std::abs(seen.x), std::abs(seen.y)) / std::tan(0.5 * fov));
    }
    distance *= 1.05;
    const glm::dvec3 eye = centre + distance * away;
    Node node;
    node.name = "default";
    node.translation = eye;
    node.rotation = glm::quat_cast(axes);
    node.camera = static_cast<int>(scene.cameras.size());
    Camera camera;
    camera.name = "default";
    camera.verticalFov = static_cast<float>(fov);
    // A little more than the box, so that rounding cuts nothing off.
    camera.nearPlane = static_cast<float>(0.5 * (distance - nearest));
    camera.farPlane = static_cast<float>(2 * (distance + unit));
    camera.node = static_cast<int>(scene.nodes.size());
    scene.roots.push_back(camera.node);
    scene.nodes.push_back(std::move(node));
    scene.cameras.push_back(std::move(camera));
}

} // namespace

void finishScene(Scene& scene) {
    completePrimitives(scene);
    const TimelineBounds bounds = timelineBounds(scene, scene.rootTransform);
    // Squared lengths of render-space vectors stay inside float.
    constexpr double largest = 1e18;
    if (!bounds.empty && !(bounds.radius < largest))
        throw InputError(
            Location{scene.source},
            fmt::format("the transforms of the nodes take vertices {:g} away from each other; at "
                        "most {:g} is drawn",
                        bounds.radius, largest));
    scene.origin = bounds.empty ? glm::dvec3(scene.rootTransform[3]) : bounds.centre();
    nameCamerasApart(scene.cameras);
    if (!scene.cameras.empty()) return;
    const glm::dmat4 identity(1);
    addDefaultCamera(scene, scene.rootTransform == identity ? bounds : timelineBounds(scene, identity));
}

} // namespace kestrel
