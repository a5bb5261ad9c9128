// The distance field against brute force, its tracer against closed forms, then against the exact tracer.
#include "graph/plan.h"
#include "shader/validate.h"
#include "shared/occupancy.h"
#include "traced_fixture.h"

namespace kestrel::test {
namespace {

struct DistanceFields : TracedTest {
    // A field's level, x fastest, then y, then z.
    static std::vector<float> level(Renderer& made, const std::string& pass, int mip = 0) {
        const auto n = static_cast<int>(made.desc({pass, "field"}).extent.width) >> mip;
        std::vector<float> values(static_cast<size_t>(n) * n * n);
        for (int z = 0; z < n; ++z) {
            const Image slice = made.read({pass, "field"}, z, mip);
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    values[static_cast<size_t>((z * n + y) * n + x)] =
                        slice.at(x, n - 1 - y); // row 0 is the top
        }
        return values;
    }
    static std::vector<glm::ivec3> occupied(Renderer& made, int n) {
        const auto words = as<std::uint32_t>(made.readBytes({"bom", "occupancy"}));
        std::vector<glm::ivec3> cells;
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    if ((words.at(static_cast<size_t>(shared::occupancyWord(x, y, z, n))) >> (z & 31) & 1u) !=
                        0)
                        cells.emplace_back(x, y, z);
        return cells;
    }
    static RenderOptions previewing(std::vector<PortRef> ports) {
        RenderOptions options;
        options.previews = std::move(ports);
        return options;
    }
    // A pass's field of a scene, readable.
    static std::unique_ptr<Renderer> fields(const Scene& scene, const std::string& pass, int n,
                                            std::vector<std::string> settings = {}) {
        settings.push_back(fmt::format("bom.resolution={}", n));
        settings.push_back("query.tracer=" + pass + ".tracer");
        RenderOptions options = previewing({{pass, "field"}});
        options.size = {8, 8, 1};
        auto made =
            std::make_unique<Renderer>(tracedGraph(settings, {{"query", "hits"}, {"bom", "occupancy"}}),
                                       tracedRegistry(), scene, context().capabilities(), options);
        made->frame();
        return made;
    }
};

// Half the distance of two 16-bit floats around a value.
double halfRounding(double value) { return std::max(value, 6.2e-5) * 0x1p-11; }

std::vector<glm::vec3> someTriangles(int count, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 centre(unit(random), unit(random), unit(random));
        for (int k = 0; k < 3; ++k)
            corners.push_back(centre + 0.3f * glm::vec3(unit(random), unit(random), unit(random)));
    }
    return corners;
}

TEST_F(DistanceFields, ExactIsTheDistanceToTheNearestOccupiedCell) {
    struct Case {
        int n;
        std::vector<glm::vec3> corners;
    };
    std::vector<Case> cases;
    for (const int triangles : {1, 3, 40}) cases.push_back({32, someTriangles(triangles, 7)});
    cases.push_back({64, someTriangles(5, 3)});
    cases.push_back({32, square()});
    for (const Case& one : cases) {
        const auto made = fields(trianglesScene(one.corners), "field", one.n);
        const std::vector<glm::ivec3> cells = occupied(*made, one.n);
        ASSERT_GT(cells.size(), 0u);
        const std::vector<float> field = level(*made, "field");
        const int every = one.n == 32 ? 1 : 3; // a part is enough of the large one
        size_t index = 0;
        for (int z = 0; z < one.n; ++z)
            for (int y = 0; y < one.n; ++y)
                for (int x = 0; x < one.n; ++x, ++index) {
                    if (x % every + y % every != 0) continue;
                    int least = 1 << 30;
                    for (const glm::ivec3& cell : cells) {
                        const glm::ivec3 d = cell - glm::ivec3(x, y, z);
                        least = std::min(least, d.x * d.x + d.y * d.y + d.z * d.z);
                    }
                    const double expected = std::sqrt(least);
                    ASSERT_NEAR(field[index], expected, halfRounding(expected) * 1.001)
                        << one.n << ": " << x << " " << y << " " << z;
                }
    }
}

TEST_F(DistanceFields, JumpFloodingIsNearExact) {
    // What is known of jump flooding: few cells are wrong, never too near, by less than a cell.
    const Scene scene = loadScene("builtin:blob?detail=0.1");
    const auto exactly = fields(scene, "field", 128);
    const auto flooded = fields(scene, "flooded", 128);
    const std::vector<float> a = level(*exactly, "field"), b = level(*flooded, "flooded");
    size_t different = 0;
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        if (b[i] != a[i]) ++different;
        ASSERT_GE(b[i], a[i]);
        most = std::max(most, double{b[i]} - double{a[i]});
    }
    RecordProperty("different", static_cast<int>(different));
    RecordProperty("most", fmt::format("{}", most));
    EXPECT_LE(different, a.size() / 500);
    EXPECT_LE(most, 1.25);
}

TEST_F(DistanceFields, LevelsAreMeans) {
    const auto made = fields(trianglesScene(someTriangles(10, 5)), "field", 32, {"field.mips=5"});
    for (int mip = 1; mip < 5; ++mip) {
        const std::vector<float> fine = level(*made, "field", mip - 1), coarse = level(*made, "field", mip);
        const int n = 32 >> mip;
        for (int z = 0; z < n; ++z)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    double sum = 0;
                    for (int i = 0; i < 8; ++i)
                        sum += fine[static_cast<size_t>(
                            ((2 * z + (i >> 2)) * 2 * n + 2 * y + (i >> 1 & 1)) * 2 * n + 2 * x + (i & 1))];
                    const float value = coarse[static_cast<size_t>((z * n + y) * n + x)];
                    ASSERT_NEAR(value, sum / 8, halfRounding(sum / 8) * 1.01);
                }
    }
}

// Rays from all sides at the square [-1, 1]^2 in z = 0, against the closed form. What passes within two cells
// of its edge may go either way.
TEST_F(DistanceFields, RaysMeetASquareWhereTheyShould) {
    const Scene scene = trianglesScene(square());
    const float cell = 2 * std::sqrt(2.0f) / 126;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::vector<shared::RayRecord> rays;
    for (int i = 0; i < 3000; ++i) {
        const float reach = i % 4 == 0 ? 40.0f : (i % 4 == 1 ? 3.0f : 1.0f); // within the map and far outside
        glm::vec3 origin = reach * glm::vec3(unit(random), unit(random), unit(random));
        glm::vec3 target = 1.3f * glm::vec3(unit(random), unit(random), 0);
        if (i % 5 == 0) { // along an axis
            origin = glm::vec3(0.9f * unit(random), 0.9f * unit(random), i % 2 == 0 ? 2.5f : -0.5f);
            target = glm::vec3(origin.x, origin.y, 0);
        }
        if (std::abs(origin.z) < 4 * cell) continue;
        const float way = glm::length(target - origin);
        float tMax = std::numeric_limits<float>::infinity(), tMin = 0;
        if (i % 3 == 1) tMax = way + (i % 2 == 0 ? 12 : -12) * cell;
        if (i % 7 == 2) tMin = way + (i % 2 == 0 ? 12 : -12) * cell;
        if (tMin < 0 || tMax < 0) continue;
        rays.push_back(rayRecord(origin, target - origin, glm::vec3(0), tMin, tMax));
    }
    for (const char* tracer : {"field.tracer", "flooded.tracer"})
        for (const char* setting : {"field.level=step", "field.level=travelled"}) {
            // At a threshold as wide as half a cell's diagonal nothing slips through a plane.
            const auto hits =
                ask(scene, tracer, rays,
                    {setting, "field.iterations=256", "flooded.iterations=256", "field.threshold=0.75"});
            size_t wrong = 0, judged = 0, met = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                const shared::RayRecord& ray = rays[i];
                const float t = -ray.origin.z / ray.direction.z;
                const glm::vec3 at = ray.origin + t * ray.direction;
                const float edge = 1 - std::max(std::abs(at.x), std::abs(at.y));
                if (std::abs(ray.direction.z) < 0.5f || std::abs(edge) < 8 * cell) continue; // grazing
                const bool expected = edge > 0 && t >= ray.tMin && t <= ray.tMax;
                ++judged;
                met += expected ? 1 : 0;
                const bool hit = std::isfinite(hits[i].t);
                // Coarse levels make a plane as thick as their cells.
                const float allowed = (std::string(setting).ends_with("travelled") ? 12 : 5) * cell;
                if (hit != expected || (hit && std::abs(hits[i].t - t) > allowed)) ++wrong;
            }
            ASSERT_GT(judged, 1000u);
            ASSERT_GT(met, 400u);
            // Far origins round their positions; a handful of rays of thousands is left to that.
            EXPECT_LE(wrong, judged / 200) << tracer << " " << setting << " of " << judged;
        }
}

TEST_F(DistanceFields, WithoutRoomNothingIsHit) {
    const Scene scene = trianglesScene(square());
    const auto hits = ask(scene, "field.tracer",
                          {rayRecord({0, 0, 1}, {0, 0, -1}, {0, 0, 0}, 0, 0.5f), // ends before
                           rayRecord({0, 0, 1}, {0, 0, -1}, {0, 0, 0}, 0, -1),   // does not exist
                           rayRecord({0, 0, 1}, {0, 0, 1}), rayRecord({5, 0, 1}, {0, 0, -1}),
                           rayRecord({0, 0, 1}, {0, 0, -1})});
    for (size_t i = 0; i < 4; ++i) EXPECT_FALSE(std::isfinite(hits[i].t)) << i;
    EXPECT_NEAR(hits[4].t, 1, 0.05);
}

TEST_F(DistanceFields, AnOpenPlaneSeesTheSky) {
    std::vector<shared::RayRecord> rays;
    for (const glm::vec3& direction : hemisphereDirections(4000))
        rays.push_back(rayRecord({0.1f, -0.2f, 0}, direction, {0, 0, 1}));
    for (const float degrees : {0.0f, 17.0f, 45.0f, 73.0f}) {
        const glm::mat3 turn(
            glm::rotate(glm::mat4(1), glm::radians(degrees), glm::normalize(glm::vec3(1, 0.3f, 0.2f))));
        std::vector<shared::RayRecord> turned = rays;
        for (shared::RayRecord& ray : turned) {
            ray.origin = turn * ray.origin;
            ray.direction = turn * ray.direction;
            ray.normal = turn * ray.normal;
        }
        size_t open = 0;
        for (const auto& hit : ask(trianglesScene(square(turn)), "field.tracer", turned))
            open += std::isfinite(hit.t) ? 0 : 1;
        EXPECT_GE(open, rays.size() * 985 / 1000) << degrees;
    }
}

TEST_F(DistanceFields, AWallHidesHalfOfTheSky) {
    // Ground and a wall of twice its half width; the rays that it stops are counted by the closed form.
    std::vector<glm::vec3> corners = square();
    const float wall = -0.08f;
    for (const glm::vec3& p : square()) corners.emplace_back(wall, p.x, p.y + 1);
    const Scene scene = trianglesScene(corners);
    std::vector<shared::RayRecord> rays;
    double open = 0;
    for (const glm::vec3& direction : hemisphereDirections(4000)) {
        rays.push_back(rayRecord(-glm::vec3(scene.origin), direction, {0, 0, 1}));
        const float t = wall / direction.x;
        const bool stopped = t > 0 && std::abs(t * direction.y) < 1 && t * direction.z < 2;
        open += stopped ? 0 : 1;
    }
    open /= static_cast<double>(rays.size());
    EXPECT_NEAR(open, 0.5, 0.04); // the wall ends
    double seen = 0;
    for (const auto& hit : ask(scene, "field.tracer", rays)) seen += std::isfinite(hit.t) ? 0 : 1;
    EXPECT_NEAR(seen / static_cast<double>(rays.size()), open, 0.02);
}

TEST_F(DistanceFields, HitsLieWhereTheBvhFindsThem) {
    const Scene scene = loadScene("builtin:blob?detail=0.1");
    for (const char* tracer : {"field.tracer", "flooded.tracer"}) {
        Renderer made =
            traced(scene, {std::string("other.tracer=") + tracer},
                   {{"rays", "rays"}, {"query", "hits"}, {"other", "hits"}}, previewing({{"bom", "grid"}}));
        made.frame();
        const auto rays = as<shared::RayRecord>(made.readBytes({"rays", "rays"}));
        const auto exact = as<shared::HitRecord>(made.readBytes({"query", "hits"}));
        const auto found = as<shared::HitRecord>(made.readBytes({"other", "hits"}));
        const float cell = as<shared::OccupancyGrid>(made.readBytes({"bom", "grid"})).at(0).cellSize;
        size_t traced = 0, alike = 0, both = 0, close = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            if ((rays[i].flags & 1u) == 0) continue;
            ++traced;
            const bool a = std::isfinite(exact[i].t), b = std::isfinite(found[i].t);
            alike += a == b ? 1 : 0;
            // Within a few cells of its start a ray meets what is near the surface that it left.
            if (!a || !b || exact[i].t < 6 * cell) continue;
            ++both;
            close += std::abs(exact[i].t - found[i].t) < 4 * cell ? 1 : 0;
        }
        ASSERT_GT(traced, 1000u);
        RecordProperty(std::string(tracer) + " alike", fmt::format("{}", double(alike) / double(traced)));
        RecordProperty(std::string(tracer) + " close", fmt::format("{}", double(close) / double(both)));
        EXPECT_GE(alike, traced * 90 / 100);
        EXPECT_GE(close, both * 80 / 100);
    }
}

TEST_F(DistanceFields, OcclusionComesNearTheBvh) {
    const Scene scene = loadScene("builtin:blob?detail=0.2");
    const Image reference = occlusion(scene, "bvh.tracer", 16, {"ao.rays=16"}, {192, 108, 1});
    for (const char* tracer : {"field.tracer", "flooded.tracer"}) {
        const ErrorFigures error = measureError(reference, occlusion(scene, tracer, 32, {}, {192, 108, 1}));
        RecordProperty(tracer, toJson(error));
        EXPECT_LE(error.flip.mean, 0.05) << tracer;
        EXPECT_LE(error.mse, 0.006) << tracer;
    }
}

TEST_F(DistanceFields, EveryVariantIsSound) {
    const Scene scene = loadScene("builtin:blob?detail=0.02");
    for (const char* method : {"jump_flooding", "exact"})
        for (const char* choice : {"step", "travelled"})
            for (const int n : {32, 64, 256}) {
                if (n == 256 && std::string(choice) == "travelled") continue;
                expectSound(scene, "field.tracer",
                            {std::string("field.method=") + method, std::string("field.level=") + choice,
                             fmt::format("bom.resolution={}", n), n == 64 ? "field.mips=1" : "field.mips=4"});
            }
}

TEST_F(DistanceFields, ExtremesAreSound) {
    expectSound(trianglesScene({}), "field.tracer");
    expectSound(trianglesScene({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.5f}}), "field.tracer");
    expectSound(trianglesScene({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}), "field.tracer");
    expectSound(loadScene("builtin:blob?detail=0.02"), "field.tracer", {}, {1, 1, 1});
    // Cells that no raster marks leave a field without seeds.
    expectSound(trianglesScene({{-1, 0, 0}, {1, 0, 0}, {0, 1e-6f, 0}}), "field.tracer",
                {"bom.method=dominant_axis"});
    expectSound(trianglesScene({{-1, 0, 0}, {1, 0, 0}, {0, 1e-6f, 0}}), "flooded.tracer",
                {"bom.method=dominant_axis"});
}

TEST_F(DistanceFields, ScaleDoesNotMatter) {
    const char* source = "builtin:blob?detail=0.02";
    const Image usual = occlusion(transformed(source, glm::dmat4(1)), "field.tracer", 4);
    for (const double scale : {1e-4, 1e4}) {
        const Scene changed = transformed(source, glm::scale(glm::dmat4(1), glm::dvec3(scale)));
        expectSound(changed, "field.tracer");
        EXPECT_LE(difference(usual, occlusion(changed, "field.tracer", 4)).rms, 0.03) << scale;
    }
}

TEST_F(DistanceFields, AnEmptyMapLeavesTheFieldOut) {
    RaySource::rays = {rayRecord({0, 0, 0}, {0, 0, 1})};
    Renderer made =
        traced(trianglesScene({}), {"query.rays=own.rays", "query.tracer=field.tracer"}, {{"query", "hits"}});
    std::string all;
    for (const LeftOut& left : made.plan().leftOut) all += left.what + ": " + left.why + "\n";
    EXPECT_NE(all.find("distance field: the occupancy map is empty"), std::string::npos) << all;
    for (const PlanStep& step : made.plan().steps)
        EXPECT_NE(made.plan().passes.at(static_cast<size_t>(step.pass)).type, "DistanceField");
    for (const auto& hit : ask(trianglesScene({}), "field.tracer", {rayRecord({0, 0, 0}, {0, 0, 1})}))
        EXPECT_FALSE(std::isfinite(hit.t));
}

TEST_F(DistanceFields, AStaticSceneMakesItsFieldOnce) {
    RenderOptions timed;
    timed.timing = true;
    Renderer made = traced(loadScene("builtin:blob?detail=0.02"), {"ao.tracer=field.tracer"},
                           {{"mean", "result"}}, timed);
    size_t runs = 0;
    for (int i = 0; i < 3; ++i)
        for (const StepSample& sample : made.frame().samples) runs += sample.step == "along_x" ? 1 : 0;
    EXPECT_EQ(runs, 1u);
}

TEST_F(DistanceFields, SmallTexelBuffersAreDoneWithout) {
    // Where a map does not fit a texel buffer its words are read through a storage block.
    World world;
    world.facts = gatherFacts(trianglesScene(square()));
    world.size = {32, 32, 1};
    ASSERT_LT(world.capabilities.maxTextureBufferTexels, 256 * 256 * 256 / 32);
    std::vector<std::filesystem::path> folders = {shareFolder() / "shaders"};
    ShaderLibrary library(std::move(folders));
    size_t throughStorage = 0;
    for (const char* method : {"field.method=exact", "field.method=jump_flooding"}) {
        const Graph graph =
            tracedGraph({method, "bom.resolution=256", "ao.tracer=field.tracer"}, {{"mean", "result"}});
        const Plan plan = compile(graph, tracedRegistry(), makePasses(graph, tracedRegistry()), world,
                                  {.keepAll = false, .shareMemory = true, .previews = {}});
        for (const ProgramRequest& request : plan.programs) {
            throughStorage += request.defines.contains("BASE_STORAGE") ? 1 : 0;
            for (const Problem& problem : validate(compose(request, library)))
                ADD_FAILURE() << problem.text();
        }
    }
    EXPECT_EQ(throughStorage, 2u);
}

TEST_F(DistanceFields, WhatIsNoMapIsRefused) {
    const PassType* type = shipped().find("DistanceField");
    ASSERT_NE(type, nullptr);
    Inputs inputs;
    inputs.set("occupancy", {.desc = Desc::buffer(12345, Format::R32UI), .constant = {}});
    inputs.set("grid", {.desc = Desc::buffer(32), .constant = {}});
    EXPECT_FALSE(type->make()->declare(World(), inputs, Demand::everything()).problems.empty());
}

} // namespace
} // namespace kestrel::test
