// Changes of a whole scene: what they do to geometry, cameras and lights, and what they leave.
#include "core/error.h"
#include "scene/builtin.h"
#include "scene/builtin/stress_scenes.h"
#include "scene/edit.h"
#include "scene/facts.h"
#include "scene/geometry.h"
#include <algorithm>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

Scene edited(const std::string& source, const SceneEdit& edit) {
    Scene scene = loadScene(source);
    editScene(scene, edit);
    return scene;
}

const std::string blob = "builtin:blob?detail=0.02";

// A position as the camera sees it, on the picture.
glm::vec3 onPicture(const Scene& scene, const glm::vec3& position) {
    const CameraState camera = cameraAt(scene, scene.camera, 0);
    const glm::vec4 clip = camera.projection(1.5f) * camera.view * glm::vec4(position, 1);
    return glm::vec3(clip) / clip.w;
}

TEST(SceneEdit, NothingChangesNothing) {
    const Geometry plain = flatten(loadScene(blob), 0), same = flatten(edited(blob, {}), 0);
    EXPECT_EQ(plain.positions, same.positions);
    EXPECT_EQ(plain.indices, same.indices);
}

TEST(SceneEdit, WhatIsScaledMovedAndTurnedLooksAlike) {
    const Scene plain = loadScene(blob);
    const Geometry before = flatten(plain, 0);
    for (const SceneEdit& edit :
         {SceneEdit{.scale = 1e-6}, SceneEdit{.scale = 1e6}, SceneEdit{.move = {7e5, -5e5, 1e5}},
          SceneEdit{.turn = {31, 57, 23}}, SceneEdit{.turn = {0, 0, 180}, .scale = 0.1, .move = {1, 2, 3}}}) {
        const Scene scene = edited(blob, edit);
        const Geometry after = flatten(scene, 0);
        ASSERT_EQ(after.positions.size(), before.positions.size());
        for (size_t i = 0; i < after.positions.size(); i += 37) {
            const glm::vec3 a = onPicture(plain, before.positions[i]),
                            b = onPicture(scene, after.positions[i]);
            EXPECT_LE(glm::distance(a, b), 3e-5f) << i;
        }
    }
}

TEST(SceneEdit, TheMirroredSceneIsSeenLeftForRight) {
    const Scene plain = loadScene(blob), scene = edited(blob, {.turn = {0, 57, 0}, .mirror = true});
    const Geometry before = flatten(plain, 0), after = flatten(scene, 0);
    for (size_t i = 0; i < after.positions.size(); i += 37) {
        const glm::vec3 a = onPicture(plain, before.positions[i]), b = onPicture(scene, after.positions[i]);
        EXPECT_LE(glm::distance(glm::vec3(-a.x, a.y, a.z), b), 3e-5f) << i;
    }
}

TEST(SceneEdit, TrianglesComeInTheOppositeOrderTwiceOrHalved) {
    const auto trianglesOf = [](const Scene& scene) {
        const Geometry geometry = flatten(scene, 0);
        std::vector<glm::vec3> centres;
        for (size_t i = 0; i + 2 < geometry.indices.size(); i += 3)
            centres.push_back(geometry.positions[geometry.indices[i]] +
                              geometry.positions[geometry.indices[i + 1]] +
                              geometry.positions[geometry.indices[i + 2]]);
        return centres;
    };
    const std::string source = "builtin:stress_layers?count=5";
    const std::vector<glm::vec3> plain = trianglesOf(loadScene(source));
    ASSERT_EQ(plain.size(), 10u);
    std::vector<glm::vec3> reversed =
        trianglesOf(edited(source, {.triangles = SceneEdit::Triangles::Reversed}));
    std::ranges::reverse(reversed);
    ASSERT_EQ(reversed.size(), plain.size());
    for (size_t i = 0; i < plain.size(); ++i) EXPECT_LE(glm::distance(plain[i], reversed[i]), 1e-6f);
    EXPECT_EQ(trianglesOf(edited(source, {.triangles = SceneEdit::Triangles::Doubled})).size(), 20u);
    EXPECT_EQ(trianglesOf(edited(source, {.triangles = SceneEdit::Triangles::Halved})).size(), 5u);
    EXPECT_EQ(trianglesOf(edited(source, {.split = 3})).size(), 90u);
    const Scene insideOut = edited(source, {.triangles = SceneEdit::Triangles::InsideOut});
    for (const VertexAttributes& vertex : flatten(insideOut, 0).attributes)
        EXPECT_NEAR(vertex.normal.z, -1, 1e-6f);
}

TEST(SceneEdit, CamerasLightsAndMaterialsAreSet) {
    const Scene scene =
        edited(blob, {.fov = 170,
                      .nearFactor = 1e-3,
                      .farOverNear = 1e6,
                      .roughness = 0.0f,
                      .emission = glm::vec3(2),
                      .dropLights = true,
                      .lights = {{.kind = LightKind::Sphere, .place = {0, 2, 0}, .irradiance = 5}}});
    const CameraState camera = cameraAt(scene, scene.camera, 0),
                      before = cameraAt(loadScene(blob), scene.camera, 0);
    EXPECT_NEAR(camera.verticalFov, glm::radians(170.0f), 1e-5f);
    EXPECT_NEAR(camera.nearPlane / before.nearPlane, 1e-3f, 1e-8f);
    EXPECT_NEAR(camera.farPlane / camera.nearPlane, 1e6f, 1);
    ASSERT_EQ(scene.lights.size(), 1u);
    const LightState light = lightsAt(scene, 0).front();
    const float distance = glm::length(light.position);
    // Irradiance of a far sphere at the centre: its radiance times its solid angle.
    EXPECT_NEAR(light.intensity.x * glm::pi<float>() * std::pow(light.halfSize.x / distance, 2.0f), 5, 0.05f);
    for (const Material& material : scene.materials) {
        EXPECT_EQ(material.roughness, 0);
        EXPECT_EQ(material.emission, glm::vec3(2));
    }
    const Scene flat = edited(blob, {.orthographic = true});
    EXPECT_TRUE(cameraAt(flat, flat.camera, 0).orthographic);
    EXPECT_GT(cameraAt(flat, flat.camera, 0).farPlane, 0);
}

TEST(SceneEdit, LightsThatBlinkAreThereInEverySecondFrame) {
    const Scene scene =
        edited(blob, {.lights = {{.place = {0, 2, 0}}}, .dropAnimations = true, .blinkFrames = 8});
    ASSERT_EQ(scene.lights.size(), 1u);
    const LightState first = lightsAt(scene, 0).front();
    for (int frame = 0; frame < 12; ++frame) {
        const LightState light = lightsAt(scene, frame / 60.0).front();
        EXPECT_EQ(light == first, frame % 2 == 0 || frame > 8) << frame;
    }
}

TEST(StressScenes, AreBuiltAsTheirNamesSay) {
    for (const builtin::StressScene& entry : builtin::stressScenes()) {
        const std::string source = "builtin:stress_" + std::string(entry.name);
        const Scene scene = loadScene(source);
        EXPECT_FALSE(scene.cameras.empty()) << source;
        EXPECT_FALSE(entry.description.empty());
        EXPECT_EQ(gatherFacts(scene).triangles == 0, entry.name == "empty") << source;
        for (const std::string& name : builtinNames()) EXPECT_NE("builtin:" + name, source);
    }
    EXPECT_EQ(gatherFacts(loadScene("builtin:stress_layers?count=77")).triangles, 154u);
    EXPECT_THROW(loadScene("builtin:stress_layers?count=0"), InputError);
    EXPECT_THROW(loadScene("builtin:stress_one?count=1"), InputError);
    EXPECT_THROW(loadScene("builtin:stress_layer"), InputError);
}

} // namespace
} // namespace kestrel
