// Rays through an A-buffer: closed forms in a room about the eye, the same hits with and without skipping for
// every structure, and the hierarchy beside it.
#include "abuffer_rays_fixture.h"

namespace kestrel::test {
namespace {

TEST_F(ABufferRays, EndAtTheWallsOfARoomWhereverTheyStartAndGo) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::vector<shared::RayRecord> rays;
    const glm::vec3 eye = cameraAt(room(), 0, 0).position;
    EXPECT_GT(glm::length(eye), 0.1f);
    // Along axes, diagonals of faces and of space, from the eye and elsewhere.
    for (const glm::vec3& origin :
         {eye, glm::vec3(0), glm::vec3(-0.6f, 0.5f, 0.1f), eye + glm::vec3(0.2f, 0.2f, 0.2f)})
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z)
                    if (x != 0 || y != 0 || z != 0) rays.push_back(rayRecord(origin, glm::vec3(x, y, z)));
    for (int i = 0; i < 4000; ++i) {
        const glm::vec3 origin = 0.9f * glm::vec3(unit(random), unit(random), unit(random));
        rays.push_back(rayRecord(origin, glm::vec3(unit(random), unit(random), unit(random))));
    }
    for (const auto& [view, planes] : {std::pair("bounds.main_view=true", false),
                                       {"bounds.main_view=false", false},
                                       {"bounds.main_view=true", true},
                                       {"bounds.main_view=false", true}}) {
        RaySource::rays = rays;
        // Where a face sees a wall askew its depth falls by up to 1.73 footprints from pixel to pixel (the
        // ratio of the distances of two neighbouring walls): no ray passes between fragments that are
        // thicker. Planes need no thickness for that.
        const Hits found = hits(room(), "own.rays",
                                {view, planes ? "abuffer.thickness=0.5" : "abuffer.thickness=2",
                                 fmt::format("store.planes={}", planes)});
        EXPECT_EQ(found.exhausted, 0);
        size_t missed = 0, edges = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const float t = found.abuffer[i].t, expected = toWall(rays[i].origin, rays[i].direction);
            ASSERT_FALSE(std::isnan(t)) << i;
            // Beside an edge of the room the pixel's centre may show the other wall, whose depth the ray does
            // not have.
            const glm::vec3 hit = glm::abs(rays[i].origin + expected * rays[i].direction - eye);
            const float footprint = std::max({hit.x, hit.y, hit.z}) / 32;
            int walls = 0;
            for (int axis = 0; axis < 3; ++axis)
                walls +=
                    std::abs(rays[i].origin[axis] + expected * rays[i].direction[axis]) > 1 - 2.5f * footprint
                        ? 1
                        : 0;
            if (walls > 1) {
                ++edges;
                missed += t < INFINITY ? 0 : 1;
                continue;
            }
            // Off the wall by half the thickness and by what the wall falls within a pixel and its neighbour.
            const glm::vec3 place = glm::abs(rays[i].origin + t * rays[i].direction);
            EXPECT_LT(std::abs(std::max({place.x, place.y, place.z}) - 1), (planes ? 0.3f : 3.0f) * footprint)
                << view << " " << i << " " << t;
        }
        EXPECT_LT(edges, rays.size() / 3);
        EXPECT_LT(missed, edges / (planes ? 100 : 4)) << view;
    }
}

TEST_F(ABufferRays, SkippingAndStructureChangeNoHit) {
    for (const bool planes : {false, true}) {
        const std::string kept = fmt::format("store.planes={}", planes);
        const Scene scene = loadScene("builtin:lattice?detail=0.3");
        const std::vector<shared::HitRecord> expected =
            hits(scene, "hemisphere.rays", {"abuffer.skipping=false", "store.structure=ll", kept}).abuffer;
        size_t found = 0;
        for (const shared::HitRecord& hit : expected) found += hit.t < INFINITY ? 1 : 0;
        EXPECT_GT(found, expected.size() / 5);
        const auto expectEqual = [&](std::vector<std::string> settings) {
            settings.push_back(kept);
            const auto given = hits(scene, "hemisphere.rays", settings).abuffer;
            size_t different = 0;
            for (size_t i = 0; i < expected.size(); ++i)
                different += given[i].t == expected[i].t && given[i].source == expected[i].source ? 0 : 1;
            std::string what;
            for (const std::string& setting : settings) what += setting + " ";
            EXPECT_EQ(different, 0u) << what;
        };
        for (const char* structure : {"sb", "ll", "dll", "llb", "dllb"})
            for (const int buckets : {1, 4, 16}) {
                const bool bucketed = std::string(structure).ends_with("lb");
                if (bucketed ? buckets == 1 : buckets > 1) continue;
                const std::vector<std::string> store = {fmt::format("store.structure={}", structure),
                                                        fmt::format("store.buckets={}", buckets)};
                for (const char* form :
                     {"abuffer.skipping=false", "abuffer.march=exhaustive", "abuffer.march=hierarchical"})
                    expectEqual({store[0], store[1], form});
                // That data lies elsewhere is seen with the others.
                if (!bucketed) expectEqual({store[0], "store.decoupled=false"});
            }
    }
}

// What is lit at a hit is the triangle's surface, wherever its number lies.
TEST_F(ABufferRays, TheSurfaceAtAHitIsTheSameWhereverItsTriangleIsKept) {
    const Scene scene = loadScene("builtin:pool?detail=0.3");
    const auto lit = [&](const std::string& structure, const char* decoupled) {
        Graph graph = shippedGraph("path_trace", {"store.structure=" + structure,
                                                  std::string("store.decoupled=") + decoupled,
                                                  "depth_bounds.side=32", "path.bounces=1"});
        graph.outputs = {{{"path", "indirect"}, {}}};
        Renderer made = renderer(graph, scene, {}, {32, 18, 1});
        made.frame();
        return made.read({"path", "indirect"}).values;
    };
    for (const char* structure : {"dllb", "ll", "sb"}) {
        const std::vector<float> apart = lit(structure, "true");
        EXPECT_GT(*std::max_element(apart.begin(), apart.end()), 0.1f);
        EXPECT_EQ(lit(structure, "false"), apart) << structure;
    }
}

// Looking at fewer pixels, views or layers finds less.
TEST_F(ABufferRays, FewerStepsViewsAndLayersFindLess) {
    const Scene hall = loadScene("builtin:hall?detail=0.3"),
                lattice = loadScene("builtin:lattice?detail=0.3");
    for (const char* record : {"fragment", "primitive"}) {
        const bool primitive = std::string(record) == "primitive";
        const auto share = [&](const Scene& scene, std::vector<std::string> settings) {
            settings.push_back(fmt::format("abuffer.record={}", record));
            settings.emplace_back("abuffer.thickness=8");
            const Hits found = hits(scene, "hemisphere.rays", settings);
            EXPECT_EQ(found.exhausted, 0) << settings.front();
            size_t hit = 0, exact = 0, nearer = 0;
            for (size_t i = 0; i < found.bvh.size(); ++i) {
                exact += found.bvh[i].t < INFINITY ? 1 : 0;
                hit += found.abuffer[i].t < INFINITY ? 1 : 0;
                nearer += found.abuffer[i].t < found.bvh[i].t ? 1 : 0;
            }
            // A farther primitive may be found in place of the nearest, and nothing else.
            EXPECT_TRUE(!primitive || nearer == 0) << settings.front() << " " << nearer;
            EXPECT_GT(exact, 500u);
            return static_cast<double>(hit) / static_cast<double>(exact);
        };
        const double all = share(hall, {"abuffer.march=exhaustive"}),
                     many = share(hall, {"abuffer.march=fixed"}),
                     few = share(hall, {"abuffer.march=fixed", "abuffer.steps=3"}),
                     single = share(hall, {"bounds.cube=false"});
        EXPECT_GT(all, 0.9) << record;
        EXPECT_GT(many, 0.8 * all) << record;
        EXPECT_LT(few, many) << record;
        EXPECT_LT(single, all) << record;
        EXPECT_GT(single, 0.1) << record;
        if (primitive) continue;
        EXPECT_LT(share(lattice, {"abuffer.layering=single"}), share(lattice, {"abuffer.layering=multi"}));
    }
}

// Several rays of an invocation share what a driver lets its loops make: none of them is cut short.
TEST_F(ABufferRays, ManyRaysAPixelAreNotExhausted) {
    Graph graph = shippedGraph("abuffer_ao", {"ao.rays=20", "abuffer.count_exhausted=true",
                                              "abuffer.skipping=false", "store.structure=ll"});
    RenderOptions options;
    options.countIterations = true; // fails where an invocation makes too many
    Renderer made = renderer(graph, loadScene("builtin:lattice?detail=0.3"), options, {48, 27, 1});
    made.frame();
    made.frame();
    EXPECT_GT(made.last().values.at("abuffer").at("rays"), 10'000);
    EXPECT_EQ(made.last().values.at("abuffer").at("exhausted rays"), 0);
}

// Occlusion by the A-buffer beside the hierarchy's. A surface that is seen at a grazing angle changes its
// depth by many footprints from pixel to pixel, and rays pass between its fragments (section 4.2,
// limitations) unless they are thick: `hall` leaks at one footprint and is tight at eight, where what is thin
// casts too much. Fragments that know their planes hardly leak at a half.
TEST_F(ABufferRays, LeaksBetweenFragmentsOfGrazingSurfacesCloseWithThicknessOrPlanes) {
    double last = 1;
    for (const double thickness : {1.0, 2.0, 4.0, 8.0, 0.5}) {
        const bool planes = thickness < 1;
        const Hits found = hits(loadScene("builtin:hall?detail=0.3"), "hemisphere.rays",
                                {"bounds.side=128", fmt::format("abuffer.thickness={}", thickness),
                                 fmt::format("store.planes={}", planes)});
        size_t rays = 0, missed = 0, invented = 0;
        for (size_t i = 0; i < found.bvh.size(); ++i) {
            if (found.bvh[i].weight == 0) continue; // a pixel without a surface
            ++rays;
            const bool exact = found.bvh[i].t < INFINITY, here = found.abuffer[i].t < INFINITY;
            missed += exact && !here ? 1 : 0;
            invented += !exact && here ? 1 : 0;
        }
        const double share = static_cast<double>(missed) / static_cast<double>(rays);
        EXPECT_LT(share, planes ? 0.02 : last) << thickness;
        EXPECT_LE(invented, planes ? rays / 500 : 0u) << thickness;
        EXPECT_EQ(found.exhausted, 0);
        if (!planes) last = share;
    }
    EXPECT_LT(last, 0.002);
}

// A slope in closed form: rays from all around meet it where it lies, whatever the view sees of it, and at
// all angles but those of its edge.
TEST_F(ABufferRays, PlanesAreMetWhereTheyLie) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (const float steep : {0.0f, 1.0f, 8.0f}) { // from facing the eye to nearly along its rays
        std::vector<glm::vec3> corners;
        for (const glm::vec3& p : square()) corners.emplace_back(p.x, p.y, steep * p.y * 0.4f);
        std::vector<shared::RayRecord> rays;
        for (int i = 0; i < 2000; ++i) {
            const float x = 0.9f * unit(random), y = 0.9f * unit(random);
            const glm::vec3 at(x, y, steep * y * 0.4f);
            const glm::vec3 origin = at + 0.5f * glm::vec3(unit(random), unit(random), unit(random));
            // Along the slope nothing tells where it is met.
            const float across = std::abs(
                glm::dot(glm::normalize(at - origin), glm::normalize(glm::vec3(0, -steep * 0.4f, 1))));
            if (across < 0.1f) continue;
            rays.push_back(rayRecord(origin, at - origin));
        }
        RaySource::rays = rays;
        const Hits found = hits(seenFrom({0.02f, 0.03f, 4}, corners), "own.rays");
        size_t lost = 0, off = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const float t = found.abuffer[i].t;
            lost += t < INFINITY ? 0 : 1;
            if (!(t < INFINITY)) continue;
            // Within half the thickness of the plane, along the view's axis: a pixel is at most twice its
            // depth over the frame's height.
            const glm::vec3 met = rays[i].origin + t * rays[i].direction;
            const float footprint = 2 * (4 - met.z) / static_cast<float>(size.height);
            off += std::abs(met.z - steep * met.y * 0.4f) > 0.3f * footprint ? 1 : 0;
        }
        EXPECT_GT(rays.size(), 1000u);
        EXPECT_LE(lost, rays.size() / 100) << steep;
        EXPECT_LE(off, rays.size() / 50) << steep;
    }
}

TEST_F(ABufferRays, APlaneDoesNotHitItself) {
    std::vector<glm::vec3> corners;
    for (const glm::vec3& p : square()) corners.push_back(3.0f * glm::vec3(p.x, 0, -p.y));
    const Hits found = hits(trianglesScene(corners), "hemisphere.rays");
    size_t rays = 0, hit = 0;
    for (size_t i = 0; i < found.bvh.size(); ++i) {
        rays += found.bvh[i].weight > 0 ? 1 : 0;
        hit += found.abuffer[i].t < INFINITY ? 1 : 0;
    }
    EXPECT_GT(rays, 300u);
    EXPECT_LE(hit, rays / 100) << hit << " of " << rays;
}

} // namespace
} // namespace kestrel::test
