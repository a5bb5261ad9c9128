// Blended surfaces by the reference where they are known by hand.
#include "core/error.h"
#include "core/version.h"
#include "reference/transparency.h"
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <numbers>

namespace kestrel {
namespace {

#define TRANSPARENCY_NEEDS_EMBREE()                                                                          \
    if (parts().find("embree") == std::string::npos) GTEST_SKIP() << "built without Embree"

// Squares that face +z, of half size 10, one behind the other; the camera looks along -z from the origin.
struct Panes {
    Geometry geometry;
    Scene scene;
    std::vector<LightState> lights;
    CameraState camera;

    Material& add(float z, const glm::vec4& colour, AlphaMode mode = AlphaMode::Blend) {
        Material material;
        material.baseColour = colour;
        material.metallic = 0;
        material.alphaMode = mode;
        const auto index = static_cast<std::uint32_t>(scene.materials.size());
        scene.materials.push_back(material);
        const glm::vec3 a(-10, -10, z), b(10, -10, z), c(10, 10, z), d(-10, 10, z);
        for (const glm::vec3& corner : {a, b, c, a, c, d}) {
            geometry.indices.push_back(static_cast<std::uint32_t>(geometry.positions.size()));
            geometry.positions.push_back(corner);
            geometry.attributes.emplace_back();
            geometry.bounds.add(corner);
        }
        geometry.materials.insert(geometry.materials.end(), 2, index);
        // All as alpha-tested: those that are opaque pass.
        geometry.ranges[static_cast<size_t>(TriangleClass::Masked)] = {0, geometry.triangleCount()};
        return scene.materials.back();
    }
    [[nodiscard]] TransparencyResult over(const glm::vec4& behind,
                                          const TransparencySettings& settings = {}) const {
        Image opaque(2, 2, 4);
        for (int y = 0; y < 2; ++y)
            for (int x = 0; x < 2; ++x)
                for (int k = 0; k < 4; ++k) opaque.at(x, y, k) = behind[k];
        const ReferenceTracer seen(geometry, scene, false), tracer(geometry, scene);
        return compositeBlended({tracer, geometry, scene, lights}, seen, camera, opaque, settings);
    }
};

glm::vec4 at(const TransparencyResult& result) {
    const Image& image = result.picture;
    return {image.at(1, 1, 0), image.at(1, 1, 1), image.at(1, 1, 2), image.at(1, 1, 3)};
}

void expectNear(const glm::vec4& made, const glm::vec4& wanted, float room = 1e-6f) {
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(made[k], wanted[k], room) << k;
}

TEST(ReferenceTransparency, UnlitPanesComeInTheOrderOfDepth) {
    TRANSPARENCY_NEEDS_EMBREE();
    Panes panes;
    panes.add(-3, {0, 0, 1, 0.25f}).unlit = true;
    panes.add(-2, {1, 0, 0, 0.5f}).unlit = true;
    panes.add(-4, {0, 1, 0, 0.01f}).unlit = true; // far below its cutoff
    const TransparencyResult result = panes.over({0.5f, 0.5f, 0.5f, 0});
    const float through = 0.5f * 0.75f * 0.99f;
    expectNear(at(result), {0.5f + 0.5f * through, 0.5f * 0.75f * 0.01f + 0.5f * through,
                            0.5f * 0.25f + 0.5f * through, 1 - through});
    EXPECT_EQ(result.surfaces.at(0, 0), 3);
}

TEST(ReferenceTransparency, WhatIsOpaqueEndsTheListAndBacksAreNotThere) {
    TRANSPARENCY_NEEDS_EMBREE();
    Panes panes;
    panes.add(-2, {1, 0, 0, 0.5f}).unlit = true;
    panes.add(-3, {1, 1, 1, 1}, AlphaMode::Opaque);
    panes.add(-4, {0, 1, 0, 0.5f}).unlit = true;
    expectNear(at(panes.over({0.2f, 0.4f, 0.6f, 1})), {0.6f, 0.2f, 0.3f, 1});
    // A masked pane below its cutoff does not.
    panes.scene.materials[1].alphaMode = AlphaMode::Mask;
    panes.scene.materials[1].baseColour.a = 0.4f;
    expectNear(at(panes.over({0.2f, 0.4f, 0.6f, 1})), {0.55f, 0.35f, 0.15f, 1});
    // From behind nothing is there but what has two sides.
    panes.camera.view = glm::lookAt(glm::vec3(0, 0, -6), glm::vec3(0, 0, 0), glm::vec3(0, 1, 0));
    panes.camera.position = {0, 0, -6};
    expectNear(at(panes.over({0.2f, 0.4f, 0.6f, 1})), {0.2f, 0.4f, 0.6f, 1});
    panes.scene.materials[2].doubleSided = true;
    expectNear(at(panes.over({0.2f, 0.4f, 0.6f, 1})), {0.1f, 0.7f, 0.3f, 1});
}

TEST(ReferenceTransparency, PanesAreLitAndShadowedAsHitsOfRaysAre) {
    TRANSPARENCY_NEEDS_EMBREE();
    Panes panes;
    panes.add(-2, {0.8f, 0.4f, 0.2f, 0.25f}).emission = {0, 0, 0.5f};
    LightState sun;
    sun.kind = LightKind::Directional;
    sun.direction = glm::normalize(glm::vec3(0, -3, -4));
    sun.intensity = glm::vec3(2);
    panes.lights = {sun};
    TransparencySettings settings;
    settings.ambient = glm::vec3(0.1f);
    const float light = 2 * 0.8f / std::numbers::pi_v<float> + 0.1f;
    const auto expected = [&](float received) {
        return glm::vec4(0.25f * (0.8f * received), 0.25f * 0.4f * received, 0.25f * (0.2f * received + 0.5f),
                         0.25f);
    };
    expectNear(at(panes.over(glm::vec4(0), settings)), expected(light), 1e-5f);
    // A pane in the light's way shadows where its alpha is at least its cutoff, and is out of sight here.
    panes.add(1, {1, 1, 1, 0.4f});
    expectNear(at(panes.over(glm::vec4(0), settings)), expected(light), 1e-5f);
    panes.scene.materials.back().baseColour.a = 0.6f;
    expectNear(at(panes.over(glm::vec4(0), settings)), expected(0.1f), 1e-5f);
    settings.shadows = false;
    expectNear(at(panes.over(glm::vec4(0), settings)), expected(light), 1e-5f);
    settings.emission = false;
    EXPECT_NEAR(at(panes.over(glm::vec4(0), settings)).z, 0.25f * 0.2f * light, 1e-5f);
}

TEST(ReferenceTransparency, TooFewChannelsAreRefused) {
    TRANSPARENCY_NEEDS_EMBREE();
    const Panes panes;
    const ReferenceTracer tracer(panes.geometry, panes.scene);
    EXPECT_THROW(compositeBlended({tracer, panes.geometry, panes.scene, panes.lights}, tracer, panes.camera,
                                  Image(1, 1, 1), {}),
                 InputError);
}

} // namespace
} // namespace kestrel
