// A scene as a document: nodes, meshes, materials, cameras, lights, animations. Plain data, no GL.
// What is drawn and traced at one time is the flattened Geometry (geometry.h).
#pragma once
#include "scene/bounds.h"
#include "scene/material.h"
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

// One triangle list with one material. Attribute vectors are empty or as long as `positions`.
struct Primitive {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3>
        normals; // unit; generated (flat, as glTF asks) by finishScene() where there are none
    std::vector<glm::vec4>
        tangents; // w is the handedness; empty unless the file has them or a normal map needs them
    std::vector<glm::vec2> texCoords; // TEXCOORD_0
    std::vector<glm::vec2> texCoords1;
    std::vector<glm::vec4> colours; // linear COLOR_0
    std::vector<glm::uvec4> joints;
    std::vector<glm::vec4> weights;     // sum to 1
    std::vector<std::uint32_t> indices; // 3 a triangle
    int material = -1;                  // -1: glTF's default material
    // Set where finishScene() generated the normals: triangle i then has the vertices 3i, 3i+1, 3i+2 for
    // itself, and flattening takes the normal from the deformed triangle, as glTF asks under morphs and
    // skins.
    bool flatNormals = false;
    struct MorphTarget { // displacements; empty or as long as positions
        std::vector<glm::vec3> positions, normals, tangents;
        friend bool operator==(const MorphTarget&, const MorphTarget&) = default;
    };
    std::vector<MorphTarget> targets;
    friend bool operator==(const Primitive&, const Primitive&) = default;
};

struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    std::vector<float> weights; // default morph weights
    friend bool operator==(const Mesh&, const Mesh&) = default;
};

struct Skin {
    std::string name;
    std::vector<int> joints;            // node indices
    std::vector<glm::mat4> inverseBind; // one a joint
    friend bool operator==(const Skin&, const Skin&) = default;
};

// Where a camera stands and looks at one time, in the space of its node.
struct CameraKey {
    double time = 0; // seconds
    glm::dvec3 eye{0}, target{0, 0, -1}, up{0, 1, 0};
    double verticalFov = 0.8; // radians
    friend bool operator==(const CameraKey&, const CameraKey&) = default;
};

// A pinhole camera. It looks along -z of its node, y up, or as its path says.
struct Camera {
    std::string name;
    bool orthographic = false;
    float verticalFov = 0.8f;                // radians, perspective
    float aspect = 0;                        // width / height; 0: that of the frame
    float halfHeight = 1;                    // orthographic
    float nearPlane = 0.01f, farPlane = 100; // in scene units; far <= 0: infinite
    int node = -1;
    // Strictly rising times; the first holds before, the last after. Its fields of view replace verticalFov.
    std::vector<CameraKey> path = {};
    bool smooth = false; // between keys a cubic curve through them (Catmull-Rom), else straight lines
    friend bool operator==(const Camera&, const Camera&) = default;
};

enum class LightKind : std::uint8_t { Point, Spot, Directional, Rectangle, Sphere };

// KHR_lights_punctual kinds, plus rectangle and sphere area lights of the built-in scenes (extras in the
// exported file). A light shines along -z of its node. Intensity: candela for Point and Spot, lux for
// Directional, radiance for the area kinds.
struct Light {
    std::string name;
    LightKind kind = LightKind::Point;
    glm::vec3 colour{1};
    float intensity = 1;
    float range = 0;                            // 0: infinite
    float innerCone = 0, outerCone = 0.785398f; // radians
    glm::vec2 halfSize{0};                      // rectangle: half extents along x and y; sphere: radius in x
    int node = -1;
    friend bool operator==(const Light&, const Light&) = default;
};

// A node. Transforms are double: a scene may stand far from the origin (see Scene::origin).
struct Node {
    std::string name;
    int parent = -1;
    std::vector<int> children;
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
    std::optional<glm::dmat4> matrix; // replaces translation, rotation, scale where the file gives one
    int mesh = -1, skin = -1, camera = -1, light = -1;
    std::vector<float> weights; // morph weights, empty: the mesh's
    friend bool operator==(const Node&, const Node&) = default;
};

enum class Interpolation : std::uint8_t { Step, Linear, CubicSpline };
enum class AnimatedPath : std::uint8_t { Translation, Rotation, Scale, Weights };

struct AnimationChannel {
    int node = -1;
    AnimatedPath path = AnimatedPath::Translation;
    Interpolation interpolation = Interpolation::Linear;
    std::vector<float> times;  // seconds, strictly rising
    std::vector<float> values; // components a key: 3, 4 (x y z w) or the number of weights; three times that
                               // for CubicSpline (in-tangent, value, out-tangent)
    friend bool operator==(const AnimationChannel&, const AnimationChannel&) = default;
};

struct Animation {
    std::string name;
    std::vector<AnimationChannel> channels;
    friend bool operator==(const Animation&, const Animation&) = default;
};

struct Scene {
    std::string name;   // "builtin:tower", or the file's name without its folder
    std::string source; // what --scene was given
    std::vector<Node> nodes;
    std::vector<int> roots;
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<TextureImage> images;
    std::vector<Skin> skins;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    std::vector<Animation> animations;
    std::vector<std::string> warnings; // what the file asks for and Kestrel lacks, each named once
    // Multiplied in front of all roots, in double precision: scaling, moving, turning a whole scene (stress
    // cases). Its scale acts on lengths of cameras and lights too (see cameraAt(), lightsAt()), so that a
    // scaled scene gives the same picture; the scale of other nodes does not, as glTF says.
    glm::dmat4 rootTransform{1};
    // World-space point that all float coordinates (Geometry, cameras, lights on the GPU) are relative to:
    // the centre of the bounds over the whole timeline. Set by finishScene().
    glm::dvec3 origin{0};
    int camera = 0;        // the one that is taken where nobody names one
    double startTime = 0;  // seconds: the time of the first frame
    double frameRate = 60; // frames a second of its time

    // Seconds from 0 to the last key of any animation or camera's path; 0 if nothing is animated. All
    // animations play together (SceneSetup::animation chooses one).
    [[nodiscard]] double duration() const;
};

// Completes a scene after loading or building: drops vertices that no triangle uses, makes flat normals where
// a primitive has none and tangents where a normal map needs them, `origin` from the bounds over the
// timeline, names that tell the cameras apart, and a camera that frames the scene ("default") where there is
// none. Idempotent; call it again after a change of rootTransform. Throws
// InputError where the transforms take a vertex out of the range of float.
void finishScene(Scene& scene);

// How a scene is loaded.
struct SceneOptions {
    // A scene file may come from a stranger: the buffers and images that it names are read inside its folder
    // only, unless this is set.
    bool allowOutside = false;
};

// Loads "builtin:NAME", "builtin:NAME?detail=0.1" or a .gltf/.glb file. A relative file name is relative to
// `folder`. Throws InputError (one line: unknown name with the near one; every way a file can be bad).
Scene loadScene(const std::string& source, const std::filesystem::path& folder = {},
                const SceneOptions& options = {});

} // namespace kestrel
