#include "draw/near_scene.h"
#include "draw/view_data.h"
#include "graph/pass.h"
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <set>

namespace kestrel {
namespace {

CameraState cameraLooking(const glm::vec3& position, const glm::vec3& at) {
    CameraState camera;
    camera.position = position;
    camera.view = glm::lookAt(position, at, glm::vec3(0, 1, 0));
    camera.nearPlane = 0.1F;
    camera.farPlane = 50;
    return camera;
}

const CameraState someCamera = cameraLooking({1, 2, 5}, {0, 0.5F, 0});
constexpr Extent frameSize{640, 360, 1};

ViewData viewOf(const View& view, const Extent& size = frameSize, const CameraState& camera = someCamera,
                std::uint32_t index = 0) {
    World world;
    world.size = size;
    return viewData(view, world.extentOf(view), ViewFrame{size, index, camera, camera});
}

// Image coordinates, counted from the lower left corner, and depth.
glm::dvec3 project(const ViewData& view, const glm::vec3& position) {
    const glm::dvec4 clip = glm::dmat4(view.viewProjection) * glm::dvec4(position, 1);
    return {(clip.x / clip.w * 0.5 + 0.5) * view.size.x, (clip.y / clip.w * 0.5 + 0.5) * view.size.y,
            clip.z / clip.w};
}

const glm::vec3 points[] = {{0, 0.5F, 0}, {1, 1, 1}, {-2, 0, -3}, {0.3F, 1.7F, 2}, {-1, 3, -20}};
// A thousandth of a pixel: what rounding a float matrix can move a point by, and far below what is seen.
constexpr double pixelTolerance = 1e-3;

TEST(ViewData, WithoutGuardDivisorAndJitterItIsTheCamera) {
    const ViewData view = viewOf({});
    EXPECT_EQ(view.projection, someCamera.projection(640.0F / 360.0F));
    EXPECT_EQ(view.view, someCamera.view);
    EXPECT_EQ(view.size, glm::uvec2(640, 360));
    EXPECT_EQ(view.guard, 0U);
    EXPECT_EQ(view.divisor, 1U);
    EXPECT_EQ(view.jitter, glm::vec2(0));
    EXPECT_EQ(view.position, glm::vec4(1, 2, 5, 0));
    EXPECT_EQ(view.nearPlane, 0.1F);
    EXPECT_EQ(view.farPlane, 50);
}

TEST(ViewData, TheInnerPartOfAGuardedImageIsTheUnguardedImage) {
    for (const Extent size : {frameSize, Extent{1, 1, 1}, Extent{37, 11, 1}}) {
        const ViewData plain = viewOf({}, size);
        for (const int guard : {1, 16, 33}) {
            const ViewData guarded = viewOf({.guard = guard}, size);
            EXPECT_EQ(guarded.size, plain.size + 2U * static_cast<unsigned>(guard));
            EXPECT_EQ(guarded.guard, static_cast<unsigned>(guard));
            for (const glm::vec3& point : points) {
                const glm::dvec3 a = project(plain, point);
                const glm::dvec3 b = project(guarded, point);
                EXPECT_NEAR(b.x, a.x + guard, pixelTolerance);
                EXPECT_NEAR(b.y, a.y + guard, pixelTolerance);
                EXPECT_NEAR(b.z, a.z, 1e-6);
            }
        }
    }
}

TEST(ViewData, APixelOfADividedImageCoversDivisorPixels) {
    for (const Extent size : {frameSize, Extent{101, 7, 1}}) {
        const ViewData plain = viewOf({}, size);
        for (const int divisor : {2, 3, 4}) {
            for (const int guard : {0, 8, 12}) {
                const ViewData divided = viewOf({.divisor = divisor, .guard = guard}, size);
                EXPECT_EQ(divided.divisor, static_cast<unsigned>(divisor));
                EXPECT_EQ(divided.guard, static_cast<unsigned>(guard / divisor));
                for (const glm::vec3& point : points) {
                    const glm::dvec3 a = project(plain, point);
                    const glm::dvec3 b = project(divided, point);
                    EXPECT_NEAR(b.x, a.x / divisor + guard / divisor, pixelTolerance);
                    EXPECT_NEAR(b.y, a.y / divisor + guard / divisor, pixelTolerance);
                }
            }
        }
    }
}

TEST(ViewData, JitterMovesTheSamplesAndOnlyWhereAsked) {
    const ViewData plain = viewOf({}, frameSize, someCamera, 5);
    const ViewData jittered = viewOf({.jitter = true}, frameSize, someCamera, 5);
    EXPECT_EQ(jittered.jitter, jitterOf(5));
    EXPECT_NE(jittered.jitter, glm::vec2(0));
    for (const glm::vec3& point : points) {
        // What the sample at the pixel's centre sees stands at centre + jitter without it.
        const glm::dvec2 moved = glm::dvec2(project(plain, point)) - glm::dvec2(project(jittered, point));
        EXPECT_NEAR(moved.x, double(jittered.jitter.x), pixelTolerance);
        EXPECT_NEAR(moved.y, double(jittered.jitter.y), pixelTolerance);
    }
    EXPECT_EQ(jittered.previousViewProjection, plain.viewProjection);
}

TEST(ViewData, ThePreviousViewIsThePreviousCameras) {
    const CameraState before = cameraLooking({0, 1, 4}, {0, 0, 0});
    const View view{.guard = 4, .jitter = true};
    const Extent extent{648, 368, 1};
    const ViewData now = viewData(view, extent, ViewFrame{frameSize, 3, someCamera, before});
    const ViewData then = viewData({.guard = 4}, extent, ViewFrame{frameSize, 2, before, before});
    EXPECT_EQ(now.previousViewProjection, then.viewProjection);
}

TEST(ViewData, InversesUndoTheProjectionNearAndFar) {
    for (const float scale : {1e-4F, 1.0F, 1e4F}) {
        for (const float farPlane : {0.0F, 1e6F}) {
            for (const bool orthographic : {false, true}) {
                if (orthographic && farPlane == 0) continue;
                CameraState camera = cameraLooking(scale * glm::vec3(1, 2, 5), scale * glm::vec3(0, 0.5F, 0));
                camera.nearPlane = scale;
                camera.farPlane = scale * farPlane;
                camera.orthographic = orthographic;
                camera.halfHeight = 3 * scale;
                const ViewData view =
                    viewOf({.divisor = 2, .guard = 10, .jitter = true}, frameSize, camera, 7);
                EXPECT_EQ(view.position.w, orthographic ? 1 : 0);
                for (const glm::vec3& point : points) {
                    const glm::dvec3 at = project(view, scale * point);
                    const glm::dvec4 clip(at.x / view.size.x * 2 - 1, at.y / view.size.y * 2 - 1, at.z, 1);
                    const glm::dvec4 eye = glm::dmat4(view.inverseProjection) * clip;
                    const glm::dvec4 back =
                        glm::dmat4(view.inverseView) * glm::dvec4(glm::dvec3(eye) / eye.w, 1);
                    // Relative to the distance, of which depth keeps 24 bits in perspective. An orthographic
                    // depth is linear, so near points have the absolute error of the far plane.
                    const double reach = orthographic ? 1e6 : 25.0;
                    EXPECT_LT(glm::length(glm::dvec3(back) / double(scale) - glm::dvec3(point)),
                              1e-5 * reach);
                }
            }
        }
    }
}

TEST(ViewData, AnInfiniteFarPlaneIsToldAsZero) {
    CameraState camera = someCamera;
    camera.farPlane = -1;
    EXPECT_EQ(viewOf({}, frameSize, camera).farPlane, 0);
}

TEST(Jitter, IsHaltonAroundTheCentre) {
    const glm::dvec2 first[] = {{0.0, 1.0 / 3 - 0.5}, {-0.25, 2.0 / 3 - 0.5}, {0.25, 1.0 / 9 - 0.5}};
    for (std::uint32_t i = 0; i < 3; ++i) {
        EXPECT_EQ(jitterOf(i).x, static_cast<float>(first[i].x));
        EXPECT_NEAR(double(jitterOf(i).y), first[i].y, 1e-7);
    }
    std::set<std::pair<float, float>> seen;
    glm::dvec2 sum(0);
    for (std::uint32_t i = 0; i < jitterPeriod; ++i) {
        const glm::vec2 jitter = jitterOf(i);
        EXPECT_LT(std::abs(jitter.x), 0.5F);
        EXPECT_LT(std::abs(jitter.y), 0.5F);
        seen.emplace(jitter.x, jitter.y);
        sum += glm::dvec2(jitter);
    }
    EXPECT_EQ(seen.size(), jitterPeriod);
    EXPECT_LT(glm::length(sum / double(jitterPeriod)), 0.02);
    EXPECT_EQ(jitterOf(jitterPeriod + 3), jitterOf(3));
}

// A scene of a few metres is taken whole; of one of kilometres what the camera sees from near, however far it
// goes; and scale does not matter.
TEST(NearScene, OfAWideSceneIsWhatTheCameraSees) {
    for (const float scale : {1e-3F, 1.0F, 1e3F}) {
        CameraState camera = cameraLooking(scale * glm::vec3(1, 2, 5), glm::vec3(0));
        camera.nearPlane = 0.05F * scale;
        SceneFacts facts;
        facts.sphere = {scale * glm::vec3(1, 0, 0), 40 * scale};
        EXPECT_FALSE(isWide(facts, camera));
        EXPECT_EQ(nearScene(facts, camera).radius, facts.sphere.radius);
        EXPECT_EQ(nearScene(facts, camera).centre, facts.sphere.centre);
        for (const float radius : {60.0F, 1e5F}) {
            facts.sphere.radius = radius * scale;
            EXPECT_TRUE(isWide(facts, camera));
            const Sphere near = nearScene(facts, camera);
            EXPECT_FLOAT_EQ(near.radius, 256 * 0.05F * scale);
            EXPECT_NEAR(glm::length(near.centre - camera.position), near.radius, 1e-4F * near.radius);
            // Ahead: towards the origin.
            EXPECT_LT(glm::dot(near.centre - camera.position, camera.position), 0);
        }
        camera.orthographic = true;
        EXPECT_EQ(nearScene(facts, camera).radius, facts.sphere.radius);
    }
}

} // namespace
} // namespace kestrel
