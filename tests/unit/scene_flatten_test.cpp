// Flattened geometry, cameras and lights.
#include "core/error.h"
#include "scene/builtin.h"
#include "scene/geometry.h"
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using testing::ElementsAre;

Primitive trianglePrimitive() {
    Primitive primitive;
    primitive.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    primitive.normals.assign(3, {0, 0, 1});
    primitive.indices = {0, 1, 2};
    return primitive;
}

// One node with one triangle.
Scene triangleScene() {
    Scene scene;
    scene.meshes = {{"", {trianglePrimitive()}, {}}};
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    scene.roots = {0};
    return scene;
}

AnimationChannel linear(int node, AnimatedPath path, std::vector<float> values) {
    return {node, path, Interpolation::Linear, {0, 1}, std::move(values)};
}

TEST(Flatten, IsRelativeToTheOriginWithoutLosingDigits) {
    Scene scene = triangleScene();
    scene.nodes[0].translation = {1e9, 1e9, 1e9};
    finishScene(scene);
    EXPECT_EQ(scene.origin, glm::dvec3(1e9 + 0.5, 1e9 + 0.5, 1e9));
    EXPECT_THAT(
        flatten(scene, 0).positions,
        ElementsAre(glm::vec3(-0.5f, -0.5f, 0), glm::vec3(0.5f, -0.5f, 0), glm::vec3(-0.5f, 0.5f, 0)));
}

TEST(Flatten, MirroringFlipsTheWindingAndKeepsTheFront) {
    Scene scene = triangleScene();
    scene.nodes[0].scale = {-1, 1, 1};
    const Geometry geometry = flatten(scene, 0);
    EXPECT_THAT(geometry.indices, ElementsAre(0, 2, 1));
    EXPECT_EQ(geometry.attributes[0].normal, glm::vec3(0, 0, 1));
    const glm::vec3 a = geometry.positions[geometry.indices[0]];
    const glm::vec3 cross =
        glm::cross(geometry.positions[geometry.indices[1]] - a, geometry.positions[geometry.indices[2]] - a);
    EXPECT_GT(cross.z, 0) << "counter-clockwise seen from the front";
}

TEST(Flatten, NormalsFollowTheInverseTranspose) {
    Scene scene = triangleScene();
    scene.meshes[0].primitives[0].normals.assign(3, glm::normalize(glm::vec3(1, 1, 0)));
    scene.nodes[0].scale = {2, 1, 1};
    const glm::vec3 normal = flatten(scene, 0).attributes[0].normal;
    const glm::vec3 wanted = glm::normalize(glm::vec3(0.5f, 1, 0));
    EXPECT_NEAR(normal.x, wanted.x, 1e-6);
    EXPECT_NEAR(normal.y, wanted.y, 1e-6);
    scene.nodes[0].scale = {-2, 1, 1};
    EXPECT_NEAR(flatten(scene, 0).attributes[0].normal.x, -wanted.x, 1e-6);
}

TEST(Flatten, SingularAndTinyTransformsGiveUnitNormals) {
    for (const glm::dvec3 scale : {glm::dvec3(0), glm::dvec3(1, 1, 0), glm::dvec3(0, 1, 1), glm::dvec3(1e-20),
                                   glm::dvec3(1e-200), glm::dvec3(1e20, 1e-20, 1)}) {
        Scene scene = triangleScene();
        scene.meshes[0].primitives[0].tangents.assign(3, {1, 0, 0, 1});
        scene.nodes[0].scale = scale;
        for (const VertexAttributes& vertex : flatten(scene, 0).attributes) {
            EXPECT_NEAR(glm::length(vertex.normal), 1, 1e-6);
            const float length = glm::length(glm::vec3(vertex.tangent));
            EXPECT_TRUE(std::abs(length - 1) < 1e-6 || (length == 0 && vertex.tangent.w == 0)) << length;
        }
    }
}

TEST(Flatten, TangentsStayOrthogonalAndKeepTheirHandedness) {
    Scene scene = triangleScene();
    scene.meshes[0].primitives[0].normals.assign(3, glm::normalize(glm::vec3(0, 1, 1)));
    scene.meshes[0].primitives[0].tangents.assign(3, {1, 0, 0, 1});
    scene.nodes[0].scale = {-1, 2, 1};
    const VertexAttributes vertex = flatten(scene, 0).attributes[0];
    EXPECT_NEAR(glm::dot(vertex.normal, glm::vec3(vertex.tangent)), 0, 1e-6);
    EXPECT_EQ(glm::vec3(vertex.tangent), glm::vec3(-1, 0, 0));
    EXPECT_EQ(vertex.tangent.w, -1) << "the mirror image of a right-handed frame is left-handed";
}

TEST(Flatten, SortsTrianglesByClass) {
    Scene scene = triangleScene();
    Material masked, blended, both;
    masked.alphaMode = AlphaMode::Mask;
    blended.alphaMode = AlphaMode::Blend;
    blended.doubleSided = true;
    both.doubleSided = true;
    scene.materials = {masked, blended, both};
    scene.meshes[0].primitives.clear();
    for (const int material : {0, 1, 2, -1, 0}) {
        Primitive primitive = trianglePrimitive();
        primitive.material = material;
        scene.meshes[0].primitives.push_back(primitive);
    }
    const Geometry geometry = flatten(scene, 0);
    EXPECT_THAT(geometry.materials, ElementsAre(3, 2, 0, 0, 1)) << "3 is glTF's default material";
    const auto range = [&](TriangleClass which) { return geometry.ranges[static_cast<size_t>(which)]; };
    EXPECT_EQ(range(TriangleClass::Opaque).count, 1u);
    EXPECT_EQ(range(TriangleClass::OpaqueDoubleSided).first, 1u);
    EXPECT_EQ(range(TriangleClass::Masked).first, 2u);
    EXPECT_EQ(range(TriangleClass::Masked).count, 2u);
    EXPECT_EQ(range(TriangleClass::MaskedDoubleSided).first, 4u);
    EXPECT_EQ(range(TriangleClass::MaskedDoubleSided).count, 1u);
    EXPECT_EQ(flattenedMaterials(scene).size(), 4u);
}

TEST(Flatten, MorphsThenSkins) {
    Scene scene = triangleScene();
    Primitive& primitive = scene.meshes[0].primitives[0];
    primitive.targets.resize(2);
    primitive.targets[0].positions.assign(3, {0, 0, 1});
    primitive.targets[1].positions.assign(3, {0, 0, 10});
    primitive.joints.assign(3, {0, 1, 0, 0});
    primitive.weights = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}};
    scene.meshes[0].weights = {0.5f, 0};
    scene.nodes.resize(3);
    scene.nodes[0].skin = 0;
    scene.nodes[0].translation = {100, 100, 100}; // has no effect on a skinned mesh
    scene.nodes[2].translation = {0, 5, 0};
    scene.nodes[2].scale = {1, 1, 2};
    scene.roots = {0, 1, 2};
    scene.skins = {{"", {1, 2}, {glm::mat4(1), glm::mat4(1)}}};
    EXPECT_THAT(flatten(scene, 0).positions,
                ElementsAre(glm::vec3(0, 0, 0.5f), glm::vec3(1, 5, 1), glm::vec3(0, 3.5f, 0.75f)));
    scene.nodes[0].weights = {0, 0.1f};
    EXPECT_EQ(flatten(scene, 0).positions[0], glm::vec3(0, 0, 1));
}

TEST(Flatten, FlatNormalsFollowTheDeformedTriangle) {
    Scene scene = triangleScene();
    Primitive& primitive = scene.meshes[0].primitives[0];
    primitive.normals.clear();
    primitive.targets.resize(1);
    primitive.targets[0].positions = {{0, 0, 0}, {0, 0, 1}, {0, 0, 0}};
    scene.animations = {{"", {linear(0, AnimatedPath::Weights, {0, 1})}}};
    finishScene(scene);
    EXPECT_EQ(flatten(scene, 0).attributes[0].normal, glm::vec3(0, 0, 1));
    const glm::vec3 normal = flatten(scene, 1).attributes[0].normal;
    EXPECT_NEAR(normal.x, -std::sqrt(0.5f), 1e-6);
    EXPECT_NEAR(normal.z, std::sqrt(0.5f), 1e-6);
}

TEST(Flatten, GivesPreviousPositionsOnlyWhereSomethingMoves) {
    Scene scene = triangleScene();
    EXPECT_TRUE(flatten(scene, 1, 0).previousPositions.empty());
    scene.animations = {{"", {linear(0, AnimatedPath::Translation, {0, 0, 0, 0, 0, 8})}}};
    const Geometry geometry = flatten(scene, 0.5, 0.25);
    EXPECT_EQ(geometry.positions[0], glm::vec3(0, 0, 4));
    EXPECT_EQ(geometry.previousPositions[0], glm::vec3(0, 0, 2));
}

void expectEqual(const Geometry& a, const Geometry& b) {
    EXPECT_TRUE(a.positions == b.positions);
    EXPECT_TRUE(a.previousPositions == b.previousPositions);
    EXPECT_TRUE(a.indices == b.indices);
    EXPECT_TRUE(a.materials == b.materials);
    ASSERT_EQ(a.attributes.size(), b.attributes.size());
    for (size_t i = 0; i < a.attributes.size(); ++i) {
        ASSERT_EQ(a.attributes[i].normal, b.attributes[i].normal);
        ASSERT_EQ(a.attributes[i].tangent, b.attributes[i].tangent);
        ASSERT_EQ(a.attributes[i].texCoord, b.attributes[i].texCoord);
    }
    EXPECT_EQ(a.bounds.min, b.bounds.min);
    EXPECT_EQ(a.bounds.max, b.bounds.max);
}

// One node stands, one moves and one is mirrored half of the time, large enough for two threads.
TEST(Flatten, FrameAfterFrameEqualsFlatteningAnew) {
    Scene scene = triangleScene();
    Primitive& primitive = scene.meshes[0].primitives[0];
    for (std::uint32_t i = 0; i < 30000; ++i) {
        primitive.positions.emplace_back(float(i % 173), float(i % 19), float(i % 7));
        primitive.normals.push_back(glm::normalize(glm::vec3(1, float(i % 5), 1)));
        primitive.indices.insert(primitive.indices.end(), {i, i + 1, i + 2});
    }
    scene.nodes.resize(3);
    scene.nodes[1].mesh = scene.nodes[2].mesh = 0;
    scene.roots = {0, 1, 2};
    scene.animations = {{"",
                         {linear(1, AnimatedPath::Translation, {0, 0, 0, 1, 2, 3}),
                          linear(2, AnimatedPath::Scale, {-1, 1, 1, 1, 1, 1})}}};
    finishScene(scene);
    Flattener flattener(scene);
    double previous = 0;
    for (const double time : {0.0, 0.25, 0.75, 0.75, 0.5, 1.0, 0.0}) {
        SCOPED_TRACE(time);
        expectEqual(flattener.at(time, previous), flatten(scene, time, previous));
        previous = time;
    }
    expectEqual(flattener.at(0.3), flatten(scene, 0.3));
    expectEqual(flattener.at(0.4, 0.1), flatten(scene, 0.4, 0.1));
    expectEqual(flattener.at(0.6, 0.6), flatten(scene, 0.6, 0.6));
}

TEST(Flatten, SaysWhichVerticesMoveAndWhenTrianglesAreTurnedOver) {
    Scene scene = triangleScene();
    scene.nodes.resize(4);
    for (Node& node : scene.nodes) node.mesh = 0;
    scene.roots = {0, 1, 2, 3};
    scene.animations = {{"",
                         {linear(1, AnimatedPath::Translation, {0, 0, 0, 1, 2, 3}),
                          linear(2, AnimatedPath::Scale, {-1, 1, 1, 1, 1, 1})}}};
    finishScene(scene);
    Flattener flattener(scene);
    Geometry before = flattener.at(0);
    ASSERT_EQ(before.moving.size(), 1u) << "neighbours are one range";
    EXPECT_EQ(before.moving[0].first, 3u);
    EXPECT_EQ(before.moving[0].count, 6u);
    for (const double time : {0.25, 0.75, 1.0, 0.1}) {
        const Geometry& now = flattener.at(time);
        EXPECT_EQ(now.indices != before.indices, now.turns != before.turns) << time;
        for (size_t i = 0; i < now.positions.size(); ++i)
            if (i < 3 || i >= 9) {
                EXPECT_EQ(now.positions[i], before.positions[i]);
            }
        before = now;
    }
    Scene still = triangleScene();
    finishScene(still);
    EXPECT_TRUE(flatten(still, 0).moving.empty());
}

TEST(Flatten, RefusesMoreTrianglesThanItCanHold) {
    Scene scene = triangleScene();
    scene.meshes[0].primitives[0].indices.assign(3 * 100000, 0);
    scene.nodes.assign(1000, scene.nodes[0]);
    scene.roots.resize(scene.nodes.size());
    for (size_t i = 0; i < scene.roots.size(); ++i) scene.roots[i] = static_cast<int>(i);
    scene.source = "many.glb";
    try {
        flatten(scene, 0);
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_EQ(
            std::string(error.what()),
            "many.glb: the scene has 100000000 triangles and 3000 vertices with all its instances; at most "
            "64000000 and 64000000 are flattened");
    }
}

// Depth and position on screen of a point in eye space.
glm::vec3 projected(const CameraState& camera, glm::vec3 eye, float frameAspect) {
    const glm::vec4 clip = camera.projection(frameAspect) * glm::vec4(eye, 1);
    return glm::vec3(clip) / clip.w;
}

TEST(Projection, IsReversedFromOneAtTheNearPlaneToZeroAtTheFarPlane) {
    CameraState camera;
    camera.verticalFov = 1;
    camera.nearPlane = 0.5f;
    camera.farPlane = 20;
    const float half = std::tan(0.5f);
    EXPECT_NEAR(projected(camera, {0, 0, -0.5f}, 2).z, 1, 1e-6);
    EXPECT_NEAR(projected(camera, {0, 0, -20}, 2).z, 0, 1e-6);
    const glm::vec3 corner = projected(camera, {2 * half * 3, half * 3, -3}, 2);
    EXPECT_NEAR(corner.x, 1, 1e-6);
    EXPECT_NEAR(corner.y, 1, 1e-6);
    camera.farPlane = 0;
    EXPECT_NEAR(projected(camera, {0, 0, -1e30f}, 2).z, 0, 1e-6);
    EXPECT_NEAR(projected(camera, {0, 0, -1}, 2).z, 0.5f, 1e-6);
    camera.aspect = 1;
    EXPECT_NEAR(projected(camera, {2 * half, half, -1}, 2).x, 1, 1e-6) << "pixels are square";
    EXPECT_NEAR(projected(camera, {2 * half, half, -1}, 2).y, 1, 1e-6);
    EXPECT_NEAR(projected(camera, {half, 2 * half, -1}, 0.5f).x, 1, 1e-6) << "what it framed stays in view";
    EXPECT_NEAR(projected(camera, {half, 2 * half, -1}, 0.5f).y, 1, 1e-6);
}

TEST(Projection, IsReversedForOrthographicCamerasToo) {
    CameraState camera;
    camera.orthographic = true;
    camera.halfHeight = 3;
    camera.nearPlane = 0;
    camera.farPlane = 8;
    EXPECT_EQ(projected(camera, {0, 3, 0}, 2), glm::vec3(0, 1, 1));
    EXPECT_EQ(projected(camera, {6, 0, -8}, 2), glm::vec3(1, 0, 0));
    EXPECT_EQ(projected(camera, {0, 0, -4}, 2).z, 0.5f);
}

TEST(CameraAt, LooksAlongItsNodeWithoutScaleAndMirroring) {
    Scene scene = triangleScene();
    scene.nodes.resize(2);
    scene.nodes[1].translation = {1, 2, 3};
    scene.nodes[1].rotation = glm::angleAxis(std::acos(-1.0) / 2, glm::dvec3(0, 1, 0)); // -z becomes -x
    scene.nodes[1].scale = {-5, 5, 5};
    scene.cameras = {{.name = "side", .node = 1}};
    scene.origin = {0, 0, 1};
    const CameraState camera = cameraAt(scene, 0, 0);
    EXPECT_EQ(camera.position, glm::vec3(1, 2, 2));
    const glm::vec4 ahead = camera.view * glm::vec4(-3, 2, 2, 1);
    EXPECT_NEAR(ahead.z, -4, 1e-5);
    EXPECT_NEAR(glm::determinant(glm::mat3(camera.view)), 1, 1e-6);
    scene.nodes[1].scale = {0, 0, 0};
    EXPECT_EQ(cameraAt(scene, 0, 0).view[0], glm::vec4(1, 0, 0, 0))
        << "axes of the world where there are none";
}

TEST(CameraAt, ScalesWithTheWholeScene) {
    Scene scene = triangleScene();
    scene.cameras = {{.name = {}, .orthographic = true, .halfHeight = 2, .nearPlane = 1, .farPlane = 3}};
    scene.lights = {{.name = {}, .kind = LightKind::Point, .intensity = 8, .range = 4},
                    {.name = {}, .kind = LightKind::Directional, .intensity = 8},
                    {.name = {}, .kind = LightKind::Rectangle, .intensity = 8, .halfSize = {1, 2}}};
    scene.rootTransform = glm::dmat4(0.5);
    scene.rootTransform[3].w = 1;
    const CameraState camera = cameraAt(scene, 0, 0);
    EXPECT_EQ(camera.halfHeight, 1);
    EXPECT_EQ(camera.nearPlane, 0.5f);
    EXPECT_EQ(camera.farPlane, 1.5f);
    const std::vector<LightState> lights = lightsAt(scene, 0);
    EXPECT_EQ(lights[0].intensity.x, 2) << "candela over a squared distance gives the same irradiance";
    EXPECT_EQ(lights[0].range, 2);
    EXPECT_EQ(lights[1].intensity.x, 8);
    EXPECT_EQ(lights[2].intensity.x, 8) << "radiance does not depend on size";
    EXPECT_EQ(lights[2].halfSize, glm::vec2(0.5f, 1));
}

TEST(LightsAt, ShineAlongTheirNode) {
    Scene scene = triangleScene();
    scene.nodes.resize(2);
    scene.nodes[1].rotation = glm::angleAxis(-std::acos(-1.0) / 2, glm::dvec3(1, 0, 0)); // -z becomes -y
    scene.nodes[1].translation = {0, 9, 0};
    scene.lights = {{.name = {}, .kind = LightKind::Spot, .colour = {1, 0.5f, 0}, .intensity = 4, .node = 1}};
    const LightState light = lightsAt(scene, 0).at(0);
    EXPECT_NEAR(light.direction.y, -1, 1e-6);
    EXPECT_NEAR(light.bitangent.z, -1, 1e-6);
    EXPECT_EQ(light.tangent, glm::vec3(1, 0, 0));
    EXPECT_EQ(light.position, glm::vec3(0, 9, 0));
    EXPECT_EQ(light.intensity, glm::vec3(4, 2, 0));
}

TEST(CameraIndex, FindsByNameAndNamesTheNearOne) {
    Scene scene = triangleScene();
    scene.source = "s.glb";
    scene.cameras = {{.name = "front"}, {.name = "stairs"}};
    EXPECT_EQ(cameraIndex(scene, ""), 0);
    EXPECT_EQ(cameraIndex(scene, "stairs"), 1);
    try {
        cameraIndex(scene, "stiars");
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_EQ(
            std::string(error.what()),
            "s.glb: the scene has no camera 'stiars' (did you mean 'stairs'?); it has 'front' and 'stairs'");
    }
}

TEST(LoadScene, NamesWhatIsNoScene) {
    for (const auto& [source, part] : {std::pair("builtin:towr", "did you mean 'tower'"),
                                       std::pair("tower", "did you mean 'builtin:tower'?"),
                                       std::pair("nothing.glb", "nothing.glb: no such file"),
                                       std::pair("picture.png", "name a .gltf or .glb file")}) {
        try {
            loadScene(source);
            FAIL() << "no error for " << source;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    }
}

} // namespace
} // namespace kestrel
