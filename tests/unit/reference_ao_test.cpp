// The reference tracer against brute force and the BVH, and ambient occlusion where it is known by hand.
#include "core/error.h"
#include "core/version.h"
#include "reference/ambient_occlusion.h"
#include "reference/primary_hits.h"
#include "reference/tracer.h"
#include "scene/builtin.h"
#include "scene/bvh_trace.h"
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>
#include <set>

namespace kestrel {
namespace {

bool hasEmbree() { return parts().find("embree") != std::string::npos; }

#define NEEDS_EMBREE()                                                                                       \
    if (!hasEmbree()) GTEST_SKIP() << "built without Embree"

void addTriangle(Geometry& g, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 normal = glm::cross(b - a, c - a);
    for (const glm::vec3& p : {a, b, c}) {
        g.indices.push_back(static_cast<std::uint32_t>(g.positions.size()));
        g.positions.push_back(p);
        g.attributes.emplace_back();
        if (glm::length(normal) > 0) g.attributes.back().normal = glm::normalize(normal);
        g.bounds.add(p);
    }
    g.materials.push_back(0);
    g.ranges[0].count = g.triangleCount();
}

void addQuad(Geometry& g, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
    addTriangle(g, corner, corner + u, corner + u + v);
    addTriangle(g, corner, corner + u + v, corner + v);
}

// An image of one pixel row: points that look along one normal.
OcclusionInputs points(const std::vector<glm::vec3>& positions, const glm::vec3& normal) {
    OcclusionInputs inputs;
    inputs.position = Image(static_cast<int>(positions.size()), 1, 3);
    inputs.normal = Image(static_cast<int>(positions.size()), 1, 3);
    for (int i = 0; i < static_cast<int>(positions.size()); ++i) {
        for (int k = 0; k < 3; ++k) {
            inputs.position.at(i, 0, k) = positions[static_cast<size_t>(i)][k];
            inputs.normal.at(i, 0, k) = normal[k];
        }
    }
    return inputs;
}

OcclusionInputs inputsOf(const PrimaryHits& hits) { return {hits.position, hits.normal, hits.faceNormal}; }

TEST(ReferenceAmbientOcclusion, OpenPlaneSeesEverything) {
    NEEDS_EMBREE();
    for (const float scale : {1e-4f, 1.0f, 1e4f}) {
        Geometry g;
        addQuad(g, scale * glm::vec3(-1, 0, -1), {0, 0, 2 * scale}, {2 * scale, 0, 0});
        const ReferenceTracer tracer(g, Scene{});
        const auto result =
            ambientOcclusion(tracer, points({{0, 0, 0}, scale * glm::vec3(0.3f, 0, 0.7f)}, {0, 1, 0}), {});
        EXPECT_EQ(result.visibility.at(0, 0), 1.0f) << scale;
        EXPECT_EQ(result.visibility.at(1, 0), 1.0f) << scale;
        EXPECT_EQ(result.noise, 0);
        EXPECT_EQ(result.rays, 512u);
    }
}

Geometry closedBox(float half, const glm::vec3& centre = {}) {
    Geometry g;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {-1.0f, 1.0f}) {
            glm::vec3 corner = centre - glm::vec3(half), u(0), v(0);
            corner[axis] = centre[axis] + sign * half;
            u[(axis + 1) % 3] = 2 * half;
            v[(axis + 2) % 3] = 2 * half;
            addQuad(g, corner, u, v);
        }
    }
    return g;
}

TEST(ReferenceAmbientOcclusion, ClosedBoxIsDark) {
    NEEDS_EMBREE();
    for (const float scale : {1e-4f, 1.0f, 1e4f}) {
        const ReferenceTracer tracer(closedBox(scale), Scene{});
        const auto on = points({{0, -scale, 0}, scale * glm::vec3(0.99f, -1, -0.99f)}, {0, 1, 0});
        const auto result = ambientOcclusion(tracer, on, {});
        EXPECT_EQ(result.visibility.at(0, 0), 0.0f) << scale;
        EXPECT_EQ(result.visibility.at(1, 0), 0.0f) << scale;
        // Only walls nearer than the maximum distance count: none from the middle of the floor within half
        // the box.
        OcclusionSettings bounded;
        bounded.maximumDistance = 0.9f * scale;
        EXPECT_EQ(ambientOcclusion(tracer, on, bounded).visibility.at(0, 0), 1.0f) << scale;
    }
}

TEST(ReferenceAmbientOcclusion, BoxFarFromTheOriginIsDarkToo) {
    NEEDS_EMBREE();
    const glm::vec3 centre(1000, -2000, 500);
    const ReferenceTracer tracer(closedBox(1, centre), Scene{});
    const auto result = ambientOcclusion(tracer, points({centre - glm::vec3(0, 1, 0)}, {0, 1, 0}), {});
    EXPECT_EQ(result.visibility.at(0, 0), 0.0f);
}

// A wall of height h at distance d hides the share (1 - cos(atan(h / d))) / 2 of the cosine-weighted
// hemisphere.
TEST(ReferenceAmbientOcclusion, WallBesideAFloorHidesTheKnownShare) {
    NEEDS_EMBREE();
    constexpr float far = 1e4f;
    Geometry g;
    addQuad(g, {-far, 0, -far}, {0, 0, 2 * far}, {2 * far, 0, 0});
    addQuad(g, {0, 0, -far}, {0, 1, 0}, {0, 0, 2 * far});
    const ReferenceTracer tracer(g, Scene{});
    OcclusionSettings settings;
    settings.samples = 1 << 14;
    settings.relativeOffset = 1e-9f; // the floor is ten thousand times as large as the wall is high
    const std::vector<float> distances{0.25f, 0.5f, 1, 2, 4};
    std::vector<glm::vec3> on;
    for (const float d : distances) on.emplace_back(d, 0, 0);
    const auto result = ambientOcclusion(tracer, points(on, {0, 1, 0}), settings);
    for (size_t i = 0; i < distances.size(); ++i) {
        const double hidden = 0.5 * (1 - std::cos(std::atan(1 / static_cast<double>(distances[i]))));
        EXPECT_NEAR(result.visibility.at(static_cast<int>(i), 0), 1 - hidden, 0.002) << distances[i];
    }
    EXPECT_LT(result.noise, 0.002);
}

// Within the distance D an endless wall at d hides the directions whose way to it is at most D: those with a
// component towards it of at least c = d / D, a segment of the disk on which the cosine-weighted hemisphere
// is uniform: (acos c - c sqrt(1 - c^2)) / pi.
TEST(ReferenceAmbientOcclusion, WithinADistanceAWallHidesASegmentOfTheDisk) {
    NEEDS_EMBREE();
    Geometry g;
    addQuad(g, {-50, 0, -50}, {0, 0, 100}, {100, 0, 0});
    addQuad(g, {0, 0, -50}, {0, 50, 0}, {0, 0, 100});
    const ReferenceTracer tracer(g, Scene{});
    OcclusionSettings settings;
    settings.samples = 1 << 14;
    settings.relativeOffset = 1e-7f;
    settings.maximumDistance = 2;
    std::vector<glm::vec3> on;
    for (int i = 0; i < 12; ++i) on.emplace_back(0.01f + 0.2f * static_cast<float>(i), 0, 0);
    const auto result = ambientOcclusion(tracer, points(on, {0, 1, 0}), settings);
    for (size_t i = 0; i < on.size(); ++i) {
        const double c = std::min(1.0, double{on[i].x} / 2);
        const double hidden = (std::acos(c) - c * std::sqrt(1 - c * c)) / std::numbers::pi;
        EXPECT_NEAR(result.visibility.at(static_cast<int>(i), 0), 1 - hidden, 0.002) << on[i].x;
    }
}

TEST(ReferenceAmbientOcclusion, DirectionsBelowTheFaceAreOccluded) {
    NEEDS_EMBREE();
    Geometry g;
    addQuad(g, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
    const ReferenceTracer tracer(g, Scene{});
    // The shading normal leans by 60 degrees: the share (1 + cos 60) / 2 of its hemisphere is above the face.
    auto inputs = points({{0, 0, 0}}, {std::sqrt(0.75f), 0.5f, 0});
    inputs.faceNormal = points({{0, 0, 0}}, {0, 1, 0}).normal;
    OcclusionSettings settings;
    settings.samples = 8192;
    EXPECT_NEAR(ambientOcclusion(tracer, inputs, settings).visibility.at(0, 0), 0.75f, 0.003f);
}

class BlobOcclusion : public testing::Test {
protected:
    BlobOcclusion()
        : scene_(builtinScene("builtin:blob?detail=0.1")) {
        finishScene(scene_);
        geometry_ = flatten(scene_, 0);
    }
    [[nodiscard]] PrimaryHits hits(const ReferenceTracer& tracer) const {
        return primaryHits(tracer, geometry_, cameraAt(scene_, 0, 0), 96, 54);
    }
    Scene scene_;
    Geometry geometry_;
};

TEST_F(BlobOcclusion, NoiseIsStatedAndShrinks) {
    NEEDS_EMBREE();
    const ReferenceTracer tracer(geometry_, scene_);
    const OcclusionInputs inputs = inputsOf(hits(tracer));
    const auto occlusion = [&](int samples, std::uint32_t seed) {
        OcclusionSettings settings;
        settings.samples = samples;
        settings.seed = seed;
        return ambientOcclusion(tracer, inputs, settings);
    };
    const auto few = occlusion(16, 1), some = occlusion(64, 1), many = occlusion(256, 1),
               truth = occlusion(2048, 2);
    // Random samples would halve the noise for four times as many; low-discrepancy ones do at least nearly
    // that.
    EXPECT_LT(some.noise, 0.6 * few.noise);
    EXPECT_LT(many.noise, 0.6 * some.noise);
    EXPECT_GT(many.noise, 0);
    for (const auto* result : {&few, &some, &many}) {
        double sum = 0;
        std::uint64_t pixels = 0;
        for (int y = 0; y < 54; ++y) {
            for (int x = 0; x < 96; ++x) {
                const double error = result->visibility.at(x, y) - truth.visibility.at(x, y);
                sum += error * error;
                pixels += inputs.normal.at(x, y, 0) != 0 || inputs.normal.at(x, y, 1) != 0 ? 1 : 0;
            }
        }
        const double rms = std::sqrt(sum / static_cast<double>(pixels));
        EXPECT_GT(result->noise, 0.7 * rms);
        EXPECT_LT(result->noise, 1.4 * rms);
    }
}

TEST_F(BlobOcclusion, DoesNotDependOnThreadsAndReportsProgress) {
    NEEDS_EMBREE();
    const ReferenceTracer tracer(geometry_, scene_);
    const OcclusionInputs inputs = inputsOf(hits(tracer));
    OcclusionSettings settings;
    settings.samples = 16;
    settings.threads = 1;
    const auto one = ambientOcclusion(tracer, inputs, settings);
    for (const int threads : {2, 3}) {
        settings.threads = threads;
        double last = 0;
        settings.progress = [&](double done) {
            EXPECT_GT(done, last);
            last = done;
        };
        const auto other = ambientOcclusion(tracer, inputs, settings);
        EXPECT_EQ(one.visibility, other.visibility);
        EXPECT_EQ(one.noise, other.noise);
        EXPECT_EQ(last, 1);
    }
    settings.progress = {};
    settings.seed = 1;
    EXPECT_NE(one.visibility, ambientOcclusion(tracer, inputs, settings).visibility);
}

TEST_F(BlobOcclusion, PixelsWithoutGeometryAreOpen) {
    NEEDS_EMBREE();
    const ReferenceTracer tracer(geometry_, scene_);
    const PrimaryHits seen = hits(tracer);
    const auto result = ambientOcclusion(tracer, inputsOf(seen), {});
    int empty = 0, dark = 0;
    for (int y = 0; y < 54; ++y) {
        for (int x = 0; x < 96; ++x) {
            const float visibility = result.visibility.at(x, y);
            EXPECT_TRUE(visibility >= 0 && visibility <= 1);
            if (seen.triangles[seen.depth.index(x, y)] == TraceHit::none) {
                ++empty;
                EXPECT_EQ(visibility, 1.0f);
            } else if (visibility < 0.5f) {
                ++dark;
            }
        }
    }
    EXPECT_GT(empty, 500);
    EXPECT_GT(dark, 20);
}

TEST(ReferenceAmbientOcclusion, ImagesThatDoNotFitAreRefusedAllAtOnce) {
    NEEDS_EMBREE();
    const ReferenceTracer tracer(closedBox(1), Scene{});
    try {
        (void)ambientOcclusion(tracer, {Image(4, 4, 3), Image(4, 3, 1), {}}, {});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.problems().size(), 2u);
        EXPECT_THAT(error.what(), testing::HasSubstr("4x3"));
    }
}

TEST(ReferenceTracer, EmptyGeometryIsNeverHit) {
    NEEDS_EMBREE();
    const ReferenceTracer tracer(Geometry{}, Scene{});
    EXPECT_FALSE(tracer.anyHit({}));
    EXPECT_FALSE(tracer.closestHit({}));
}

// Every query of the reference against our own BVH, ray by ray.
TEST(ReferenceTracer, AgreesWithTheBvhOnEveryQuery) {
    NEEDS_EMBREE();
    for (const char* name : {"builtin:lattice?detail=0.3", "builtin:tower?detail=0.1"}) {
        Scene scene = builtinScene(name);
        finishScene(scene);
        const Geometry g = flatten(scene, 0);
        const ReferenceTracer tracer(g, scene);
        const Bvh bvh = buildBvh(g);
        const float size = glm::length(g.bounds.size());
        int rays = 0, differ = 0, most = 0;
        for (int y = 0; y < 45; ++y) {
            const std::vector<TraceRay> row = cameraRays(cameraAt(scene, 0, 0), 80, 45, y);
            std::vector<TraceHit> hits(row.size());
            std::vector<std::uint8_t> any(row.size());
            tracer.closestHits(row, hits, true);
            tracer.anyHits(row, any);
            for (size_t x = 0; x < row.size(); ++x, ++rays) {
                const auto expected = closestHit(bvh, row[x]);
                const auto single = tracer.closestHit(row[x]);
                EXPECT_EQ(single.has_value(), hits[x].triangle != TraceHit::none);
                EXPECT_EQ(tracer.anyHit(row[x]), any[x] != 0);
                std::multiset<std::uint32_t> ours, theirs;
                const auto into = [](std::multiset<std::uint32_t>& all) {
                    return [&all](const TraceHit& hit) {
                        all.insert(hit.triangle);
                        return false;
                    };
                };
                allHits(bvh, row[x], into(ours));
                tracer.allHits(row[x], into(theirs));
                most = std::max(most, static_cast<int>(theirs.size()));
                const bool same =
                    expected.has_value() == single.has_value() && (any[x] != 0) == expected.has_value() &&
                    (!expected || std::abs(expected->t - single->t) <= 1e-5f * size) && ours == theirs;
                if (!same) ++differ;
            }
        }
        // Embree's own test and ours may round a ray along a silhouette to either side.
        EXPECT_LE(differ, rays / 200) << name;
        EXPECT_GT(most, 6) << name;
    }
}

// A sheet of 8 x 8 cells, each of two triangles: rays at its vertices and edges meet it once.
TEST(ReferenceTracer, ASurfaceIsMetOnceAtEveryVertexAndEdge) {
    NEEDS_EMBREE();
    Geometry g;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) addQuad(g, glm::vec3(x, y, 0) / 8.0f, {0.125f, 0, 0}, {0, 0.125f, 0});
    const ReferenceTracer tracer(g, Scene{});
    for (int y = 1; y < 32; ++y)
        for (int x = 1; x < 32; ++x)
            for (const glm::vec3& from :
                 {glm::vec3(x / 32.0f, y / 32.0f, 1), {0.3f, 0.6f, 2}, {-1, 0.1f, -0.7f}}) {
                int hits = 0;
                tracer.allHits({from, glm::vec3(x / 32.0f, y / 32.0f, 0) - from},
                               [&](const TraceHit&) { return ++hits, false; });
                ASSERT_EQ(hits, 1) << x << ", " << y;
            }
}

TEST(ReferenceTracer, OfCoincidentTrianglesTheLowestIsMet) {
    NEEDS_EMBREE();
    for (const int count : {2, 5, 40}) {
        Geometry g;
        addTriangle(g, {9, 9, 9}, {10, 9, 9}, {9, 10, 9});
        const glm::vec3 a(-1, -1, 0), b(1, -1, 0.25f), c(0, 1, -0.5f);
        for (int i = 0; i < count; ++i)
            addTriangle(g,
                        i % 3 == 0   ? a
                        : i % 3 == 1 ? b
                                     : c,
                        i % 3 == 0   ? b
                        : i % 3 == 1 ? c
                                     : a,
                        i % 3 == 0   ? c
                        : i % 3 == 1 ? a
                                     : b);
        const ReferenceTracer tracer(g, Scene{});
        std::vector<TraceRay> rays;
        for (int i = 0; i < 40; ++i)
            rays.push_back(
                {{0.01f * static_cast<float>(i) - 0.2f, 0.02f * static_cast<float>(i % 7), 3}, {0, 0, -1}});
        std::vector<TraceHit> hits(rays.size());
        tracer.closestHits(rays, hits, true);
        for (size_t i = 0; i < rays.size(); ++i) {
            const auto single = tracer.closestHit(rays[i]);
            ASSERT_TRUE(single);
            for (const TraceHit& hit : {hits[i], *single}) {
                EXPECT_EQ(hit.triangle, 1u) << count;
                const glm::vec3 at = a + hit.u * (b - a) + hit.v * (c - a);
                EXPECT_NEAR(at.x, rays[i].origin.x, 1e-5f);
                EXPECT_NEAR(at.y, rays[i].origin.y, 1e-5f);
                EXPECT_NEAR(at.z, 3 - hit.t, 1e-5f);
            }
        }
    }
}

TEST(ReferenceTracer, VisitStopsWhenAsked) {
    NEEDS_EMBREE();
    Geometry g;
    for (int i = 0; i < 40; ++i)
        addTriangle(g, {-1, -1, -0.1f * static_cast<float>(i)}, {1, -1, 0}, {0, 1, 0});
    const ReferenceTracer tracer(g, Scene{});
    const TraceRay ray{{0, -0.5f, 9}, {0, 0, -1}};
    int all = 0, some = 0;
    tracer.allHits(ray, [&](const TraceHit&) {
        ++all;
        return false;
    });
    tracer.allHits(ray, [&](const TraceHit&) { return ++some == 3; });
    EXPECT_EQ(all, 40);
    EXPECT_EQ(some, 3);
}

// A quad whose texture is solid on the left half only, in front of an opaque one.
TEST(ReferenceTracer, AlphaTestLetsRaysThroughHoles) {
    NEEDS_EMBREE();
    for (const AlphaMode mode : {AlphaMode::Mask, AlphaMode::Blend}) {
        Scene scene;
        scene.images.push_back({"half", 2, 1, {255, 255, 255, 255, 255, 255, 255, 0}});
        Material solid, holed;
        holed.alphaMode = mode;
        holed.baseColourTexture.image = 0;
        holed.baseColourTexture.nearest = true;
        scene.materials = {solid, holed};
        Geometry g;
        addQuad(g, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
        addQuad(g, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
        for (size_t i = 6; i < g.positions.size(); ++i)
            g.attributes[i].texCoord = 0.5f + 0.5f * glm::vec2(g.positions[i]);
        g.materials = {0, 0, 1, 1};
        g.ranges[0] = {0, 2};
        g.ranges[static_cast<size_t>(TriangleClass::Masked)] = {2, 2};
        const ReferenceTracer tracer(g, scene);
        const TraceRay left{{-0.5f, 0.1f, 2}, {0, 0, -1}}, right{{0.5f, 0.1f, 2}, {0, 0, -1}};
        // Embree rounds a distance as the processor's instructions do.
        EXPECT_NEAR(tracer.closestHit(left)->t, 2, 1e-6);
        EXPECT_NEAR(tracer.closestHit(right)->t, 3, 1e-6);
        TraceRay short_ = right;
        short_.tMax = 2.5f;
        EXPECT_FALSE(tracer.anyHit(short_));
        short_.origin.x = -0.5f;
        EXPECT_TRUE(tracer.anyHit(short_));
        int hits = 0;
        tracer.allHits(right, [&](const TraceHit&) {
            ++hits;
            return false;
        });
        EXPECT_EQ(hits, 1);
    }
}

TEST(PrimaryHits, DepthAndNormalsFitTheCamera) {
    NEEDS_EMBREE();
    Geometry g;
    addQuad(g, {-5, -5, -4}, {10, 0, 0}, {0, 10, 0});
    const ReferenceTracer tracer(g, Scene{});
    for (const bool orthographic : {false, true}) {
        CameraState camera;
        camera.orthographic = orthographic;
        camera.nearPlane = 1;
        camera.farPlane = 10;
        const PrimaryHits hits = primaryHits(tracer, g, camera, 17, 9);
        for (int y = 0; y < 9; ++y) {
            for (int x = 0; x < 17; ++x) {
                EXPECT_NEAR(hits.viewDepth.at(x, y), 4, 1e-5);
                // Reversed z: n (f - z) / (z (f - n)), or linear for an orthographic camera.
                EXPECT_NEAR(hits.depth.at(x, y), orthographic ? 6.0 / 9.0 : 6.0 / 36.0, 1e-5);
                EXPECT_EQ(hits.faceNormal.at(x, y, 2), 1);
                EXPECT_NEAR(hits.position.at(x, y, 2), -4, 1e-5);
            }
        }
        // Rows run from the top, columns from the left.
        EXPECT_GT(hits.position.at(8, 0, 1), hits.position.at(8, 8, 1));
        EXPECT_LT(hits.position.at(0, 4, 0), hits.position.at(16, 4, 0));
        EXPECT_NEAR(hits.position.at(8, 4, 0), 0, 1e-5);
    }
}

TEST(ReferenceTracer, WithoutEmbreeSaysSo) {
    if (hasEmbree()) GTEST_SKIP() << "built with Embree";
    EXPECT_THROW(ReferenceTracer(Geometry{}, Scene{}), MachineError);
}

} // namespace
} // namespace kestrel
