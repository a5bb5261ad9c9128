// Cameras are told apart and chosen by name or number.
#include "scene/camera_names.h"
#include "scene/geometry.h"
#include "scene/gltf_export.h"
#include "support/gltf_builder.h"
#include "support/message.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel::camera_names_test {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;

std::vector<std::string> namesOf(const Scene& scene) {
    std::vector<std::string> names;
    for (const Camera& camera : scene.cameras) names.push_back(camera.name);
    return names;
}

std::vector<std::string> apart(const std::vector<std::string>& names) {
    Scene scene;
    for (const std::string& name : names) scene.cameras.push_back({.name = name});
    nameCamerasApart(scene.cameras);
    const std::vector<std::string> once = namesOf(scene);
    nameCamerasApart(scene.cameras);
    EXPECT_EQ(namesOf(scene), once) << "idempotent";
    return once;
}

TEST(CameraNames, TheFirstOfANameKeepsItAndTheOthersAreCounted) {
    EXPECT_THAT(apart({"a", "b"}), ElementsAre("a", "b"));
    EXPECT_THAT(apart({"cam", "cam", "cam"}), ElementsAre("cam", "cam (2)", "cam (3)"));
    EXPECT_THAT(apart({"cam", "cam", "cam (2)"}), ElementsAre("cam", "cam (3)", "cam (2)"));
    EXPECT_THAT(apart({"", "x", ""}), ElementsAre("camera 0", "x", "camera 2"));
    EXPECT_THAT(apart({"camera 1", ""}), ElementsAre("camera 1", "camera 1 (2)"));
}

// Cameras on nodes: {the camera's name, the node's}.
Scene fileWith(const std::vector<std::pair<std::string, std::string>>& cameras,
               const TemporaryFolder& folder) {
    test::GltfBuilder builder = test::triangleFile();
    for (const auto& [camera, node] : cameras) {
        builder.document["cameras"].push_back(
            {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
        if (!camera.empty()) builder.document["cameras"].back()["name"] = camera;
        builder.document["nodes"].push_back({{"camera", builder.document["cameras"].size() - 1}});
        if (!node.empty()) builder.document["nodes"].back()["name"] = node;
        builder.document["scenes"][0]["nodes"].push_back(builder.document["nodes"].size() - 1);
    }
    writeFile(folder / "cameras.gltf", builder.text());
    return loadScene((folder / "cameras.gltf").string());
}

TEST(CameraNames, OfAFileAreTheCamerasOwnElseTheNodesElseCounted) {
    const TemporaryFolder folder;
    EXPECT_THAT(namesOf(fileWith({{"front", "node a"}, {"", "node b"}, {"", ""}}, folder)),
                ElementsAre("front", "node b", "camera 2"));
    EXPECT_THAT(namesOf(fileWith({{"cam", "left"}, {"cam", "right"}}, folder)), ElementsAre("left", "right"));
    EXPECT_THAT(namesOf(fileWith({{"cam", ""}, {"cam", ""}}, folder)), ElementsAre("cam", "cam (2)"));
    EXPECT_THAT(namesOf(fileWith({{"cam", "eye"}, {"cam", "eye"}, {"eye", ""}}, folder)),
                ElementsAre("eye", "eye (2)", "eye (3)"));
}

TEST(CameraNames, SurviveExport) {
    const TemporaryFolder folder;
    const Scene scene = fileWith({{"cam", ""}, {"cam", ""}, {"", ""}}, folder);
    exportScene(scene, folder / "again.glb");
    EXPECT_EQ(namesOf(loadScene((folder / "again.glb").string())), namesOf(scene));
}

TEST(CameraIndex, TakesANumberUnlessACameraIsCalledSo) {
    Scene scene;
    scene.source = "s.glb";
    scene.cameras = {{.name = "alpha"}, {.name = "beta"}, {.name = "0"}};
    EXPECT_EQ(cameraIndex(scene, "1"), 1);
    EXPECT_EQ(cameraIndex(scene, "0"), 2);
    EXPECT_EQ(test::messageOf([&] { cameraIndex(scene, "33"); }),
              "s.glb: the scene has no camera '33'; it has 'alpha', 'beta' and '0', counted from 0");
    EXPECT_EQ(test::messageOf([&] { cameraIndex(scene, "-11"); }),
              "s.glb: the scene has no camera '-11'; it has 'alpha', 'beta' and '0'");
    scene.cameras.clear();
    for (int i = 0; i < 20; ++i) scene.cameras.push_back({.name = "c" + std::to_string(i)});
    EXPECT_EQ(test::messageOf([&] { cameraIndex(scene, "nobody"); }),
              "s.glb: the scene has no camera 'nobody'; it has 'c0', 'c1', 'c2', 'c3', 'c4', 'c5', 'c6', "
              "'c7', 'c8', "
              "'c9', 'c10', 'c11' and 8 more");
}

} // namespace
} // namespace kestrel::camera_names_test
