// A camera that one moves.
#include "edit/camera.h"
#include <gtest/gtest.h>

namespace kestrel::edit {
namespace {

class EditorCamera : public testing::Test {
protected:
    const Scene scene = loadScene("builtin:blob?detail=0.02");
    AddedCamera camera = cameraFrom(cameraAt(scene, 0, 0), scene);
    [[nodiscard]] glm::dvec3 forward() const { return glm::normalize(*camera.target - *camera.eye); }
    [[nodiscard]] double distance() const { return glm::length(*camera.target - *camera.eye); }
};

TEST_F(EditorCamera, BeginsWhereTheScenesCameraStands) {
    const CameraState before = cameraAt(scene, 0, 0), now = stateOf(camera, scene);
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row)
            EXPECT_NEAR(now.view[column][row], before.view[column][row], 2e-4) << column << row;
    EXPECT_NEAR(now.verticalFov, before.verticalFov, 1e-5f);
}

// What --camera reads is the same camera to the bit.
TEST_F(EditorCamera, ItsTextIsTheSameCamera) {
    orbit(camera, 0.7, -0.2);
    fly(camera, {0.1, 0.2, 0.3});
    lookAround(camera, -0.3, 0.1);
    dolly(camera, 0.37);
    const AddedCamera read = parseCamera(cameraOption(camera), "--camera");
    EXPECT_EQ(stateOf(read, scene), stateOf(camera, scene));
    SceneSetup setup;
    setup.camera = read;
    const Scene added = loadScene("builtin:blob?detail=0.02", {}, {}, setup);
    EXPECT_EQ(cameraAt(added, added.camera, 0), stateOf(camera, scene));
    EXPECT_LT(cameraOption(camera).size(), 100u);
}

TEST_F(EditorCamera, OrbitKeepsTheTargetAndTheDistance) {
    const glm::dvec3 target = *camera.target;
    const double before = distance();
    for (int i = 0; i < 100; ++i) orbit(camera, 0.3, 0.2); // past the pole, if it went there
    EXPECT_NEAR(glm::length(*camera.target - target), 0, 1e-4 * before);
    EXPECT_NEAR(distance(), before, 1e-3 * before);
    EXPECT_GT(camera.eye->y, target.y);
    EXPECT_LT(std::abs(forward().y), 1);
}

TEST_F(EditorCamera, LookKeepsTheEyeAndTurnsRight) {
    const glm::dvec3 eye = *camera.eye, before = forward();
    const glm::dvec3 right = glm::normalize(glm::cross(before, glm::dvec3(0, 1, 0)));
    lookAround(camera, 0.1, 0);
    EXPECT_EQ(*camera.eye, eye);
    EXPECT_GT(glm::dot(forward(), right), 0.05);
    lookAround(camera, -0.1, 0.1);
    EXPECT_NEAR(glm::dot(forward(), right), 0, 1e-3);
    EXPECT_GT(forward().y, before.y);
}

TEST_F(EditorCamera, FlyMovesAlongWhatIsSeen) {
    const glm::dvec3 eye = *camera.eye, way = forward();
    const double before = distance();
    fly(camera, {0, 0, 0.5});
    EXPECT_NEAR(glm::length(*camera.eye - eye - 0.5 * before * way), 0, 1e-4 * before);
    EXPECT_NEAR(distance(), before, 1e-4 * before);
    fly(camera, {0.25, 0, -0.5});
    EXPECT_NEAR(glm::dot(*camera.eye - eye, way), 0, 1e-4 * before);
    EXPECT_NEAR(glm::length(*camera.eye - eye), 0.25 * before, 1e-4 * before);
}

TEST_F(EditorCamera, ComingNearerBringsTheNearPlaneAlong) {
    const double before = distance();
    for (int i = 0; i < 60; ++i) dolly(camera, 0.9);
    EXPECT_NEAR(distance(), before * std::pow(0.9, 60), 1e-3 * before * std::pow(0.9, 60));
    EXPECT_LE(*camera.nearPlane, 0.0101 * distance());
    EXPECT_GT(*camera.nearPlane, 0);
}

} // namespace
} // namespace kestrel::edit
