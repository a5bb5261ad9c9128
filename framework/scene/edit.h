// Changes of a whole scene for stress cases: what must not matter (scale, place, turn, order of triangles),
// and what is hard (cameras, lights and materials at their ends). Plain data.
#pragma once
#include "scene/scene.h"
#include <optional>
#include <vector>

namespace kestrel {

// A light beside those of the scene, by the scene's own size.
struct EditLight {
    enum class Where : std::uint8_t {
        Place,     // at `place`
        OnSurface, // on the middle of the scene's first triangle
        InWall     // a thousandth of the scene's radius behind it
    };
    LightKind kind = LightKind::Point;
    Where where = Where::Place;
    glm::dvec3 place{0}; // from the centre of the scene's bounds, in radii
    // Irradiance that it makes at the centre of the scene, were it in sight: candela and radiance follow from
    // it.
    double irradiance = 3;
    double size = 0.05; // radius of a sphere, half side of a rectangle, in radii of the scene
    friend bool operator==(const EditLight&, const EditLight&) = default;
};

struct SceneEdit {
    // As a whole, in front of Scene::rootTransform: first turned and mirrored, then scaled, then moved.
    glm::dvec3 turn{0};  // degrees about x, then y, then z
    bool mirror = false; // x becomes -x
    double scale = 1;
    glm::dvec3 move{0}; // in radii of the scaled scene

    enum class Triangles : std::uint8_t {
        AsTheyAre,
        Reversed, // the same ones in the opposite order
        Doubled,  // each twice
        Halved,   // every second one is left out: open surfaces
        InsideOut // windings and normals turned round
    };
    Triangles triangles = Triangles::AsTheyAre;
    int split = 1; // each triangle into so many times so many
    // One more triangle, a thousandth of the scene's radius wide, so that the middle of all lies so many
    // radii away from that of the scene: its coordinates as shaders see them are that large. 0: none.
    double offCentre = 0;

    // Every camera. The planes: `nearFactor` times the near plane, then the far plane where it is asked for.
    std::optional<double> fov = {}; // degrees
    double nearFactor = 1;
    std::optional<double> farOverNear = {}; // 0: infinite
    std::optional<glm::dvec3> eye = {};     // looks from here to the centre; radii from the centre
    bool orthographic = false;              // sees what it saw of the centre; the far plane becomes finite

    // Every material.
    std::optional<float> roughness = {}, metallic = {}, alphaCutoff = {}; // a cutoff makes them masked
    std::optional<glm::vec3> albedo = {}, emission = {};                  // textures of them are dropped

    double intensity = 1; // of every light
    bool dropLights = false;
    std::vector<EditLight> lights = {};
    bool dropAnimations = false;
    // Lights are there in frames 0, 2, 4, … and far away (directional ones turned round) in those between,
    // for `blinkFrames` frames of 1/60 s; then they stay. Only with dropAnimations.
    int blinkFrames = 0;

    friend bool operator==(const SceneEdit&, const SceneEdit&) = default;
};

// Changes the scene and finishes it anew (finishScene). Throws InputError as finishScene() and splitting do.
void editScene(Scene& scene, const SceneEdit& edit);

} // namespace kestrel
