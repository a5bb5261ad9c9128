// How a scene is set up for a study: what the user chooses of it and adds to it. It stands in a graph's
// `scene`, at a sweep's scenes, and on the command line; the keys are told once, in setup_keys.cpp. Plain
// data.
#pragma once
#include "core/error.h"
#include "scene/scene.h"
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

// What a camera's path says at one time; what is absent is the camera's.
struct AddedCameraKey {
    double time = 0; // seconds
    std::optional<glm::dvec3> eye, target, up;
    std::optional<double> fov; // vertical, degrees
};

// A camera beside those of the scene. With a node its coordinates are in that node's space, so that it moves
// along; without, in world space.
struct AddedCamera {
    std::string name; // empty: "added"
    // A JSON file with these keys and "kestrel_camera": 1: its values hold where none are given here.
    // Absolute, or relative to the folder of what names it.
    std::string path;
    std::string node;
    // Eye and target must be given, here or by each key; with a node they are its origin and a point along
    // -z. `up` is y, or -z for a look straight up or down.
    std::optional<glm::dvec3> eye, target, up;
    std::optional<double> fov; // vertical, degrees; absent: 45
    // Scene units; absent: a hundredth of the least distance from eye to target, and infinity.
    std::optional<double> nearPlane, farPlane;
    std::string interpolation; // between keys: "linear" (or empty), "smooth"
    std::vector<AddedCameraKey> keys;
};

// A light beside those of the scene; which keys belong to which kind, setup_keys.cpp says. The units are
// those of Light: candela, lux (directional), radiance (rectangle, sphere).
struct AddedLight {
    LightKind kind = LightKind::Point;
    std::string name, node;
    std::optional<glm::dvec3> position, direction, target, up;
    std::optional<glm::dvec3> color; // linear Rec. 709; absent: white
    std::optional<double> intensity; // absent: 1
    std::optional<double> range;
    std::optional<double> innerCone, outerCone;  // half angles, degrees; absent: 0 and 45
    std::optional<double> width, height, radius; // of a rectangle, of a sphere
    Location where = {};
};

struct SceneSetup {
    std::string cameraName;            // a camera of the scene; empty: `camera`, else the scene's first
    std::optional<AddedCamera> camera; // which is taken then
    std::vector<AddedLight> lights;
    std::string animation;           // its name or number, "none", or "all" (also empty)
    std::optional<double> time, fps; // Scene::startTime, Scene::frameRate
};

// Where a camera may be named: whether the text describes one instead, so that parseCamera() reads it.
bool describesCamera(const std::string& text);
// "eye=0,2,0 target=1,2,0 fov=60", or the same as a JSON object. `what` names the text in messages. Throws
// InputError with every mistake.
AddedCamera parseCamera(const std::string& text, const std::string& what);
// "directional direction=0,-1,0 color=1,1,1 intensity=3", the kind first, or a JSON object.
AddedLight parseLight(const std::string& text, const std::string& what);
// For help: the keys with their sentences, a line each.
std::string cameraKeysText();
std::string lightKeysText();

// The setup in which `over` counts where it says something; lights of both.
SceneSetup joined(SceneSetup under, const SceneSetup& over);

// The setup with its camera's path as it is named from anywhere, where it was named from `folder`.
SceneSetup located(SceneSetup setup, const std::filesystem::path& folder);

// The camera as one JSON object in one line, as parseCamera() reads it, and a light as parseLight() does; the
// whole setup without what is as by default.
std::string cameraText(const AddedCamera& camera);
std::string lightText(const AddedLight& light);
std::string setupText(const SceneSetup& setup);

// Loads a scene (see scene.h) and sets it up: Scene::camera is the camera that is taken. A camera's path is
// read as it is named from `folder`. Throws InputError with everything that is wrong with the setup, with
// near names.
Scene loadScene(const std::string& source, const std::filesystem::path& folder, const SceneOptions& options,
                const SceneSetup& setup);

// Sets up a scene that is not finished yet (see finishScene), and finishes it.
void setUpScene(Scene& scene, const SceneSetup& setup, const std::filesystem::path& folder);

} // namespace kestrel
