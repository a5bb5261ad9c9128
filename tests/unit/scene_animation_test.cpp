// Interpolation and the hierarchy of nodes.
#include "scene/animation.h"
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace kestrel {
namespace {

AnimationChannel channelOf(AnimatedPath path, Interpolation interpolation, std::vector<float> times,
                           std::vector<float> values) {
    return {0, path, interpolation, std::move(times), std::move(values)};
}

void expectNear(const std::vector<double>& value, const std::vector<double>& wanted,
                double tolerance = 1e-12) {
    ASSERT_EQ(value.size(), wanted.size());
    for (size_t i = 0; i < value.size(); ++i)
        EXPECT_NEAR(value[i], wanted[i], tolerance) << "component " << i;
}

TEST(Animation, StepHoldsTheValueOfTheKeyBefore) {
    const AnimationChannel channel =
        channelOf(AnimatedPath::Translation, Interpolation::Step, {1, 2}, {1, 2, 3, 4, 5, 6});
    expectNear(sampleChannel(channel, 0), {1, 2, 3});
    expectNear(sampleChannel(channel, 1), {1, 2, 3});
    expectNear(sampleChannel(channel, std::nextafter(2.0, 0.0)), {1, 2, 3});
    expectNear(sampleChannel(channel, 2), {4, 5, 6});
    expectNear(sampleChannel(channel, 9), {4, 5, 6});
}

TEST(Animation, LinearClampsOutsideItsKeys) {
    const AnimationChannel channel =
        channelOf(AnimatedPath::Scale, Interpolation::Linear, {1, 3, 4}, {0, 0, 0, 2, 4, 8, 0, 0, 0});
    expectNear(sampleChannel(channel, 0.5), {0, 0, 0});
    expectNear(sampleChannel(channel, 1.5), {0.5, 1, 2});
    expectNear(sampleChannel(channel, 3.5), {1, 2, 4});
    expectNear(sampleChannel(channel, 5), {0, 0, 0});
}

TEST(Animation, LinearRotationTurnsEvenlyAlongTheShorterArc) {
    const float half = std::sqrt(0.5f);
    // From none to 90 degrees about y, the second key with the opposite sign: the same rotation.
    const AnimationChannel channel =
        channelOf(AnimatedPath::Rotation, Interpolation::Linear, {0, 1}, {0, 0, 0, 1, 0, -half, 0, -half});
    const double third = std::numbers::pi / 12; // half of 30 degrees
    expectNear(sampleChannel(channel, 1.0 / 3.0), {0, std::sin(third), 0, std::cos(third)}, 1e-7);
    const double most = std::numbers::pi / 6;
    expectNear(sampleChannel(channel, 2.0 / 3.0), {0, std::sin(most), 0, std::cos(most)}, 1e-7);
}

TEST(Animation, RotationsAreUnitEvenIfTheKeysAreNot) {
    const AnimationChannel channel =
        channelOf(AnimatedPath::Rotation, Interpolation::Step, {0}, {0, 0, 3, 4});
    expectNear(sampleChannel(channel, 0), {0, 0, 0.6, 0.8});
}

// The cubic with values 1 and 3, slopes 2 and -1 over an interval of 2: worked out from its definition.
TEST(Animation, CubicSplineIsTheHermiteCurve) {
    const AnimationChannel channel =
        channelOf(AnimatedPath::Weights, Interpolation::CubicSpline, {1, 3}, {9, 1, 2, -1, 3, 9});
    const auto hermite = [](double s) {
        const double h00 = (1 + 2 * s) * (1 - s) * (1 - s), h10 = s * (1 - s) * (1 - s);
        const double h01 = s * s * (3 - 2 * s), h11 = s * s * (s - 1);
        return h00 * 1 + h10 * 2 * 2 + h01 * 3 + h11 * 2 * -1;
    };
    for (const double s : {0.0, 0.25, 0.5, 0.9}) expectNear(sampleChannel(channel, 1 + 2 * s), {hermite(s)});
    expectNear(sampleChannel(channel, 0), {1});
    expectNear(sampleChannel(channel, 3), {3});
}

TEST(Animation, WeightsHaveAsManyComponentsAsTargets) {
    const AnimationChannel channel =
        channelOf(AnimatedPath::Weights, Interpolation::Linear, {0, 1}, {0, 1, 2, 4, 5, 6});
    expectNear(sampleChannel(channel, 0.5), {2, 3, 4});
}

TEST(Animation, ConstantChannelsDoNotVary) {
    EXPECT_FALSE(channelVaries(
        channelOf(AnimatedPath::Translation, Interpolation::Linear, {0, 1}, {1, 2, 3, 1, 2, 3})));
    EXPECT_TRUE(channelVaries(
        channelOf(AnimatedPath::Translation, Interpolation::Linear, {0, 1}, {1, 2, 3, 1, 2, 4})));
    EXPECT_TRUE(channelVaries(
        channelOf(AnimatedPath::Weights, Interpolation::CubicSpline, {0, 1}, {0, 1, 5, 0, 1, 0})))
        << "equal keys, but the curve bulges";
    EXPECT_FALSE(channelVaries(
        channelOf(AnimatedPath::Weights, Interpolation::CubicSpline, {0, 1}, {0, 1, 0, 0, 1, 0})));
}

// A chain of three nodes, the middle one animated, and one node aside.
Scene chain() {
    Scene scene;
    scene.nodes.resize(4);
    scene.nodes[0].translation = {1, 0, 0};
    scene.nodes[0].scale = {2, 2, 2};
    scene.nodes[0].children = {1};
    scene.nodes[1].parent = 0;
    scene.nodes[1].children = {2};
    scene.nodes[2].parent = 1;
    scene.nodes[2].translation = {0, 1, 0};
    scene.roots = {3, 0};
    AnimationChannel channel =
        channelOf(AnimatedPath::Translation, Interpolation::Linear, {0, 2}, {0, 0, 0, 0, 0, 4});
    channel.node = 1;
    scene.animations = {{"", {channel}}};
    return scene;
}

TEST(Animation, ComposesWorldMatricesInDoublePrecision) {
    Scene scene = chain();
    scene.nodes[0].translation.x = 1e9 + 1.0 / 3.0;
    const Pose pose = poseAt(scene, 1);
    EXPECT_EQ(glm::dvec3(pose.worlds[2][3]), glm::dvec3(1e9 + 1.0 / 3.0, 2, 4));
    scene.rootTransform = glm::dmat4(2);
    scene.rootTransform[3] = {0, 0, 7, 1};
    EXPECT_EQ(glm::dvec3(poseAt(scene, 2).worlds[2][3]), glm::dvec3(2e9 + 2.0 / 3.0, 4, 23));
    EXPECT_EQ(poseAt(scene, 0, glm::dmat4(1)).worlds[3], glm::dmat4(1));
}

TEST(Animation, KnowsWhichNodesMove) {
    const Scene scene = chain();
    EXPECT_EQ(movingNodes(scene), (std::vector<bool>{false, true, true, false}));
    EXPECT_EQ(nodesInScene(scene), (std::vector<int>{3, 0, 1, 2}));
    EXPECT_EQ(keyTimes(scene), (std::vector<double>{0, 2}));
    EXPECT_EQ(scene.duration(), 2);
}

TEST(Animation, ALongChainOfNodesNeedsNoStack) {
    Scene scene;
    scene.nodes.resize(300000);
    for (size_t i = 1; i < scene.nodes.size(); ++i) {
        scene.nodes[i].parent = static_cast<int>(i) - 1;
        scene.nodes[i - 1].children = {static_cast<int>(i)};
        scene.nodes[i].translation.x = 1;
    }
    scene.roots = {0};
    EXPECT_EQ(poseAt(scene, 0).worlds.back()[3].x, 299999);
    EXPECT_EQ(nodesInScene(scene).size(), scene.nodes.size());
}

TEST(Animation, AMatrixReplacesTranslationRotationAndScale) {
    Node node;
    node.translation = {5, 5, 5};
    node.matrix = glm::dmat4(3);
    EXPECT_EQ(localMatrix(node), glm::dmat4(3));
}

} // namespace
} // namespace kestrel
