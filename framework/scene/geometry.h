// The scene flattened at one time: triangles in world space relative to Scene::origin ("render space"), what
// every rasterizer and ray tracer reads. Instances, skins and morph targets are resolved here, on the CPU,
// once a frame.
#pragma once
#include "scene/bounds.h"
#include "scene/scene.h"
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace kestrel {

// Everything of a vertex but its position, in render space.
struct VertexAttributes {
    glm::vec3 normal{0, 0, 1}; // unit
    glm::vec4 tangent{0};      // w = 0: none
    glm::vec2 texCoord{0}, texCoord1{0};
    glm::vec4 colour{1}; // linear
};

// Triangles are sorted by class so that one draw call serves a class.
enum class TriangleClass : std::uint8_t {
    Opaque,            // back faces may be culled
    OpaqueDoubleSided, //
    Masked,            // alpha test; treated as double-sided where the material says so
    MaskedDoubleSided,
    Count
};

struct Geometry {
    std::vector<glm::vec3> positions;         // render space
    std::vector<glm::vec3> previousPositions; // at the previous frame's time; empty if nothing moves
    std::vector<VertexAttributes> attributes; // as long as positions
    std::vector<std::uint32_t> indices;   // 3 a triangle; winding is counter-clockwise seen from the front,
                                          // also under mirroring transforms
    std::vector<std::uint32_t> materials; // one a triangle: index into the scene's materials (the default
                                          // material is appended by flatten() as the last one)
    struct Range {
        std::uint32_t first = 0, count = 0; // in triangles, unless said otherwise
    };
    Range ranges[static_cast<size_t>(TriangleClass::Count)];
    // The vertices (first, count) that differ from one time of the scene to another; those between never do.
    std::vector<Range> moving;
    // The vertices (first, count) of each instance of a mesh's primitive, in the order of vertices.
    std::vector<Range> instances;
    // Counts the frames in which an instance began or ended to be mirrored: with another number, `indices`
    // differ.
    std::uint32_t turns = 0;
    Box bounds; // of this frame

    [[nodiscard]] std::uint32_t triangleCount() const {
        return static_cast<std::uint32_t>(indices.size() / 3);
    }
};

// Index of the first triangle that needs an alpha test; triangles are sorted by class. The count if none
// does.
[[nodiscard]] inline std::uint32_t firstMaskedTriangle(const Geometry& geometry) {
    const auto count = [&](TriangleClass c) { return geometry.ranges[static_cast<size_t>(c)].count; };
    return geometry.triangleCount() - count(TriangleClass::Masked) - count(TriangleClass::MaskedDoubleSided);
}

// A camera at one time, relative to Scene::origin.
struct CameraState {
    glm::mat4 view{1};     // render space to eye space (looking along -z)
    glm::vec3 position{0}; // render space
    bool orthographic = false;
    float verticalFov = 0.8f, halfHeight = 1, aspect = 0, nearPlane = 0.01f, farPlane = 100;
    // Reversed-z projection: near plane to depth 1, far plane (or infinity) to 0; depth range [0, 1].
    // `frameAspect`: width / height. What the camera's own `aspect` frames is seen whole.
    [[nodiscard]] glm::mat4 projection(float frameAspect) const;
    friend bool operator==(const CameraState&, const CameraState&) = default;
};

// A light at one time, relative to Scene::origin.
struct LightState {
    LightKind kind = LightKind::Point;
    glm::vec3 position{0}, direction{0, 0, -1};     // direction of shining, unit
    glm::vec3 tangent{1, 0, 0}, bitangent{0, 1, 0}; // of a rectangle
    glm::vec3 intensity{1};                         // colour times intensity
    float range = 0, innerCone = 0, outerCone = 0.785398f;
    glm::vec2 halfSize{0};
    friend bool operator==(const LightState&, const LightState&) = default;
};

// The materials that Geometry::materials indexes: the scene's, then glTF's default material.
std::vector<Material> flattenedMaterials(const Scene& scene);

// Flattens at `time` seconds (clamped to the timeline, looping is the caller's). Triangles with a NaN or
// infinite position are refused on import, so there are none here; degenerate ones are kept. Throws
// InputError above maxTriangles or maxVertices (an instance counts each time). The order of vertices and
// triangles does not depend on the time.
inline constexpr std::uint64_t maxTriangles = 64'000'000;
inline constexpr std::uint64_t maxVertices = 64'000'000;
Geometry flatten(const Scene& scene, double time);
// As flatten(), filling `previousPositions` from `previousTime` where anything moves.
Geometry flatten(const Scene& scene, double time, double previousTime);

// flatten() for one frame after another: what does not move is computed once, so a frame costs what moves.
// The results equal flatten()'s to the bit.
class Flattener {
public:
    // Lays out vertices and triangles. `scene` must outlive the Flattener and must not change under it.
    explicit Flattener(const Scene& scene);
    Flattener(Flattener&&) noexcept;
    Flattener& operator=(Flattener&&) noexcept;
    ~Flattener();
    // The reference is valid until the next call.
    const Geometry& at(double time);
    const Geometry& at(double time, double previousTime);
    // The result of the last call; the Flattener is spent then.
    [[nodiscard]] Geometry take() &&;

private:
    struct State;
    std::unique_ptr<State> state_;
};

// The camera at `time`. A mirroring or scaling node above it does not mirror or scale the picture; the scale
// of Scene::rootTransform multiplies the near and far plane and the half height.
CameraState cameraAt(const Scene& scene, int camera, double time);
// The lights at `time`, in the order of Scene::lights. The scale s of Scene::rootTransform multiplies range
// and size, and by s * s the candela of Point and Spot, so that a scaled scene is lit alike.
std::vector<LightState> lightsAt(const Scene& scene, double time);
// Index of the camera of that name; of a number that is no camera's name: itself, from 0; empty:
// Scene::camera.
// Throws InputError with the near name and the names there are.
int cameraIndex(const Scene& scene, const std::string& name);

} // namespace kestrel
