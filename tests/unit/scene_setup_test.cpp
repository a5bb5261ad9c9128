// What a user adds to a scene: cameras, paths of cameras, lights; which animation plays, and when.
#include "core/files.h"
#include "scene/animation.h"
#include "scene/facts.h"
#include "scene/geometry.h"
#include "scene/setup.h"
#include "support/message.h"
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace kestrel {
namespace {

using test::messageOf;
using testing::ElementsAre;
using testing::HasSubstr;

// A triangle about the origin, so that Scene::origin is it; the node "arm" stands at (3, 0, 0), and two
// animations move it: "slide" along z by 4 in 2 seconds, "lift" along y in 1.
Scene scene() {
    Scene made;
    made.source = "test";
    Primitive triangle;
    triangle.positions = {{-1, -1, -1}, {1, 1, 1}, {1, -1, 1}};
    triangle.indices = {0, 1, 2};
    made.meshes.push_back({"triangle", {triangle}, {}});
    Node body, arm;
    body.name = "body";
    body.mesh = 0;
    arm.name = "arm";
    arm.translation = {3, 0, 0};
    made.nodes = {body, arm};
    made.roots = {0, 1};
    const auto moving = [](const char* name, float end, std::vector<float> values) {
        return Animation{
            name, {{1, AnimatedPath::Translation, Interpolation::Linear, {0, end}, std::move(values)}}};
    };
    made.animations = {moving("slide", 2, {3, 0, 0, 3, 0, 4}), moving("lift", 1, {3, 0, 0, 3, 8, 0})};
    return made;
}

Scene with(const SceneSetup& setup) {
    Scene made = scene();
    setUpScene(made, setup, {});
    return made;
}

SceneSetup camera(const std::string& text) {
    SceneSetup setup;
    setup.camera = parseCamera(text, "--camera");
    return setup;
}

SceneSetup light(const std::string& text) {
    SceneSetup setup;
    setup.lights.push_back(parseLight(text, "--light"));
    return setup;
}

void expectNear(const glm::vec3& value, const glm::vec3& wanted, float tolerance = 1e-6f) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(value[i], wanted[i], tolerance) << "component " << i;
}

// Where a camera looks, and up in its picture.
glm::vec3 ahead(const CameraState& state) { return -glm::vec3(glm::transpose(state.view)[2]); }
glm::vec3 upward(const CameraState& state) { return glm::vec3(glm::transpose(state.view)[1]); }

TEST(SceneSetup, ACameraStandsAtItsEyeAndLooksAtItsTarget) {
    const Scene made = with(camera("eye=0,2,0 target=1,2,0 fov=60"));
    ASSERT_EQ(made.cameras.size(), 1u) << "there is no default camera beside it";
    EXPECT_EQ(made.cameras[0].name, "added");
    EXPECT_EQ(cameraIndex(made, ""), 0);
    const CameraState state = cameraAt(made, 0, 0);
    expectNear(state.position, {0, 2, 0});
    expectNear(ahead(state), {1, 0, 0});
    expectNear(upward(state), {0, 1, 0});
    EXPECT_NEAR(state.verticalFov, glm::radians(60.0f), 1e-6f);
    EXPECT_FLOAT_EQ(state.nearPlane, 0.01f);
    EXPECT_EQ(state.farPlane, 0) << "without end";
    EXPECT_FALSE(gatherFacts(made).cameraMoves);
}

TEST(SceneSetup, StraightDownNeedsNoUp) {
    const CameraState state = cameraAt(with(camera("eye=0,5,0 target=0,0,0")), 0, 0);
    expectNear(ahead(state), {0, -1, 0});
    expectNear(upward(state), {0, 0, -1});
    EXPECT_NEAR(state.verticalFov, glm::radians(45.0f), 1e-6f);
    EXPECT_THAT(messageOf([] { with(camera("eye=0,5,0 target=0,0,0 up=0,2,0")); }),
                HasSubstr("'up' of the camera 'added' must not lie along the way from eye to target"));
}

TEST(SceneSetup, TextAndJsonSayTheSame) {
    const std::string json =
        cameraText(*camera("eye=0,2.5,0 target=1,2,0 up=0,0,1 fov=60 near=0.1 far=9").camera);
    EXPECT_EQ(
        json,
        R"({ "eye": [0, 2.5, 0], "target": [1, 2, 0], "up": [0, 0, 1], "fov": 60, "near": 0.1, "far": 9 })");
    EXPECT_EQ(cameraText(*camera(json).camera), json);
    const std::string spot =
        lightText(light("spot position=0,3,0 target=0,0,0 outer=30 color=1,0.5,0").lights[0]);
    EXPECT_EQ(
        spot,
        R"({ "kind": "spot", "position": [0, 3, 0], "target": [0, 0, 0], "color": [1, 0.5, 0], "outer": 30 })");
    EXPECT_EQ(lightText(light(spot).lights[0]), spot);
    EXPECT_FALSE(describesCamera("stairs"));
    EXPECT_TRUE(describesCamera("eye=0,0,0"));
    EXPECT_TRUE(describesCamera("{\"eye\": [0, 0, 0]}"));
}

TEST(SceneSetup, EveryMistakeIsToldWithItsNearName) {
    EXPECT_EQ(messageOf([] { parseCamera("eye=0,2 taget=1,2,0 fov=wide up", "--camera"); }),
              "--camera: there is no key 'taget' (did you mean 'target'?)\n"
              "--camera: 'fov' must be a number, not 'wide'\n"
              "--camera: 'up' is not of the form key=value");
    EXPECT_EQ(messageOf([] { parseCamera("eye=0,2 fov=180", "--camera"); }),
              "--camera: 'eye' must be three numbers from -1000000000 to 1000000000\n"
              "--camera: 'fov' must be more than 0 and less than 180, not 180");
    EXPECT_EQ(messageOf([] { parseCamera(R"({"eye": [0, 0, 1e400]})", "--camera"); }),
              "--camera:1:16: the number 1e400 is too large: at most 1.798e+308 can be read");
    EXPECT_THAT(messageOf([] { with(camera("eye=0,2,0")); }), HasSubstr("the camera 'added' needs 'target'"));
    EXPECT_THAT(messageOf([] { with(camera("eye=0,2,0 target=0,2,0")); }), HasSubstr("stands at its target"));
    EXPECT_THAT(messageOf([] { with(camera("node=amr")); }),
                HasSubstr("the scene has no node 'amr' (did you mean 'arm'?)"));
    EXPECT_EQ(messageOf([] { parseLight("spto position=0,0,0", "--light"); }),
              "--light: the kind of a light must be one of point, spot, directional, rectangle, sphere, not "
              "'spto' (did you mean 'spot'?)");
    EXPECT_EQ(messageOf([] { parseLight("directional position=0,0,0 radius=1", "--light"); }),
              "--light: a directional light has no 'position': that is of point, spot, rectangle, sphere\n"
              "--light: a directional light needs 'direction'\n"
              "--light: a directional light has no 'radius': that is of sphere");
    SceneSetup several = camera("eye=0,2,0 target=0,2,0");
    several.animation = "slid";
    EXPECT_EQ(messageOf([&] { with(several); }),
              "test: the scene has no animation 'slid' (did you mean 'slide'?); it has 0 'slide', 1 'lift'\n"
              "test: the camera 'added' stands at its target");
}

TEST(SceneSetup, LightsOfEveryKindShineAsTheyAreTold) {
    SceneSetup setup = light("directional direction=0,-2,0 color=1,0.5,0.25 intensity=3");
    const auto add = [&](const std::string& text) { setup.lights.push_back(parseLight(text, "--light")); };
    add("point position=1,2,3 range=7");
    add("spot position=0,3,0 target=3,3,0 inner=10 outer=30");
    add("rectangle position=0,2,0 direction=0,0,1 width=4 height=2");
    add("sphere position=0,0,5 radius=0.5 intensity=2");
    const Scene made = with(setup);
    const std::vector<LightState> lights = lightsAt(made, 0);
    ASSERT_EQ(lights.size(), 5u);
    EXPECT_EQ(lights[0].kind, LightKind::Directional);
    expectNear(lights[0].direction, {0, -1, 0});
    expectNear(lights[0].intensity, {3, 1.5, 0.75});
    EXPECT_EQ(lights[1].kind, LightKind::Point);
    expectNear(lights[1].position, {1, 2, 3});
    EXPECT_EQ(lights[1].range, 7);
    expectNear(lights[2].direction, {1, 0, 0});
    EXPECT_NEAR(lights[2].innerCone, glm::radians(10.0f), 1e-6f);
    EXPECT_NEAR(lights[2].outerCone, glm::radians(30.0f), 1e-6f);
    expectNear(lights[3].direction, {0, 0, 1});
    expectNear(lights[3].bitangent, {0, 1, 0});
    EXPECT_EQ(lights[3].halfSize, glm::vec2(2, 1));
    EXPECT_EQ(lights[4].halfSize.x, 0.5f);
    expectNear(lights[4].intensity, {2, 2, 2});
    const SceneFacts facts = gatherFacts(made);
    EXPECT_EQ(facts.directionalLights + facts.pointLights + facts.spotLights + facts.rectangleLights +
                  facts.sphereLights,
              5u);
}

TEST(SceneSetup, CamerasAndLightsGoAlongWithANode) {
    SceneSetup setup = camera("node=arm eye=0,1,0 target=0,1,-1");
    setup.lights.push_back(parseLight("point node=arm position=0,2,0", "--light"));
    setup.animation = "slide";
    const Scene made = with(setup);
    expectNear(cameraAt(made, 0, 0).position + glm::vec3(made.origin), {3, 1, 0});
    expectNear(cameraAt(made, 0, 1).position + glm::vec3(made.origin), {3, 1, 2});
    expectNear(ahead(cameraAt(made, 0, 1)), {0, 0, -1});
    expectNear(lightsAt(made, 2)[0].position + glm::vec3(made.origin), {3, 2, 4});
    EXPECT_TRUE(gatherFacts(made).cameraMoves);
    EXPECT_TRUE(gatherFacts(made).lightsMove);
}

TEST(SceneSetup, APathIsFollowedOverTime) {
    const std::string keys =
        R"("keys": [{"time": 1, "eye": [0, 0, 4]}, {"time": 3, "eye": [4, 0, 0], "fov": 30},
                                         {"time": 4, "eye": [0, 0, -4]}], "target": [0, 0, 0], "fov": 60)";
    const Scene straight = with(camera("{" + keys + "}"));
    EXPECT_EQ(straight.duration(), 4);
    EXPECT_TRUE(gatherFacts(straight).cameraMoves);
    expectNear(cameraAt(straight, 0, 0).position, {0, 0, 4});
    const CameraState half = cameraAt(straight, 0, 2);
    expectNear(half.position, {2, 0, 2});
    expectNear(ahead(half), glm::normalize(glm::vec3(-1, 0, -1)));
    EXPECT_NEAR(half.verticalFov, glm::radians(45.0f), 1e-6f);
    expectNear(cameraAt(straight, 0, 9).position, {0, 0, -4});

    const Scene smooth = with(camera("{\"interpolation\": \"smooth\", " + keys + "}"));
    for (const double time : {1.0, 3.0, 4.0})
        expectNear(cameraAt(smooth, 0, time).position, cameraAt(straight, 0, time).position);
    // Hermite at the middle: the mean of both ends and an eighth of the interval times the difference of
    // slopes: (4, 0, -4) / 2 at the first key and (0, 0, -8) / 3 at the second.
    expectNear(cameraAt(smooth, 0, 2).position,
               glm::vec3(2, 0, 2) + 0.25f * (glm::vec3(2, 0, -2) - glm::vec3(0, 0, -8.0f / 3)), 1e-5f);
    expectNear(ahead(cameraAt(smooth, 0, 2)), -glm::normalize(cameraAt(smooth, 0, 2).position), 1e-6f);
    // The camera comes to each key from the direction in which it leaves.
    for (const double time : {3.0}) {
        const glm::vec3 here = cameraAt(smooth, 0, time).position;
        const glm::vec3 before = (here - cameraAt(smooth, 0, time - 1e-3).position) / 1e-3f;
        const glm::vec3 after = (cameraAt(smooth, 0, time + 1e-3).position - here) / 1e-3f;
        expectNear(before, after, 0.05f);
    }
    EXPECT_THAT(messageOf([] { parseCamera(R"({"keys": [{"time": 1}, {"time": 1}]})", "--camera"); }),
                HasSubstr("--camera:1:24: the times of 'keys' must rise: 1 does not come after 1"));
}

TEST(SceneSetup, APathMayStandInAFileAndBeChanged) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("kestrel_setup_" + std::to_string(::getpid()));
    writeFile(folder / "orbit.json", R"({"kestrel_camera": 1, "target": [0, 0, 0], "fov": 30,
        "keys": [{"time": 0, "eye": [0, 0, 4]}, {"time": 2, "eye": [4, 0, 0]}]})");
    writeFile(folder / "bad.json", R"({"kestrel_camera": 2, "path": "x.json", "fvo": 30})");
    SceneSetup setup = camera("path=orbit.json fov=50 name=orbit");
    Scene made = scene();
    setUpScene(made, setup, folder);
    EXPECT_EQ(made.cameras[0].name, "orbit");
    EXPECT_NEAR(cameraAt(made, 0, 1).verticalFov, glm::radians(50.0f), 1e-6f);
    expectNear(cameraAt(made, 0, 1).position, {2, 0, 2});
    EXPECT_EQ(located(setup, folder).camera->path, (folder / "orbit.json").string());
    const std::string bad = (folder / "bad.json").string();
    EXPECT_EQ(messageOf([&] {
                  Scene other = scene();
                  setUpScene(other, camera("path=bad.json"), folder);
              }),
              bad + ":1:20: 'kestrel_camera' (the version of the format) must be 1, not 2\n" + bad +
                  ":1:31: 'path' cannot stand in the file of a path\n" + bad +
                  ":1:41: the camera has no key 'fvo' (did you mean 'fov'?)");
    std::filesystem::remove_all(folder);
}

TEST(SceneSetup, OneAnimationPlaysOrNoneOrAll) {
    const auto end = [](const std::string& animation) {
        SceneSetup setup;
        setup.animation = animation;
        const Scene made = with(setup);
        return glm::dvec3(poseAt(made, 2).worlds[1][3]);
    };
    EXPECT_EQ(end(""), glm::dvec3(3, 8, 0)) << "all: the last that drives a node wins";
    EXPECT_EQ(end("all"), glm::dvec3(3, 8, 0));
    EXPECT_EQ(end("slide"), glm::dvec3(3, 0, 4));
    EXPECT_EQ(end("0"), glm::dvec3(3, 0, 4));
    EXPECT_EQ(end("1"), glm::dvec3(3, 8, 0));
    EXPECT_EQ(end("none"), glm::dvec3(3, 0, 0));
    EXPECT_THAT(messageOf([&] { end("2"); }), HasSubstr("the scene has no animation '2'"));
}

TEST(SceneSetup, TheTimelineBeginsWhereItIsToldAndSaysWhereThatIsNowhere) {
    SceneSetup setup;
    setup.time = 1.5;
    setup.fps = 24;
    Scene made = with(setup);
    EXPECT_EQ(made.startTime, 1.5);
    EXPECT_EQ(made.frameRate, 24);
    EXPECT_TRUE(made.warnings.empty());
    setup.time = 2.5;
    EXPECT_THAT(with(setup).warnings, ElementsAre(HasSubstr("2.5 s, lies after the end")));
}

TEST(SceneSetup, WhatCountsOverWhatIsJoined) {
    SceneSetup under = camera("eye=0,2,0 target=1,2,0");
    under.lights.push_back(parseLight("point position=1,2,3", "--light"));
    under.time = 1;
    SceneSetup over = light("point position=4,5,6");
    over.fps = 30;
    const SceneSetup both = joined(under, over);
    EXPECT_TRUE(both.camera);
    EXPECT_EQ(both.lights.size(), 2u);
    EXPECT_EQ(both.time, 1);
    EXPECT_EQ(both.fps, 30);
    over.cameraName = "stairs";
    EXPECT_FALSE(joined(under, over).camera) << "a named one takes its place";
    EXPECT_EQ(setupText(over),
              R"({ "camera": "stairs", "lights": [{ "kind": "point", "position": [4, 5, 6] }], "fps": 30 })");
}

} // namespace
} // namespace kestrel
