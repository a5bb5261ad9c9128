// The built-in scenes: what each promises, that they are the same every time, and that their meshes are
// sound.
#include "core/error.h"
#include "passes/occupancy_oracle.h"
#include "scene/builtin.h"
#include "scene/builtin/noise.h"
#include "scene/builtin/shapes.h"
#include "scene/builtin/split.h"
#include "scene/bvh_trace.h"
#include "scene/facts.h"
#include "scene/geometry.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <set>

namespace kestrel {
namespace {

using testing::HasSubstr;

Scene built(const std::string& name, const std::string& query = {}) {
    Scene scene = builtinScene("builtin:" + name + query);
    finishScene(scene);
    return scene;
}

// FNV-1a over the bits of what is drawn and seen.
class Hash {
public:
    void add(float x) { add(std::bit_cast<std::uint32_t>(x)); }
    void add(std::uint32_t x) { value_ = (value_ ^ x) * 0x100000001b3ull; }
    void add(const glm::vec3& v) {
        for (int i = 0; i < 3; ++i) add(v[i]);
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325ull;
};

std::uint64_t hashOf(const Scene& scene) {
    Hash hash;
    for (const double time : {0.0, 0.4 * scene.duration()}) {
        const Geometry g = flatten(scene, time);
        for (const glm::vec3& p : g.positions) hash.add(p);
        for (const VertexAttributes& a : g.attributes) {
            hash.add(a.normal);
            hash.add(a.texCoord.x);
            hash.add(a.texCoord.y);
        }
        for (const std::uint32_t i : g.indices) hash.add(i);
        for (const std::uint32_t m : g.materials) hash.add(m);
        for (size_t c = 0; c < scene.cameras.size(); ++c)
            hash.add(cameraAt(scene, static_cast<int>(c), time).position);
    }
    for (const TextureImage& image : scene.images)
        for (const std::uint8_t byte : image.rgba) hash.add(std::uint32_t{byte});
    return hash.value();
}

class EveryBuiltin : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EveryBuiltin, testing::ValuesIn(builtinNames()),
                         [](const auto& scene) { return scene.param; });

TEST_P(EveryBuiltin, IsTheSameEveryTime) {
    EXPECT_EQ(hashOf(built(GetParam(), "?detail=0.1")), hashOf(built(GetParam(), "?detail=0.1")));
}

TEST_P(EveryBuiltin, HasSoundMeshes) {
    const Scene scene = built(GetParam());
    for (const Mesh& mesh : scene.meshes) {
        for (const Primitive& p : mesh.primitives) {
            ASSERT_FALSE(p.indices.empty()) << mesh.name;
            ASSERT_EQ(p.indices.size() % 3, 0u);
            ASSERT_EQ(p.normals.size(), p.positions.size());
            ASSERT_EQ(p.texCoords.size(), p.positions.size());
            ASSERT_GE(p.material, 0);
            ASSERT_LT(p.material, static_cast<int>(scene.materials.size()));
            for (size_t i = 0; i < p.positions.size(); ++i) {
                ASSERT_TRUE(std::isfinite(glm::dot(p.positions[i], p.positions[i]))) << mesh.name;
                ASSERT_TRUE(std::isfinite(p.texCoords[i].x + p.texCoords[i].y)) << mesh.name;
                ASSERT_NEAR(glm::length(p.normals[i]), 1, 1e-4) << mesh.name;
            }
            size_t against = 0;
            for (size_t i = 0; i < p.indices.size(); i += 3) {
                const auto at = [&](size_t k) { return p.indices[i + k]; };
                ASSERT_LT(std::max({at(0), at(1), at(2)}), p.positions.size());
                const glm::vec3 face = glm::cross(p.positions[at(1)] - p.positions[at(0)],
                                                  p.positions[at(2)] - p.positions[at(0)]);
                const glm::vec3 sum = p.normals[at(0)] + p.normals[at(1)] + p.normals[at(2)];
                if (glm::dot(face, sum) < 0) ++against;
            }
            // Smooth normals may disagree with a face where a surface folds over, but hardly anywhere.
            EXPECT_LE(against, p.indices.size() / 3 / 100) << mesh.name;
        }
    }
}

TEST_P(EveryBuiltin, HasNamedCamerasThatSeeIt) {
    const Scene scene = built(GetParam(), "?detail=0.2");
    const Bvh bvh = buildBvh(flatten(scene, 0));
    std::set<std::string> names;
    ASSERT_GE(scene.cameras.size(), 2u);
    for (size_t c = 0; c < scene.cameras.size(); ++c) {
        EXPECT_TRUE(names.insert(scene.cameras[c].name).second) << scene.cameras[c].name;
        const CameraState camera = cameraAt(scene, static_cast<int>(c), 0);
        const glm::mat3 toWorld = glm::transpose(glm::mat3(camera.view));
        const float slope = std::tan(0.5f * camera.verticalFov);
        int seen = 0;
        for (int i = 0; i < 256; ++i) {
            const glm::vec2 p = (glm::vec2(i % 16, static_cast<float>(i / 16)) + 0.5f) / 8.0f - 1.0f;
            const glm::vec3 d = toWorld * glm::vec3(p.x * slope * 16 / 9, p.y * slope, -1);
            if (anyHit(bvh, {camera.position, d, camera.nearPlane, camera.farPlane})) ++seen;
        }
        EXPECT_GT(seen, 256 / 8) << scene.cameras[c].name;
    }
}

TEST_P(EveryBuiltin, EndsItsTimelineAsItBegins) {
    const Scene scene = built(GetParam(), "?detail=0.1");
    const Geometry first = flatten(scene, 0), last = flatten(scene, scene.duration());
    const float tolerance = 1e-5f * glm::length(first.bounds.size());
    ASSERT_EQ(first.positions.size(), last.positions.size());
    for (size_t i = 0; i < first.positions.size(); ++i)
        ASSERT_LE(glm::length(first.positions[i] - last.positions[i]), tolerance);
    for (size_t c = 0; c < scene.cameras.size(); ++c) {
        const CameraState a = cameraAt(scene, static_cast<int>(c), 0);
        const CameraState b = cameraAt(scene, static_cast<int>(c), scene.duration());
        EXPECT_LE(glm::length(a.position - b.position), tolerance);
        EXPECT_GT(glm::dot(a.view[2], b.view[2]), 0.9999f);
    }
}

TEST_P(EveryBuiltin, DetailScalesTheTrianglesAndKeepsTheExtent) {
    const SceneFacts full = gatherFacts(built(GetParam()));
    const SceneFacts small = gatherFacts(built(GetParam(), "?detail=0.05"));
    EXPECT_LE(small.triangles, full.triangles);
    EXPECT_LE(small.triangles, 20000u);
    if (full.triangles > 5000) {
        const SceneFacts large = gatherFacts(built(GetParam(), "?detail=2"));
        EXPECT_LT(small.triangles, full.triangles / 4);
        EXPECT_GT(large.triangles, full.triangles * 3 / 2);
    }
    const float size = glm::length(full.bounds.size());
    EXPECT_NEAR(glm::length(small.bounds.size()), size, 0.12f * size);
    EXPECT_EQ(small.hasMasked, full.hasMasked);
    EXPECT_EQ(small.lights(), full.lights());
    EXPECT_EQ(small.geometryDeforms, full.geometryDeforms);
}

TEST(Builtin, TriangleCountsAreAsPromised) {
    const std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> bounds{
        {"cornell", {30, 100}},     {"blob", {65000, 75000}},    {"tower", {72000, 82000}},
        {"hall", {200000, 260000}}, {"grove", {100000, 150000}}, {"morph", {5000, 40000}},
        {"skinned", {5000, 40000}}, {"pool", {20000, 100000}},   {"lattice", {10000, 40000}},
    };
    EXPECT_EQ(bounds.size(), builtinNames().size());
    for (const std::string& name : builtinNames()) {
        const std::uint64_t count = flatten(built(name), 0).triangleCount();
        ASSERT_TRUE(bounds.contains(name)) << name;
        EXPECT_GE(count, bounds.at(name).first) << name;
        EXPECT_LE(count, bounds.at(name).second) << name;
    }
}

TEST(Builtin, ScenesHaveTheFactsThatTheyStandFor) {
    const auto facts = [](const char* name) { return gatherFacts(built(name, "?detail=0.1")); };
    const SceneFacts blob = facts("blob");
    EXPECT_EQ(blob.lights(), 0u);
    EXPECT_FALSE(blob.hasMasked || blob.hasTextures || blob.geometryMoves || blob.cameraMoves);
    EXPECT_EQ(facts("cornell").rectangleLights, 1u);
    EXPECT_TRUE(facts("cornell").hasEmission);
    EXPECT_EQ(facts("hall").spotLights, 1u);
    EXPECT_TRUE(facts("hall").cameraMoves);
    EXPECT_FALSE(facts("hall").geometryMoves);
    EXPECT_TRUE(facts("grove").hasMasked);
    EXPECT_GT(facts("grove").maskedTriangles, facts("grove").triangles / 4);
    EXPECT_TRUE(facts("morph").geometryDeforms);
    EXPECT_EQ(facts("morph").rectangleLights, 1u);
    EXPECT_TRUE(facts("skinned").geometryDeforms);
    const SceneFacts pool = facts("pool");
    EXPECT_TRUE(pool.hasTransmission && pool.hasTextures);
    EXPECT_EQ(pool.rectangleLights + pool.pointLights, 2u);
    EXPECT_EQ(cameraIndex(built("tower", "?detail=0.1"), "stairs"), 0);
    EXPECT_GT(cameraIndex(built("hall", "?detail=0.1"), "path"), 0);
}

TEST(Builtin, LatticeIsAboutAHundredSurfacesDeep) {
    const Scene scene = built("lattice");
    const Bvh bvh = buildBvh(flatten(scene, 0));
    const CameraState camera = cameraAt(scene, 0, 0);
    const glm::mat3 toWorld = glm::transpose(glm::mat3(camera.view));
    const float slope = std::tan(0.5f * camera.verticalFov);
    int deepest = 0;
    for (int y = 0; y < 72; ++y) {
        for (int x = 0; x < 128; ++x) {
            const glm::vec2 p = (glm::vec2(x, y) + 0.5f) / glm::vec2(64, 36) - 1.0f;
            int count = 0;
            allHits(bvh, {camera.position, toWorld * glm::vec3(p.x * slope * 16 / 9, p.y * slope, -1)},
                    [&](const TraceHit&) {
                        ++count;
                        return false;
                    });
            deepest = std::max(deepest, count);
        }
    }
    EXPECT_GE(deepest, 80);
    EXPECT_LE(deepest, 120);
}

TEST(Builtin, GroveLeavesHaveHoles) {
    const Scene scene = built("grove", "?detail=0.1");
    for (const TextureImage& image : scene.images) {
        size_t solid = 0;
        for (size_t i = 3; i < image.rgba.size(); i += 4) solid += image.rgba[i] >= 128 ? 1 : 0;
        const double share = static_cast<double>(solid) / (static_cast<double>(image.rgba.size()) / 4);
        EXPECT_GT(share, 0.15) << image.name;
        EXPECT_LT(share, 0.7) << image.name;
    }
}

TEST(Builtin, NamesAreRecognised) {
    EXPECT_TRUE(isBuiltin("builtin:blob"));
    EXPECT_TRUE(isBuiltin("builtin:"));
    EXPECT_FALSE(isBuiltin("blob"));
    EXPECT_FALSE(isBuiltin("scene.glb"));
    EXPECT_EQ(builtinInfos().size(), builtinNames().size());
    for (const BuiltinInfo& info : builtinInfos()) EXPECT_GT(info.description.size(), 20u);
    EXPECT_EQ(built("blob", "?detail=0.5").source, "builtin:blob?detail=0.5");
    EXPECT_EQ(built("blob", "?detail=0.5").name, "builtin:blob");
}

// Area of all triangles, in double.
double areaOf(const Geometry& g) {
    double area = 0;
    for (size_t i = 0; i < g.indices.size(); i += 3) {
        const glm::dvec3 a(g.positions[g.indices[i]]), b(g.positions[g.indices[i + 1]]),
            c(g.positions[g.indices[i + 2]]);
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return area;
}

// The triangles of `whole`'s meshes in `parts` are split into n * n each, in the order of the old ones.
void expectParts(const Primitive& whole, const Primitive& parts, size_t n) {
    ASSERT_EQ(parts.indices.size(), whole.indices.size() * n * n);
    ASSERT_EQ(parts.normals.size(), parts.positions.size());
    ASSERT_EQ(parts.texCoords.size(), parts.positions.size());
    for (size_t i = 0; i < whole.positions.size(); ++i) {
        ASSERT_EQ(parts.positions[i], whole.positions[i]);
        ASSERT_EQ(parts.normals[i], whole.normals[i]);
    }
    for (size_t i = 0; i < parts.indices.size(); i += 3) {
        const auto corner = [&](const Primitive& p, size_t of, size_t k) {
            return glm::dvec3(p.positions[p.indices[of + k]]);
        };
        const size_t old = i / 3 / (n * n) * 3;
        const glm::dvec3 a = corner(whole, old, 0), b = corner(whole, old, 1), c = corner(whole, old, 2);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        const double twiceArea = glm::length(normal);
        const double ulp =
            std::ldexp(std::max({glm::length(a), glm::length(b), glm::length(c)}), -23); // of any coordinate
        if (twiceArea < 1e4 * ulp * glm::length(b - a)) continue; // it has no plane to speak of
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec3 p = corner(parts, i, k);
            ASSERT_LE(std::abs(glm::dot(p - a, normal)) / twiceArea, 2 * ulp);
            // Barycentric weights: inside, and multiples of 1 / n.
            const double wb = glm::dot(glm::cross(p - a, c - a), normal) / (twiceArea * twiceArea);
            const double wc = glm::dot(glm::cross(b - a, p - a), normal) / (twiceArea * twiceArea);
            const double slack = 4 * ulp * (glm::length(b - a) + glm::length(c - a)) / twiceArea;
            ASSERT_GE(std::min(wb, wc), -slack);
            ASSERT_LE(wb + wc, 1 + slack);
            ASSERT_NEAR(wb * static_cast<double>(n), std::round(wb * static_cast<double>(n)),
                        slack * static_cast<double>(n));
        }
        const glm::dvec3 p = corner(parts, i, 0);
        const glm::dvec3 part = glm::cross(corner(parts, i, 1) - p, corner(parts, i, 2) - p);
        // The same winding and an equal share of the area.
        ASSERT_NEAR(glm::dot(part, normal) / (twiceArea * twiceArea) * static_cast<double>(n * n), 1,
                    static_cast<double>(n) * 8 * ulp * (glm::length(b - a) + glm::length(c - a)) / twiceArea);
    }
}

TEST_P(EveryBuiltin, IsTheSameSurfaceInMoreTriangles) {
    const std::string few = "?detail=0.02";
    if (GetParam() == "skinned") {
        EXPECT_THROW((void)built("skinned", few + "&split=2"), InputError);
        EXPECT_EQ(hashOf(built("skinned", few + "&split=1")), hashOf(built("skinned", few)));
        return;
    }
    const Scene whole = built(GetParam(), few);
    for (const size_t n : {size_t{2}, size_t{5}}) {
        const Scene parts = built(GetParam(), few + "&split=" + std::to_string(n));
        EXPECT_EQ(parts.origin, whole.origin);
        for (const double time : {0.0, 0.4 * whole.duration()}) {
            const Geometry a = flatten(whole, time), b = flatten(parts, time);
            EXPECT_EQ(b.triangleCount(), a.triangleCount() * n * n);
            EXPECT_EQ(a.bounds.min, b.bounds.min);
            EXPECT_EQ(a.bounds.max, b.bounds.max);
            EXPECT_NEAR(areaOf(b), areaOf(a), 1e-5 * areaOf(a));
            for (const VertexAttributes& v : b.attributes) ASSERT_NEAR(glm::length(v.normal), 1, 1e-4);
        }
        ASSERT_EQ(parts.meshes.size(), whole.meshes.size());
        for (size_t m = 0; m < whole.meshes.size(); ++m)
            for (size_t p = 0; p < whole.meshes[m].primitives.size(); ++p)
                ASSERT_NO_FATAL_FAILURE(
                    expectParts(whole.meshes[m].primitives[p], parts.meshes[m].primitives[p], n))
                    << whole.meshes[m].name;
    }
}

// How many edges, by the positions of their ends, have how many triangles.
std::map<int, size_t> edgesByTriangles(const Primitive& mesh) {
    using Point = std::array<float, 3>;
    std::map<std::pair<Point, Point>, int> edges;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        for (size_t k = 0; k < 3; ++k) {
            const glm::vec3& a = mesh.positions[mesh.indices[i + k]];
            const glm::vec3& b = mesh.positions[mesh.indices[i + (k + 1) % 3]];
            ++edges[std::minmax(Point{a.x, a.y, a.z}, Point{b.x, b.y, b.z})];
        }
    }
    std::map<int, size_t> counts;
    for (const auto& [edge, triangles] : edges) ++counts[triangles];
    return counts;
}

TEST(BuiltinSplit, LeavesNoCracks) {
    // A box is closed, though each side has vertices of its own.
    Scene scene;
    scene.meshes.resize(1);
    scene.meshes[0].primitives.resize(1);
    Primitive& box = scene.meshes[0].primitives[0];
    builtin::addBox(box, glm::mat4(1), {0.3f, 0.7f, 1.1f}, 1);
    const glm::quat turn = glm::normalize(glm::quat(0.7f, 0.3f, -0.5f, 0.2f));
    for (glm::vec3& position : box.positions) position = turn * position;
    EXPECT_EQ(edgesByTriangles(box), (std::map<int, size_t>{{2, 18}}));
    builtin::splitTriangles(scene, 7);
    EXPECT_EQ(edgesByTriangles(box), (std::map<int, size_t>{{2, 18 * 49}}));
    // What is open stays as open: n parts of each edge, and 3 n (n - 1) / 2 edges inside each triangle.
    const auto edges = [](const char* query) {
        return edgesByTriangles(built("blob", query).meshes[1].primitives[0]);
    };
    const auto whole = edges("?detail=0.02"), parts = edges("?detail=0.02&split=3");
    const size_t triangles = (whole.at(1) + 2 * whole.at(2)) / 3;
    EXPECT_EQ(parts, (std::map<int, size_t>{{1, 3 * whole.at(1)}, {2, 3 * whole.at(2) + 9 * triangles}}));
}

TEST(BuiltinSplit, MarksTheSameCells) {
    // Up to cells that the surface just touches: new vertices are rounded.
    for (const std::string name : {"blob?detail=0.02", "cornell?detail=1", "tower?detail=0.01"}) {
        const Scene scene = built(name);
        const Sphere sphere = gatherFacts(scene).sphere;
        shared::OccupancyGrid grid{};
        grid.resolution = 64;
        grid.halfResolution = 32;
        grid.centre = sphere.centre;
        grid.cellSize = 2 * sphere.radius / 62;
        grid.inverseCellSize = 1 / grid.cellSize;
        const auto whole = test::oracleMap(flatten(scene, 0), grid);
        const auto parts = test::oracleMap(flatten(built(name, "&split=4"), 0), grid);
        ASSERT_EQ(whole.size(), parts.size());
        int marked = 0, differ = 0;
        for (size_t i = 0; i < whole.size(); ++i) {
            marked += std::popcount(whole[i]);
            differ += std::popcount(whole[i] ^ parts[i]);
        }
        EXPECT_GT(marked, 2000) << name;
        EXPECT_LE(differ, marked / 1000) << name;
    }
}

TEST(BuiltinSplit, SharesTheVerticesOfEdges) {
    // n * n parts of T triangles have about n * n * T / 2 vertices, not 3 * n * n * T.
    const SceneFacts facts = gatherFacts(built("blob", "?detail=0.0127&split=22"));
    EXPECT_NEAR(static_cast<double>(facts.triangles), 500'000, 50'000);
    EXPECT_LT(facts.vertices, facts.triangles * 11 / 20);
}

TEST(Builtin, ExtentMakesTheSceneTheMiddleOfALargerOne) {
    for (const char* name : {"blob", "hall", "skinned"}) {
        SCOPED_TRACE(name);
        const Scene plain = built(name, "?detail=0.1"), large = built(name, "?detail=0.1&extent=16");
        const SceneFacts before = gatherFacts(plain), after = gatherFacts(large);
        EXPECT_EQ(after.triangles, before.triangles + 16);
        EXPECT_GT(after.sphere.radius, 15 * before.sphere.radius);
        EXPECT_LT(after.sphere.radius, 24 * before.sphere.radius); // the box's sphere: its diagonal
        const glm::vec3 moved(large.origin + glm::dvec3(after.sphere.centre) - plain.origin -
                              glm::dvec3(before.sphere.centre));
        EXPECT_LT(glm::length(moved), 0.25f * before.sphere.radius);
        EXPECT_EQ(gatherFacts(built(name, "?detail=0.1&extent=1")).triangles, before.triangles);
    }
}

TEST(Builtin, BlendedMakesEveryMaterialGlassOfThatAlpha) {
    const Scene plain = built("lattice", "?detail=0.1"), glass = built("lattice", "?blended=0.25&detail=0.1");
    const SceneFacts before = gatherFacts(plain), after = gatherFacts(glass);
    EXPECT_FALSE(before.hasBlend);
    EXPECT_TRUE(after.hasBlend);
    EXPECT_EQ(after.maskedTriangles, after.triangles);
    EXPECT_EQ(after.triangles, before.triangles);
    for (size_t i = 0; i < plain.materials.size(); ++i) {
        EXPECT_EQ(glass.materials[i].baseColour, glm::vec4(glm::vec3(plain.materials[i].baseColour), 0.25f));
        EXPECT_TRUE(glass.materials[i].doubleSided);
    }
    EXPECT_THROW(built("lattice", "?blended=0"), InputError);
}

std::string messageOf(const std::string& source) {
    try {
        (void)builtinScene(source);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(Builtin, MistakesAreNamed) {
    EXPECT_EQ(messageOf("builtin:towr"), "there is no built-in scene 'towr' (did you mean 'tower'?)");
    EXPECT_EQ(messageOf("builtin:zzzzzz"), "there is no built-in scene 'zzzzzz'");
    EXPECT_THAT(messageOf("builtin:blob?detial=1"), HasSubstr("did you mean 'detail'?"));
    for (const char* value :
         {"detail=", "detail", "detail=0", "detail=5", "detail=-1", "detail=nan", "detail=1x"})
        EXPECT_THAT(messageOf(std::string("builtin:blob?") + value), HasSubstr("from 0.01 to 4")) << value;
    for (const char* value : {"split=", "split", "split=0", "split=65", "split=1.5", "detail=1&split=x"})
        EXPECT_THAT(messageOf(std::string("builtin:blob?") + value), HasSubstr("whole number from 1 to 64"))
            << value;
    for (const char* value : {"extent=", "extent=0.5", "extent=1001", "extent=inf"})
        EXPECT_THAT(messageOf(std::string("builtin:blob?") + value), HasSubstr("from 1 to 1000")) << value;
    EXPECT_THAT(messageOf("builtin:blob?detail=1&split=2&detail=2"), HasSubstr("'detail' is there twice"));
    EXPECT_THAT(messageOf("builtin:blob?split=2&"), HasSubstr("unknown property ''"));
    EXPECT_THAT(messageOf("builtin:hall?detail=4&split=64"), HasSubstr("at most"));
    EXPECT_THAT(messageOf("builtin:skinned?split=2"), HasSubstr("is skinned"));
}

TEST(BuiltinNoise, StaysInRangeAndVaries) {
    float low = 9, high = -9;
    for (int i = 0; i < 4000; ++i) {
        const glm::vec3 p = 0.37f * glm::vec3(i, i % 63, i % 17) - 40.0f;
        const float n = builtin::gradientNoise(p);
        low = std::min(low, n);
        high = std::max(high, n);
        const builtin::Cellular c = builtin::cellularNoise(p);
        EXPECT_LE(c.nearest, c.second);
        EXPECT_LT(c.nearest, 1.8f);
    }
    EXPECT_GT(high, 0.5f);
    EXPECT_LT(low, -0.5f);
    EXPECT_LE(high, 1.05f);
    EXPECT_GE(low, -1.05f);
    EXPECT_EQ(builtin::gradientNoise({3, -4, 5}), 0);
}

} // namespace
} // namespace kestrel
