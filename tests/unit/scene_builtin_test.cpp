// The built-in scenes: what each promises, that they are the same every time, and that their meshes are
// sound.
#include "core/error.h"
#include "scene/builtin.h"
#include "scene/builtin/noise.h"
#include "scene/bvh_trace.h"
#include "scene/facts.h"
#include "scene/geometry.h"
#include <algorithm>
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
    for (const BuiltinInfo& info : builtinInfos()) EXPECT_GT(info.sentence.size(), 20u);
    EXPECT_EQ(built("blob", "?detail=0.5").source, "builtin:blob?detail=0.5");
    EXPECT_EQ(built("blob", "?detail=0.5").name, "builtin:blob");
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
