// Rays through the primitives of an A-buffer: every hit is the hierarchy's, to the bit.
#include "abuffer_rays_fixture.h"
#include "reference/primary_hits.h"

namespace kestrel::test {
namespace {

struct ABufferPrimitives : ABufferRays {
    static Hits found(const Scene& scene, const std::string& rays, std::vector<std::string> settings = {}) {
        settings.insert(settings.begin(), "abuffer.record=primitive");
        return hits(scene, rays, settings);
    }
    // How many rays hit something; each of them hits what the hierarchy says.
    static size_t expectTheHierarchys(const Hits& hits, const std::string& what) {
        size_t met = 0, different = 0, missed = 0;
        EXPECT_EQ(hits.abuffer.size(), hits.bvh.size());
        for (size_t i = 0; i < hits.bvh.size(); ++i) {
            const shared::HitRecord &own = hits.abuffer[i], &exact = hits.bvh[i];
            met += exact.t < INFINITY ? 1 : 0;
            missed += exact.t < INFINITY && !(own.t < INFINITY) ? 1 : 0;
            different += own.t != exact.t || (exact.t < INFINITY && own.idX != exact.idX) ? 1 : 0;
        }
        EXPECT_EQ(missed, 0u) << what;
        EXPECT_EQ(different, 0u) << what << ": of " << hits.bvh.size() << ", " << met << " hits";
        EXPECT_EQ(hits.exhausted, 0) << what;
        return met;
    }
    // Rays between places within the scene's box, and from its eye.
    static std::vector<shared::RayRecord> raysWithin(const Scene& scene, int count) {
        const Geometry geometry = flatten(scene, 0);
        const glm::vec3 eye = cameraAt(scene, 0, 0).position;
        std::mt19937 random(11);
        std::uniform_real_distribution<float> unit(0, 1);
        const auto place = [&] {
            const glm::vec3 at(unit(random), unit(random), unit(random));
            return geometry.bounds.min + at * (geometry.bounds.max - geometry.bounds.min);
        };
        std::vector<shared::RayRecord> rays;
        for (int i = 0; i < count; ++i) {
            const glm::vec3 from = i % 3 == 0 ? eye : place();
            rays.push_back(rayRecord(from, place() - from));
            // Bounded too, so that a hit may lie beyond the end.
            if (i % 2 == 0) rays.back().tMax = 0.3f * glm::length(geometry.bounds.max - geometry.bounds.min);
        }
        return rays;
    }
};

TEST_F(ABufferPrimitives, HitWhatTheHierarchyHits) {
    for (const char* source :
         {"builtin:lattice?detail=0.3", "builtin:hall?detail=0.3", "builtin:grove?detail=0.05"}) {
        const Scene scene = loadScene(source);
        size_t met = expectTheHierarchys(found(scene, "hemisphere.rays"), source);
        EXPECT_GT(met, 300u) << source;
        RaySource::rays = raysWithin(scene, 6000);
        met = expectTheHierarchys(found(scene, "own.rays"), source);
        EXPECT_GT(met, 600u) << source;
    }
}

TEST_F(ABufferPrimitives, HitSomethingWhereTheHierarchyDoes) {
    const Scene scene = loadScene("builtin:lattice?detail=0.3");
    RaySource::rays = raysWithin(scene, 6000);
    const Hits any = found(scene, "own.rays", {"query.query=any", "bounds.main_view=false"});
    size_t met = 0, different = 0;
    for (size_t i = 0; i < any.bvh.size(); ++i) {
        met += any.bvh[i].t < INFINITY ? 1 : 0;
        different += (any.abuffer[i].t < INFINITY) != (any.bvh[i].t < INFINITY) ? 1 : 0;
    }
    EXPECT_GT(met, 600u);
    EXPECT_EQ(different, 0u) << "of " << any.bvh.size();
}

// From the eye, through any point of any pixel: Embree's hits, none missed.
TEST_F(ABufferPrimitives, NoRayOfTheEyeMissesWhatEmbreeHits) {
    if (shipped().find("ReferenceAmbientOcclusion") == nullptr) GTEST_SKIP() << "built without Embree";
    for (const char* source : {"builtin:lattice?detail=0.3", "builtin:hall?detail=0.3"}) {
        const Scene scene = loadScene(source);
        const Geometry geometry = flatten(scene, 0);
        const ReferenceTracer embree(geometry, scene);
        std::vector<shared::RayRecord> rays;
        for (const shared::RayRecord& ray : raysWithin(scene, 9000))
            if (ray.tMax == INFINITY) rays.push_back(ray);
        RaySource::rays = rays;
        const Hits own = found(scene, "own.rays");
        size_t missed = 0, apart = 0, met = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const auto hit = embree.closestHit({.origin = rays[i].origin, .direction = rays[i].direction});
            met += hit ? 1 : 0;
            missed += hit.has_value() != (own.abuffer[i].t < INFINITY) ? 1 : 0;
            if (hit && own.abuffer[i].t < INFINITY)
                apart += std::abs(hit->t - own.abuffer[i].t) > 1e-4f * std::max(1.0f, hit->t) ? 1 : 0;
        }
        EXPECT_GT(met, rays.size() / 4) << source;
        EXPECT_EQ(missed, 0u) << source;
        // Where two surfaces meet the ray at an edge each side takes its own.
        EXPECT_LE(apart, 2u) << source << " of " << met;
    }
}

TEST_F(ABufferPrimitives, SkippingAndBucketsChangeNoHit) {
    const Scene scene = loadScene("builtin:lattice?detail=0.3");
    RaySource::rays = raysWithin(scene, 3000);
    for (const int buckets : {1, 4, 16})
        for (const char* skipping : {"true", "false"}) {
            if (buckets == 16 && std::string(skipping) == "false") continue; // no bucket is chosen
            const auto set = {fmt::format("store.buckets={}", buckets),
                              fmt::format("abuffer.skipping={}", skipping)};
            expectTheHierarchys(found(scene, "own.rays", set),
                                fmt::format("{} buckets, {}", buckets, skipping));
        }
}

// Slivers, triangles as large as the scene and smaller than any pixel, in planes through the eye and behind
// it.
TEST_F(ABufferPrimitives, NoTriangleIsLostWhateverItsShape) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::vector<glm::vec3> corners;
    const auto place = [&] { return 4.0f * glm::vec3(unit(random), unit(random), unit(random)); };
    for (int i = 0; i < 300; ++i) {
        const glm::vec3 a = place(), b = place(), c = place();
        if (i % 4 == 0) corners.insert(corners.end(), {a, b, c});                         // large
        if (i % 4 == 1) corners.insert(corners.end(), {a, b, a + 1e-3f * c});             // slivers
        if (i % 4 == 2) corners.insert(corners.end(), {a, a + 2e-3f * b, a + 2e-3f * c}); // small
        if (i % 4 == 3)
            corners.insert(corners.end(),
                           {a * glm::vec3(1, 0, 1), b * glm::vec3(1, 0, 1), c * glm::vec3(1, 0, 1)});
    }
    const Scene scene = seenFrom({0.1f, 0, 0.2f}, corners); // in the plane of a quarter of them
    std::vector<shared::RayRecord> rays;
    for (size_t i = 0; i < corners.size(); i += 3)
        for (int k = 0; k < 20; ++k) {
            // To a point of the triangle.
            const float u = 0.5f * (unit(random) + 1), v = (1 - u) * 0.5f * (unit(random) + 1);
            const glm::vec3 to =
                corners[i] + u * (corners[i + 1] - corners[i]) + v * (corners[i + 2] - corners[i]);
            const glm::vec3 from = k % 3 == 0 ? cameraAt(scene, 0, 0).position : place();
            rays.push_back(rayRecord(from, to - from));
        }
    RaySource::rays = rays;
    for (const char* skipping : {"abuffer.skipping=true", "abuffer.skipping=false"}) {
        const Hits hits = found(scene, "own.rays", {skipping});
        size_t met = 0, farther = 0, nearer = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const float own = hits.abuffer[i].t, exact = hits.bvh[i].t;
            met += exact < INFINITY ? 1 : 0;
            farther += own > exact ? 1 : 0;
            // Where triangles overlap in a plane the hierarchy may leave out one whose box begins at the hit.
            nearer += own < exact && !(own >= exact * (1 - 1e-6f)) ? 1 : 0;
        }
        EXPECT_GT(met, rays.size() / 3);
        EXPECT_EQ(farther, 0u) << skipping;
        EXPECT_EQ(nearer, 0u) << skipping;
    }
}

TEST_F(ABufferPrimitives, ThePictureIsTheHierarchysWhereMaterialsAreMasked) {
    const Scene scene = loadScene("builtin:grove?detail=0.05");
    ASSERT_TRUE(gatherFacts(scene).hasMasked);
    const auto occlusion = [&](const std::vector<std::string>& settings) {
        Graph graph = shippedGraph("abuffer_ao", settings);
        Renderer made = renderer(graph, scene, {}, size);
        made.frame();
        return made.read({"mean", "result"}).values;
    };
    EXPECT_EQ(occlusion({"abuffer.record=primitive"}), occlusion({"ao.tracer=bvh.tracer"}));
}

} // namespace
} // namespace kestrel::test
