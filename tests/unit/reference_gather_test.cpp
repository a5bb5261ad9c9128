// One bounce, soft shadows and glossy reflection by the reference where they are known by hand.
#include "core/error.h"
#include "reference/area_emitters.h"
#include "reference/primary_hits.h"
#include "reference/surface_sample.h"
#include "reference_world.h"
#include "shared/ggx.h"
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

namespace kestrel {
namespace {

// Lambert's formula: irradiance over pi at `p` with normal n from a polygon of unit radiance wholly above the
// horizon.
float lambertPolygon(const std::vector<glm::vec3>& corners, const glm::vec3& p, const glm::vec3& n) {
    double sum = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(glm::dvec3(corners[i] - p)),
                         b = glm::normalize(glm::dvec3(corners[(i + 1) % corners.size()] - p));
        sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(glm::cross(a, b)), glm::dvec3(n));
    }
    return static_cast<float>(std::abs(sum) / (2 * std::numbers::pi));
}

TEST(ReferenceSoftShadow, RectangleOverAPlaneHasLambertsFormFactor) {
    GATHER_NEEDS_EMBREE();
    for (const float scale : {1e-4f, 1.0f, 1e4f}) {
        LitWorld world;
        world.scene = materialsScene({matteOf(glm::vec3(0.5f))});
        addSquare(world.geometry, scale * glm::vec3(-4, 0, -4), {0, 0, 8 * scale}, {8 * scale, 0, 0});
        LightState light = lightOf(LightKind::Rectangle, scale * glm::vec3(0.2f, 1, 0), 3);
        light.halfSize = scale * glm::vec2(0.5f, 0.3f);
        world.lights = {light};
        std::vector<glm::vec3> corners;
        for (const glm::vec2& s : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
            corners.push_back(light.position + s.x * light.halfSize.x * light.tangent +
                              s.y * light.halfSize.y * light.bitangent);
        const std::vector<glm::vec3> points = {scale * glm::vec3(0, 0, 0), scale * glm::vec3(1, 0, 0.5f),
                                               scale * glm::vec3(-2, 0, 1)};
        GatherSettings settings;
        settings.samples = 4096;
        const GatherResult result = world.shadow(pointsFacing(points, {0, 1, 0}), settings);
        for (int i = 0; i < 3; ++i) {
            const float expected = 3 * lambertPolygon(corners, points[static_cast<size_t>(i)], {0, 1, 0});
            EXPECT_NEAR(result.light.at(i, 0, 0), expected, 2e-3f * expected + 4 * result.noise) << scale;
            EXPECT_EQ(result.visibility.at(i, 0), 1.0f);
        }
        EXPECT_LT(result.noise, 2e-3);
    }
}

TEST(ReferenceSoftShadow, SphereLightFallsWithTheSquareOfTheDistance) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf(glm::vec3(0.5f))});
    addSquare(world.geometry, {-9, 0, -9}, {0, 0, 18}, {18, 0, 0});
    for (const float radius : {0.001f, 0.1f, 0.9f}) {
        LightState light = lightOf(LightKind::Sphere, {0, 1, 0}, 2);
        light.halfSize.x = radius;
        world.lights = {light};
        const std::vector<glm::vec3> points = {{0, 0, 0}, {0.4f, 0, 0}, {-0.2f, 0, 0.3f}};
        GatherSettings settings;
        settings.samples = 1024;
        const GatherResult result = world.shadow(pointsFacing(points, {0, 1, 0}), settings);
        for (int i = 0; i < 3; ++i) {
            // The whole sphere is above the horizon: E / pi = L (r / d)^2 cos.
            const float d = glm::length(light.position - points[static_cast<size_t>(i)]);
            const float expected = 2 * radius * radius / (d * d) / d;
            EXPECT_NEAR(result.light.at(i, 0, 0), expected, 2e-3f * expected) << radius;
        }
    }
}

TEST(ReferenceSoftShadow, AnEmissiveSquareShinesAsTheRectangle) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf(glm::vec3(0.5f)), matteOf(glm::vec3(0), {1, 2, 4})});
    addSquare(world.geometry, {-4, 0, -4}, {0, 0, 8}, {8, 0, 0});
    addSquare(world.geometry, {-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, 1); // its front looks down
    GatherSettings settings;
    settings.samples = 4096;
    settings.emission = true;
    const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0.5f}};
    const GatherInputs inputs = pointsFacing(points, {0, 1, 0});
    const GatherResult result = world.shadow(inputs, settings);
    for (int i = 0; i < 2; ++i) {
        const float factor =
            lambertPolygon({{-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}, {-0.5f, 1, 0.5f}},
                           points[static_cast<size_t>(i)], {0, 1, 0});
        EXPECT_NEAR(result.light.at(i, 0, 0), factor, 0.01f * factor);
        EXPECT_NEAR(result.light.at(i, 0, 2), 4 * factor, 0.04f * factor);
    }
    // Where a light shines in the same place and as bright, the square is its panel and counts no second
    // time.
    LightState light = lightOf(LightKind::Rectangle, {0, 1, 0}, 1);
    light.intensity = {1, 2, 4};
    light.halfSize = {0.5f, 0.5f};
    world.lights = {light};
    EXPECT_EQ(areaEmitters(world.lights, world.geometry, world.scene, true).size(), 1u);
    EXPECT_NEAR(world.shadow(inputs, settings).light.at(0, 0, 0), result.light.at(0, 0, 0), 0.01f);
    world.lights[0].intensity *= 2;
    EXPECT_EQ(areaEmitters(world.lights, world.geometry, world.scene, true).size(), 3u);
    // Nothing shines to the back.
    EXPECT_EQ(world.shadow(pointsFacing({{0, 1.2f, 0}}, {0, -1, 0}), settings).light.at(0, 0, 0), 0.0f);
}

TEST(ReferenceSoftShadow, ThePenumbraGrowsWithTheDistanceOfTheOccluder) {
    GATHER_NEEDS_EMBREE();
    LightState light = lightOf(LightKind::Rectangle, {0, 4, 0}, 1);
    light.halfSize = {0.5f, 0.01f};
    const auto width = [&](float height) {
        LitWorld world;
        world.scene = materialsScene({matteOf(glm::vec3(0.5f))});
        addSquare(world.geometry, {-9, 0, -9}, {0, 0, 18}, {18, 0, 0});
        // A half plane: its edge runs along z at x = 0.
        addSquare(world.geometry, {-9, height, -9}, {0, 0, 18}, {9, 0, 0});
        world.lights = {light};
        std::vector<glm::vec3> points;
        for (int i = -200; i <= 200; ++i) points.emplace_back(0.01f * static_cast<float>(i), 0, 0);
        const GatherResult result = world.shadow(pointsFacing(points, {0, 1, 0}), {});
        int partly = 0;
        for (int i = 0; i < 401; ++i) {
            const float v = result.visibility.at(i, 0);
            if (v > 0.02f && v < 0.98f) ++partly;
        }
        EXPECT_LT(result.visibility.at(0, 0), 0.01f);
        EXPECT_GT(result.visibility.at(400, 0), 0.99f);
        return 0.01f * static_cast<float>(partly);
    };
    // The light's width times the edge's height over the way from edge to light; ends of 2 % are cut off.
    for (const float height : {0.5f, 1.0f, 2.0f})
        EXPECT_NEAR(width(height), 0.96f * height / (4 - height), 0.04f);
}

TEST(ReferenceIndirectDiffuse, ARoomOfOneRadianceGivesThatRadiance) {
    GATHER_NEEDS_EMBREE();
    for (const float scale : {1e-4f, 1.0f, 1e4f}) {
        LitWorld world;
        world.scene = materialsScene({matteOf(glm::vec3(0.5f), {0.25f, 0.5f, 2})});
        addRoundRoom(world.geometry, scale, 16);
        GatherSettings settings;
        settings.emission = true;
        const GatherResult result =
            world.bounce(pointsFacing({{0, -0.98f * scale, 0}, {0, 0, 0}}, {0, 1, 0}), settings);
        for (int i = 0; i < 2; ++i) {
            EXPECT_FLOAT_EQ(result.light.at(i, 0, 0), 0.25f) << scale;
            EXPECT_FLOAT_EQ(result.light.at(i, 0, 2), 2.0f) << scale;
        }
        EXPECT_LT(result.noise, 1e-6);
        settings.emission = false;
        EXPECT_EQ(world.bounce(pointsFacing({{0, 0, 0}}, {0, 1, 0}), settings).light.at(0, 0, 1), 0.0f);
    }
}

TEST(ReferenceIndirectDiffuse, TheIntegratingSphere) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf({0.5f, 0.25f, 0})});
    addRoundRoom(world.geometry, 2, 64);
    GatherSettings settings;
    settings.samples = 512;
    const GatherInputs inputs =
        pointsFacing({{0, -1.99f, 0}, {0.5f, 0.5f, 0}}, glm::normalize(glm::vec3(0.2f, 1, 0)));
    // Every point of the wall gets I / R^2.
    world.lights = {lightOf(LightKind::Point, {0, 0, 0}, 3)};
    const float byPoint = 3.0f / 4 / pi;
    for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR(world.bounce(inputs, settings).light.at(i, 0, 0), 0.5f * byPoint, 0.005f * byPoint);
        EXPECT_NEAR(world.bounce(inputs, settings).light.at(i, 0, 1), 0.25f * byPoint, 0.005f * byPoint);
        EXPECT_EQ(world.bounce(inputs, settings).light.at(i, 0, 2), 0.0f);
    }
    // Of a sphere light pi L (r / R)^2.
    world.lights = {lightOf(LightKind::Sphere, {0, 0, 0}, 3)};
    world.lights[0].halfSize.x = 0.5f;
    EXPECT_NEAR(world.bounce(inputs, settings).light.at(0, 0, 0), 0.5f * 3 / 16, 0.002f);
    // A spot that sends its light into the upper half alone: the lower stays dark, a point in the middle that
    // looks up sees the upper wall, one that looks down sees nothing.
    LightState spot = lightOf(LightKind::Spot, {0, 0, 0}, 3);
    spot.direction = {0, 1, 0};
    spot.innerCone = 0.5f * pi - 0.001f;
    spot.outerCone = 0.5f * pi;
    world.lights = {spot};
    EXPECT_NEAR(world.bounce(pointsFacing({{0, 0, 0}}, {0, 1, 0}), settings).light.at(0, 0, 0),
                0.5f * byPoint, 0.01f * byPoint);
    EXPECT_NEAR(world.bounce(pointsFacing({{0, 0, 0}}, {0, -1, 0}), settings).light.at(0, 0, 0), 0, 1e-4f);
    // Out of its range a light gives nothing; at 1 / 2 of it the window is 15 / 16.
    world.lights = {lightOf(LightKind::Point, {0, 0, 0}, 3)};
    world.lights[0].range = 1.9f;
    EXPECT_EQ(world.bounce(inputs, settings).light.at(0, 0, 0), 0.0f);
    world.lights[0].range = 4;
    EXPECT_NEAR(world.bounce(inputs, settings).light.at(0, 0, 0), 0.5f * byPoint * 15 / 16, 0.005f * byPoint);
}

TEST(ReferenceIndirectDiffuse, TheSunOnAFloorSeenFromAbove) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf({0.8f, 0.4f, 0.2f})});
    addSquare(world.geometry, {-1e4f, 0, -1e4f}, {0, 0, 2e4f}, {2e4f, 0, 0});
    LightState sun = lightOf(LightKind::Directional, {}, 5);
    sun.direction = glm::normalize(glm::vec3(1, -1, 0));
    world.lights = {sun};
    const GatherResult result = world.bounce(pointsFacing({{0, 1, 0}}, {0, -1, 0}), {});
    EXPECT_NEAR(result.light.at(0, 0, 0), 0.8f / pi * 5 * std::sqrt(0.5f), 1e-3f);
}

// One patch lights another: a square under a lamp, and a point that faces askew, by a sum over the square.
TEST(ReferenceIndirectDiffuse, ALampOverASquareIsItsIntegralElsewhere) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf({0.8f, 0.4f, 0.2f})});
    addSquare(world.geometry, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
    const LightState lamp = lightOf(LightKind::Point, {0.3f, 0.7f, -0.2f}, 5);
    world.lights = {lamp};
    GatherSettings settings;
    settings.samples = 1 << 15;
    const glm::vec3 normal = glm::normalize(glm::vec3(-0.6f, -0.8f, 0.1f));
    const std::vector<glm::vec3> points = {{0.5f, 0.5f, 0}, {1.5f, 1, 0.4f}, {0, 2, -1}};
    const GatherResult result = world.bounce(pointsFacing(points, normal), settings);
    constexpr int n = 400;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 p(points[static_cast<size_t>(i)]), facing(normal);
        double sum = 0;
        for (int x = 0; x < n; ++x)
            for (int z = 0; z < n; ++z) {
                const glm::dvec3 q(2 * (x + 0.5) / n - 1, 0, 2 * (z + 0.5) / n - 1);
                const glm::dvec3 toLamp = glm::dvec3(lamp.position) - q, to = q - p;
                const double arrives = 5 * toLamp.y / std::pow(glm::length(toLamp), 3);
                const double cosines = std::max(0.0, glm::dot(to, facing)) * -to.y;
                sum += arrives * cosines / std::pow(glm::dot(to, to), 2);
            }
        const double pi2 = std::numbers::pi * std::numbers::pi;
        const double expected = 0.8 / pi2 * sum * 4 / (double{n} * n);
        EXPECT_NEAR(result.light.at(i, 0, 0), expected, 3e-3 * expected + 4 * result.noise) << i;
        EXPECT_NEAR(result.light.at(i, 0, 2), expected / 4, 3e-3 * expected + 4 * result.noise) << i;
    }
    EXPECT_LT(result.noise, 2e-3);
}

TEST(ReferenceIndirectDiffuse, OpenPlaneAndHalfASky) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf(glm::vec3(0.5f))});
    addSquare(world.geometry, {-10, 0, -10}, {0, 0, 20}, {20, 0, 0});
    GatherSettings settings;
    settings.environment = {0.25f, 1, 3};
    const GatherResult open = world.bounce(pointsFacing({{0, 0, 0}}, {0, 1, 0}), settings);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(open.light.at(0, 0, k), settings.environment[k]);
    // A wall beside the point, wide and high over its distance, takes half of the sky.
    addSquare(world.geometry, {-0.001f, 0, -10}, {0, 10, 0}, {0, 0, 20});
    settings.samples = 1024;
    const GatherResult half = world.bounce(pointsFacing({{0, 0, 0}}, {0, 1, 0}), settings);
    EXPECT_NEAR(half.light.at(0, 0, 1), 0.5, std::max(4 * half.noise, 1e-3));
}

// The share of light that a lobe without Fresnel sends back, by a sum over directions.
double directionalAlbedo(double cosView, double alpha) {
    const double sinView = std::sqrt(1 - cosView * cosView);
    const auto lambda = [&](double c) {
        return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - c * c) / (c * c)) - 1);
    };
    double sum = 0;
    constexpr int n = 600;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double c = (i + 0.5) / n, phi = 2 * std::numbers::pi * (j + 0.5) / n,
                         s = std::sqrt(1 - c * c);
            const double hx = s * std::cos(phi) + sinView, hy = s * std::sin(phi), hz = c + cosView;
            const double ch = hz / std::sqrt(hx * hx + hy * hy + hz * hz);
            const double q = ch * ch * (alpha * alpha - 1) + 1,
                         d = alpha * alpha / (std::numbers::pi * q * q);
            sum += d / (4 * cosView * c * (1 + lambda(c) + lambda(cosView))) * c;
        }
    return sum * 2 * std::numbers::pi / (double(n) * n);
}

struct Glossy {
    static GatherResult reflect(const LitWorld& world, float cosView, float roughness, float metallic,
                                GatherSettings settings) {
        // The plane y = 0, seen from a distance of 1 at this cosine.
        CameraState camera;
        camera.position = {std::sqrt(1 - cosView * cosView), cosView, 0};
        GatherInputs inputs = pointsFacing({{0, 0, 0}}, {0, 1, 0});
        inputs.albedo = row({{1, 1, 1}});
        inputs.material = row({{roughness, metallic, 0}});
        return world.gather(
            [&](const GatherScene& s) { return gatherGlossyReflection(s, inputs, camera, settings); });
    }
};

TEST(ReferenceGlossyReflection, TheWhiteFurnaceGivesTheAlbedoOfTheLobe) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf(glm::vec3(0.5f))});
    addSquare(world.geometry, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
    GatherSettings settings;
    settings.environment = glm::vec3(1);
    settings.samples = 4096;
    for (const float cosView : {0.2f, 0.6f, 1.0f}) {
        for (const float roughness : {0.5f, 0.8f, 1.0f}) {
            const float light = Glossy::reflect(world, cosView, roughness, 1, settings).light.at(0, 0, 0);
            EXPECT_LE(light, 1.0f);
            EXPECT_NEAR(light, directionalAlbedo(double{cosView}, double{roughness * roughness}), 4e-3)
                << cosView << " " << roughness;
        }
        EXPECT_NEAR(Glossy::reflect(world, cosView, 0, 1, settings).light.at(0, 0, 0), 1.0f, 1e-4f);
    }
    // A smooth dielectric: Schlick's term alone.
    EXPECT_NEAR(Glossy::reflect(world, 1, 0, 0, settings).light.at(0, 0, 0), 0.04f, 1e-5f);
    EXPECT_NEAR(Glossy::reflect(world, 0.5f, 0, 0, settings).light.at(0, 0, 0), 0.04f + 0.96f / 32, 1e-4f);
}

TEST(ReferenceGlossyReflection, AMirrorShowsWhatStandsOnTheOtherSide) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf(glm::vec3(0.5f)), matteOf(glm::vec3(0), {2, 3, 4})});
    addSquare(world.geometry, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
    // The eye stands at +x; a small square where its mirror direction goes.
    addSquare(world.geometry, {-0.82f, 0.78f, -0.02f}, {0.04f, 0.04f, 0}, {0, 0, 0.04f}, 1);
    GatherSettings settings;
    settings.emission = true;
    const GatherResult result = Glossy::reflect(world, std::sqrt(0.5f), 0, 1, settings);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(result.light.at(0, 0, k), 2 + k, 1e-3f);
    EXPECT_EQ(Glossy::reflect(world, 0.5f, 0, 1, settings).light.at(0, 0, 0),
              0.0f); // it looks past the square
}

struct GatherNoise : testing::Test {
    GatherNoise() {
        world.scene = materialsScene({matteOf({0.7f, 0.5f, 0.3f})});
        addSquare(world.geometry, {-2, 0, -2}, {0, 0, 4}, {4, 0, 0});
        addSquare(world.geometry, {-2, 0, -1}, {4, 0, 0}, {0, 3, 0});
        addSquare(world.geometry, {-0.5f, 0.5f, -0.5f}, {0, 0, 1}, {1, 0, 0});
        world.lights = {lightOf(LightKind::Point, {0.3f, 2, 0.5f}, 4),
                        lightOf(LightKind::Rectangle, {0, 2.5f, 0}, 2)};
        world.lights[1].halfSize = {0.4f, 0.4f};
        std::vector<glm::vec3> points;
        for (int i = 0; i < 400; ++i)
            points.emplace_back(-1 + 0.1f * static_cast<float>(i % 20), 0,
                                -0.9f + 0.1f * static_cast<float>(i / 20));
        inputs = pointsFacing(points, {0, 1, 0});
    }
    LitWorld world;
    GatherInputs inputs;
};

TEST_F(GatherNoise, IsWhatTheNoiseSaysAndShrinks) {
    GATHER_NEEDS_EMBREE();
    for (const bool shadow : {false, true}) {
        const auto made = [&](int samples, std::uint32_t seed) {
            GatherSettings settings;
            settings.samples = samples;
            settings.seed = seed;
            return shadow ? world.shadow(inputs, settings) : world.bounce(inputs, settings);
        };
        const GatherResult truth = made(4096, 2), few = made(16, 1), many = made(256, 1);
        for (const GatherResult* result : {&few, &many}) {
            double sum = 0;
            for (size_t i = 0; i < truth.light.values.size(); ++i)
                sum += std::pow(result->light.values[i] - truth.light.values[i], 2);
            const double rms = std::sqrt(sum / static_cast<double>(truth.light.values.size()));
            EXPECT_GT(result->noise, 0.6 * rms) << shadow;
            EXPECT_LT(result->noise, 1.5 * rms) << shadow;
        }
        // 16 times the samples: at most a quarter of the noise.
        EXPECT_LT(many.noise, 0.3 * few.noise) << shadow;
    }
}

TEST_F(GatherNoise, DoesNotDependOnThreads) {
    GATHER_NEEDS_EMBREE();
    GatherSettings settings;
    settings.samples = 16;
    settings.threads = 1;
    const GatherResult one = world.bounce(inputs, settings);
    settings.threads = 3;
    EXPECT_EQ(one.light, world.bounce(inputs, settings).light);
    settings.seed = 1;
    EXPECT_NE(one.light, world.bounce(inputs, settings).light);
}

// The shading normal leans by 60 degrees: the share (1 + cos 60) / 2 of its cosine-weighted hemisphere is
// above the face, and what is below it is the surface itself.
TEST(ReferenceGather, NothingArrivesFromBelowTheFace) {
    GATHER_NEEDS_EMBREE();
    const glm::vec3 leaning(std::sqrt(0.75f), 0.5f, 0);
    LitWorld world;
    world.scene = materialsScene({matteOf(glm::vec3(0.5f), glm::vec3(1, 2, 3))});
    addSquare(world.geometry, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
    GatherInputs inputs = pointsFacing({{0, 0, 0}}, leaning);
    inputs.faceNormal = row({{0, 1, 0}});
    GatherSettings settings;
    settings.samples = 8192;
    settings.emission = true;
    settings.environment = {1, 2, 4};
    const GatherResult bounce = world.bounce(inputs, settings);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(bounce.light.at(0, 0, k), 0.75f * settings.environment[k],
                    0.005f * settings.environment[k]);
    // A lamp below the face, in front of the normal, brings nothing, and what it would bring is shadowed.
    world.geometry = {};
    addSquare(world.geometry, {9, 9, 9}, {0, 0, 1}, {1, 0, 0});
    settings.emission = false;
    LightState lamp = lightOf(LightKind::Sphere, {1, -0.2f, 0}, 1);
    lamp.halfSize.x = 0.1f;
    world.lights = {lamp};
    const GatherResult below = world.shadow(inputs, settings);
    EXPECT_EQ(below.light.at(0, 0, 0), 0.0f);
    EXPECT_EQ(below.visibility.at(0, 0), 0.0f);
    world.lights[0].position.y = 0.2f;
    const GatherResult above = world.shadow(inputs, settings);
    EXPECT_GT(above.light.at(0, 0, 0), 0.0f);
    EXPECT_EQ(above.visibility.at(0, 0), 1.0f);
}

// A coarse ball with the normals of a round one: nothing that it sends out can come back.
TEST(ReferenceGather, AConvexBodyAloneReceivesExactlyNothingOfItsOwnLight) {
    GATHER_NEEDS_EMBREE();
    LitWorld world;
    world.scene = materialsScene({matteOf(glm::vec3(0.8f))});
    addRoundRoom(world.geometry, 1, 5);
    world.lights = {lightOf(LightKind::Directional, {}, 3)};
    CameraState camera;
    camera.view = glm::lookAt(glm::vec3(1, 2, 3), glm::vec3(0), glm::vec3(0, 1, 0));
    camera.position = {1, 2, 3};
    camera.nearPlane = 0.1f;
    const ReferenceTracer tracer(world.geometry, world.scene);
    const PrimaryHits seen = primaryHits(tracer, world.geometry, camera, 64, 64);
    ASSERT_GT(std::count(seen.triangles.begin(), seen.triangles.end(), TraceHit::none), 500);
    ASSERT_LT(std::count(seen.triangles.begin(), seen.triangles.end(), TraceHit::none), 3500);
    GatherInputs inputs{seen.position, seen.normal, seen.faceNormal, Image(64, 64, 3, 0.8f),
                        Image(64, 64, 3, 0.4f)};
    const GatherScene scene{tracer, world.geometry, world.scene, world.lights};
    for (const GatherResult& result :
         {gatherIndirectDiffuse(scene, inputs, {}), gatherGlossyReflection(scene, inputs, camera, {})})
        for (const float value : result.light.values) ASSERT_EQ(value, 0.0f);
    // By the normals alone it does: that is what the face is for.
    inputs.faceNormal = {};
    double sum = 0;
    for (const float value : gatherIndirectDiffuse(scene, inputs, {}).light.values) sum += double{value};
    EXPECT_GT(sum, 0);
}

TEST(ReferenceGather, EmptyAndDegenerateScenes) {
    GATHER_NEEDS_EMBREE();
    GatherSettings settings;
    settings.emission = true;
    settings.samples = 1;
    LitWorld empty;
    EXPECT_EQ(empty.shadow(pointsFacing({{0, 0, 0}}, {0, 1, 0}), settings).light.at(0, 0, 0), 0.0f);
    EXPECT_EQ(empty.shadow(pointsFacing({{0, 0, 0}}, {0, 1, 0}), settings).visibility.at(0, 0), 1.0f);
    LitWorld flat; // triangles without area that glow, lights without size, points on the lights
    flat.scene = materialsScene({matteOf(glm::vec3(1), glm::vec3(1))});
    addFace(flat.geometry, {}, {}, 0);
    addFace(flat.geometry, {glm::vec3(-1, 0, 0), {0, 0, 0}, {1, 0, 0}}, {}, 0);
    for (const LightKind kind :
         {LightKind::Point, LightKind::Spot, LightKind::Directional, LightKind::Rectangle, LightKind::Sphere})
        flat.lights.push_back(lightOf(kind, {0, 0, 0}, 1));
    const GatherInputs inputs = pointsFacing({{0, 0, 0}, {0, -1, 0}}, {0, 1, 0});
    for (const GatherResult& result : {flat.shadow(inputs, settings), flat.bounce(inputs, settings)})
        for (const float value : result.light.values) EXPECT_TRUE(std::isfinite(value));
    GatherInputs bad = inputs;
    bad.normal = Image(1, 1, 2);
    try {
        (void)flat.bounce(bad, settings);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.problems().size(), 2u);
    }
}

TEST(AreaEmitters, AreChosenByAreaTimesLuminance) {
    Geometry geometry;
    Scene scene = materialsScene({matteOf(glm::vec3(0), glm::vec3(1)), matteOf(glm::vec3(0), glm::vec3(0)),
                                  matteOf(glm::vec3(0), glm::vec3(4))});
    scene.materials[2].doubleSided = true;
    addSquare(geometry, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0);
    addSquare(geometry, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, 1);
    addSquare(geometry, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, 2);
    const auto emitters = areaEmitters({}, geometry, scene, true);
    ASSERT_EQ(emitters.size(), 4u);
    EXPECT_FLOAT_EQ(emitters[0].probability, 0.5f / 9);
    EXPECT_FLOAT_EQ(emitters[3].probability, 4.0f / 9);
    EXPECT_EQ(emitters[3].upper, 1.0f);
    EXPECT_TRUE(emitters[3].bothSides);
    EXPECT_TRUE(areaEmitters({}, geometry, scene, false).empty());
}

TEST(SurfaceSampler, ReadsTexturesAsTheirSamplersDo) {
    Geometry geometry;
    Scene scene;
    scene.images.push_back({"two", 2, 1, {255, 0, 0, 255, 0, 0, 188, 255}});
    Material material = matteOf({1, 1, 0.5f}, glm::vec3(2));
    material.baseColourTexture.image = material.emissionTexture.image = 0;
    material.emissionTexture.nearest = true;
    scene.materials = {material};
    addSquare(geometry, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    for (size_t i = 0; i < geometry.positions.size(); ++i)
        geometry.attributes[i].texCoord = glm::vec2(geometry.positions[i]);
    const SurfaceSampler sampler(geometry, scene);
    // The middle of the first triangle's edge (0.5, 0.5): half of each texel, decoded first (188 is 0.503
    // linear).
    const SurfaceSample middle = sampler.at({1, 0, 0.5f, 0}, {0, 0, -1});
    EXPECT_NEAR(middle.albedo.r, 0.5f, 1e-6f);
    EXPECT_NEAR(middle.albedo.b, 0.5f * 0.5f * 0.5029f, 1e-4f);
    EXPECT_EQ(middle.faceNormal, glm::vec3(0, 0, 1));
    EXPECT_EQ(sampler.at({1, 0, 0.5f, 0}, {0, 0, 1}).normal, glm::vec3(0, 0, -1));
    EXPECT_EQ(sampler.emission(0, 0.1f, 0.1f), glm::vec3(2, 0, 0)); // at (0.2, 0.1)
}

} // namespace
} // namespace kestrel
