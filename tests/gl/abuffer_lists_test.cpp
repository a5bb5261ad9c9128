// The lists of the A-buffer against all that Embree meets along the ray of each pixel of each view.
#include "abuffer_fixture.h"
#include "reference/primary_hits.h"
#include "support/assets.h"
#include "support/message.h"
#include <gmock/gmock.h>

namespace kestrel::test {
namespace {

struct ABufferTruth : ABufferLists {
    // Everything on the ray of a pixel, by depth along the view's axis.
    static Lists traced(const Scene& scene) {
        const Geometry geometry = flatten(scene, 0);
        const ReferenceTracer tracer(geometry, scene);
        const CameraState camera = cameraAt(scene, 0, 0);
        Lists result(pixels);
        const auto trace = [&](const TraceRay& ray, std::vector<Fragment>& list) {
            tracer.allHits(ray, [&](const TraceHit& hit) {
                list.push_back({hit.t, hit.triangle});
                return false;
            });
            std::sort(list.begin(), list.end(), [](const Fragment& a, const Fragment& b) {
                return a.depth < b.depth || (a.depth == b.depth && a.triangle < b.triangle);
            });
        };
        for (int y = 0; y < 27; ++y) { // from the top; the lists' rows go up
            const std::vector<TraceRay> rays = cameraRays(camera, 48, 27, y);
            for (int x = 0; x < 48; ++x)
                trace(rays[static_cast<size_t>(x)], result[static_cast<size_t>((26 - y) * 48 + x)]);
        }
        const glm::vec3 eye(camera.position);
        for (std::uint32_t face = 0; face < shared::abufferFaces; ++face) {
            // abufferFaceAxes() turns: its inverse is its transpose.
            glm::mat3 turn;
            for (int i = 0; i < 3; ++i) {
                glm::vec3 axis(0);
                axis[i] = 1;
                turn[i] = shared::abufferFaceAxes(face, axis);
            }
            turn = glm::transpose(turn);
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x) {
                    const glm::vec2 at = (glm::vec2(x, y) + 0.5f) * (2.0f / side) - 1.0f;
                    TraceRay ray;
                    ray.direction = turn * glm::vec3(at, 1);
                    ray.origin = eye - nearPlane * turn[2];
                    ray.tMin = nearPlane;
                    trace(ray, result[mainPixels +
                                      static_cast<size_t>((static_cast<int>(face) * side + y) * side + x)]);
                }
        }
        return result;
    }

    // The lists are the hits of rays through all pixels, but for a share of the fragments: where a ray passes
    // an edge or grazes a triangle the rasterizer's sub-pixel grid decides, not the ray.
    static void expectTruth(const Scene& scene, const std::string& source, size_t least, double share) {
        const Lists expected = traced(scene), lists = made(scene, {});
        size_t fragments = 0, lost = 0, longest = 0;
        for (size_t i = 0; i < pixels; ++i) {
            fragments += expected[i].size();
            longest = std::max(longest, lists[i].size());
            lost += unmatched(lists[i], expected[i], 2e-4f);
        }
        EXPECT_GT(fragments, least) << source;
        EXPECT_LE(static_cast<double>(lost), share * static_cast<double>(fragments))
            << source << ": " << lost << " of " << fragments << ", longest list " << longest;
        RecordProperty("lost_of_" + source, fmt::format("{} of {}", lost, fragments));
    }
};

TEST_F(ABufferTruth, IsWhatRaysThroughPixelsMeet) {
    if (shipped().find("ReferenceAmbientOcclusion") == nullptr) GTEST_SKIP() << "built without Embree";
    for (const char* source :
         {"builtin:lattice?detail=0.3", "builtin:hall?detail=0.3", "builtin:grove?detail=0.05"})
        expectTruth(loadScene(source), source, pixels / 2, 0.01);
}

TEST_F(ABufferTruth, IsWhatRaysThroughPixelsMeetInRealScenes) {
    if (shipped().find("ReferenceAmbientOcclusion") == nullptr) GTEST_SKIP() << "built without Embree";
    if (assetsFolder().empty()) GTEST_SKIP() << "no assets here";
    size_t scenes = 0;
    for (const char* name : {"cornell-babylon", "fzk-haus-blend", "zdm2-architecture", "house-foliage-mask"})
        for (const std::filesystem::path& file : gltfFilesBelow(assetsFolder() / name)) {
            expectTruth(loadScene(file.string()), name, 500, 0.015);
            ++scenes;
        }
    EXPECT_GT(scenes, 0u);
}

TEST_F(ABufferLists, EveryStructureHoldsTheSameInOrder) {
    const Scene scene = loadScene("builtin:lattice?detail=0.1");
    const Lists expected = made(scene, {});
    for (const std::vector<Fragment>& list : expected)
        for (size_t i = 1; i < list.size(); ++i)
            ASSERT_TRUE(list[i - 1].depth < list[i].depth ||
                        (list[i - 1].depth == list[i].depth && list[i - 1].triangle < list[i].triangle));
    for (const char* structure : {"sb", "ll", "dll", "llb", "dllb"})
        for (const char* decoupled : {"true", "false"})
            for (const char* allocation : {"counter", "counted"})
                for (const int buckets : {1, 4, 16}) {
                    const bool bucketed = std::string(structure).ends_with("lb");
                    // Numbers of buckets with one of the other choices: what they change lies apart.
                    if ((!bucketed && buckets > 1) ||
                        (bucketed && buckets != 4 &&
                         (std::string(decoupled) == "false" || std::string(allocation) == "counter")) ||
                        (std::string(structure) == "sb" && std::string(allocation) == "counter"))
                        continue;
                    EXPECT_EQ(made(scene, {fmt::format("store.structure={}", structure),
                                           fmt::format("store.decoupled={}", decoupled),
                                           fmt::format("store.allocation={}", allocation),
                                           fmt::format("store.buckets={}", buckets)}),
                              expected)
                        << structure << " decoupled " << decoupled << " by " << allocation << ", " << buckets;
                }
}

// Copies of a square one behind another, in an order that is none: the list of a pixel is as long as there
// are copies.
Scene stack(int count, bool backwards) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i) {
        const int at = static_cast<int>((static_cast<std::int64_t>(i) * 7919) % count);
        const float z =
            -2.0f * static_cast<float>(backwards ? count - 1 - at : at) / static_cast<float>(count);
        for (const glm::vec3& p : square()) corners.push_back(2.0f * p + glm::vec3(0, 0, z));
    }
    return trianglesScene(corners);
}

TEST_F(ABufferLists, LongListsAreSortedToo) {
    for (const int count : {24, 25, 363, 1000, 1001, 3000})
        for (const char* structure : {"sb", "dll", "dllb"})
            for (const char* allocation : {"counter", "counted"}) {
                const bool sb = std::string(structure) == "sb";
                if (sb && (count > 1000 || std::string(allocation) == "counter")) continue;
                const Lists lists =
                    made(stack(count, false), {fmt::format("store.structure={}", structure),
                                               fmt::format("store.allocation={}", allocation)});
                size_t longest = 0;
                for (const std::vector<Fragment>& list : lists) {
                    longest = std::max(longest, list.size());
                    for (size_t i = 1; i < list.size(); ++i)
                        ASSERT_LT(list[i - 1].depth, list[i].depth)
                            << structure << " " << allocation << " " << count;
                }
                EXPECT_EQ(longest, static_cast<size_t>(count)) << structure << " " << allocation;
            }
}

TEST_F(ABufferLists, AListThatIsTooLongIsRefusedWithTheLimit) {
    EXPECT_THAT(messageOf<Error>([] { made(stack(1100, false), {"store.structure=sb"}); }),
                ::testing::HasSubstr("a list of more than 1000 fragments"));
}

TEST_F(ABufferLists, NoOrderOfTrianglesMatters) {
    const Lists lists = made(stack(40, false), {}), other = made(stack(40, true), {});
    for (size_t i = 0; i < pixels; ++i) {
        ASSERT_EQ(lists[i].size(), other[i].size()) << i;
        for (size_t k = 0; k < lists[i].size(); ++k) ASSERT_EQ(lists[i][k].depth, other[i][k].depth);
    }
}

TEST_F(ABufferLists, AnEmptySceneHasNone) {
    Graph graph = shippedGraph("abuffer_ao");
    Renderer renderer = ABufferLists::renderer(graph, trianglesScene({}), {}, size);
    renderer.frame();
    for (const float value : renderer.read({"mean", "result"}).values) EXPECT_EQ(value, 1);
}

} // namespace
} // namespace kestrel::test
