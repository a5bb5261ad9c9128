// Tracers for what is near: a composite of exact halves against the exact tracer to the bit, the march over
// the depth buffer against closed forms and the exact tracer.
#include "core/files.h"
#include "draw/material_defines.h"
#include "support/temporary_folder.h"
#include "traced_fixture.h"

namespace kestrel::test {
namespace {

// Asks a tracer for the surfaces at the hits of RaySource: normal and t.
class SurfaceQuery final : public Pass {
public:
    static PassType type() {
        return Describe<SurfaceQuery>("SurfaceQuery", "Surfaces at hits, for a test")
            .input("rays", PortKind::Buffer, "Ray records")
            .input("tracer", PortKind::Tracer, "Who answers")
            .output("normals", PortKind::Buffer, "Normal and t a ray");
    }
    [[nodiscard]] Declaration declare(const World& world, const Inputs& inputs,
                                      const Demand&) const override {
        Declaration declaration;
        const std::uint64_t rays = inputs["rays"].desc.bytes / sizeof(shared::RayRecord);
        declaration.outputs = {{.port = "normals", .desc = Desc::buffer(rays * sizeof(glm::vec4))}};
        declaration.steps = {{.name = "ask",
                              .shaders = {"surface_query.comp"},
                              .uses = {{.port = "rays", .access = Access::Storage},
                                       {.port = "normals", .access = Access::Storage, .write = true}},
                              .modules = {{"tracer", requests::ClosestHit | requests::Surface}}}};
        declaration.steps.front().defines.merge(materialDefines(world.facts));
        return declaration;
    }
    void execute(const Step&, Commands& commands) override {
        commands.dispatchOver(
            static_cast<std::uint32_t>(commands.desc("rays").bytes / sizeof(shared::RayRecord)));
    }
    static constexpr const char* shader = R"(
#include "shared/ray.h"
#include "lib/tracer.glsl"
#include "lib/iterations.glsl"
#include <port:tracer>
layout(local_size_x = 64) in;
layout(std430) readonly buffer Rays { RayRecord rays[]; };
layout(std430) writeonly buffer Normals { vec4 normals[]; };
void main() {
    uint id = gl_GlobalInvocationID.x;
    if (id >= uint(rays.length())) return;
    RayRecord r = rays[id];
    Ray ray = Ray(r.origin, r.normal, r.direction, r.tMin, (r.flags & 1u) != 0u ? r.tMax : -1.0, 1.0, 0u);
    tracer_aim(ray);
    Hit hit;
    bool found = tracer_closestHit(ray, hit);
    if (found) normals[id] = vec4(tracer_surface(ray, hit).normal, hit.t);
    else normals[id] = vec4(0.0);
    ITERATIONS_END;
}
)";
};

// A tracer that cannot trace the direction that is asked for.
class AlwaysSnapping final : public Pass {
public:
    static PassType type() {
        return Describe<AlwaysSnapping>("AlwaysSnapping", "Always snaps, for a test")
            .output("tracer", PortKind::Tracer, "Hits nothing");
    }
    [[nodiscard]] Declaration declare(const World&, const Inputs&, const Demand&) const override {
        Declaration declaration;
        declaration.outputs = {
            {.port = "tracer", .desc = Desc::module(provides::Snaps | provides::AlwaysSnaps)}};
        declaration.modules = {{.port = "tracer", .shader = "nothing.glsl"}};
        return declaration;
    }
    void execute(const Step&, Commands&) override {}
};

struct NearField : TracedTest {
    struct Answers {
        std::vector<shared::RayRecord> rays;
        std::vector<shared::HitRecord> a, b;
    };
    // The same rays over hemispheres through two tracers; closest hits.
    static Answers both(const Scene& scene, const std::string& a, const std::string& b,
                        std::vector<std::string> settings = {}) {
        settings.push_back("query.tracer=" + a);
        settings.push_back("other.tracer=" + b);
        Renderer made = traced(scene, settings, {{"rays", "rays"}, {"query", "hits"}, {"other", "hits"}});
        made.frame();
        return {as<shared::RayRecord>(made.readBytes({"rays", "rays"})),
                as<shared::HitRecord>(made.readBytes({"query", "hits"})),
                as<shared::HitRecord>(made.readBytes({"other", "hits"}))};
    }
    static float radius(const Scene& scene) { return gatherFacts(scene).sphere.radius; }
};

const std::vector<std::string> exactHalves = {"hybrid.near=bvh.tracer", "hybrid.far=bvh.tracer"};

TEST_F(NearField, TwoExactHalvesAreTheWhole) {
    const Scene scene = loadScene("builtin:blob?detail=0.1");
    for (const char* reach : {"hybrid.reach=0.02", "hybrid.reach=0.3"}) {
        std::vector<std::string> settings = exactHalves;
        settings.push_back(reach);
        const Answers answers = both(scene, "bvh.tracer", "hybrid.tracer", settings);
        const float border = std::stof(std::string(reach).substr(13)) * radius(scene);
        size_t near = 0, far = 0;
        for (size_t i = 0; i < answers.a.size(); ++i) {
            const shared::HitRecord &a = answers.a[i], &b = answers.b[i];
            if (!std::isfinite(a.t)) {
                ASSERT_FALSE(std::isfinite(b.t));
                continue;
            }
            ASSERT_EQ(a.t, b.t) << i;
            ASSERT_EQ(a.idX, b.idX) << i;
            ASSERT_EQ(a.idY, b.idY) << i;
            // A hit at the border itself would count for the near half.
            ASSERT_EQ(b.source, a.t > border ? 1u : 0u) << i;
            ++(b.source == 0 ? near : far);
        }
        EXPECT_GT(near, 20u) << reach;
        EXPECT_GT(far, 20u) << reach;
    }
    // Occlusion asks for any hit.
    EXPECT_EQ(difference(occlusion(scene, "bvh.tracer", 2), occlusion(scene, "hybrid.tracer", 2, exactHalves))
                  .largest,
              0);
}

// An exact near half that takes many rays at once is asked after the far one, and for all rays of an
// invocation: the answers are those of one ray after the other, to the bit, snapped or not, one ray a pixel
// or several.
TEST_F(NearField, ManyRaysAtOnceAreAnsweredAsOneByOne) {
    const Scene scene = loadScene("builtin:blob?detail=0.1");
    for (const char* snap : {"ao.snap=true", "ao.snap=false"})
        for (const char* rays : {"ao.rays=1", "ao.rays=20"})
            for (const char* tracer : {"hybrid.tracer", "nested.tracer"}) {
                const auto by = [&](const char* layout) {
                    return occlusion(scene, tracer, 2, {"hybrid.near=bvh.tracer", layout, snap, rays});
                };
                const Image many = by("bvh.layout=wide");
                EXPECT_EQ(difference(by("bvh.layout=binary"), many).largest, 0) << snap << rays << tracer;
                EXPECT_GT(difference(many, occlusion(scene, "roma.tracer", 2, {snap, rays})).rms, 0.001);
            }
    // Asked by one that has rays by number and by one that has not, in one graph.
    Renderer made =
        traced(scene, {"hybrid.near=bvh.tracer", "ao.tracer=hybrid.tracer", "query.tracer=hybrid.tracer"},
               {{"mean", "result"}, {"query", "hits"}});
    made.frame();
    EXPECT_EQ(difference(made.read({"mean", "result"}),
                         occlusion(scene, "hybrid.tracer", 1, {"hybrid.near=bvh.tracer"}))
                  .largest,
              0);
}

TEST_F(NearField, TracersOfTracersNest) {
    const Scene scene = loadScene("builtin:blob?detail=0.1");
    // nested = (hybrid = (bvh to 0.1, bvh) to 0.5, bvh), and with the hybrid as the far half.
    for (const bool inFar : {false, true}) {
        std::vector<std::string> settings = exactHalves;
        settings.push_back("hybrid.reach=0.1");
        if (inFar)
            settings.insert(settings.end(), {"nested.near=bvh.tracer", "nested.far=hybrid.tracer",
                                             "nested.reach=0.1", "hybrid.reach=0.5"});
        const Answers answers = both(scene, "bvh.tracer", "nested.tracer", settings);
        const float inner = 0.1f * radius(scene), outer = 0.5f * radius(scene);
        // The lowest bit is the outer tracer's: far 1.
        const std::uint32_t sources[2][3] = {{0, 2, 1}, {0, 1, 3}};
        size_t counts[3] = {0, 0, 0};
        for (size_t i = 0; i < answers.a.size(); ++i) {
            const shared::HitRecord &a = answers.a[i], &b = answers.b[i];
            ASSERT_EQ(a.t, b.t) << i;
            if (!std::isfinite(a.t)) continue;
            const int part = a.t <= inner ? 0 : (a.t <= outer ? 1 : 2);
            ++counts[part];
            ASSERT_EQ(b.source, sources[inFar ? 1 : 0][part]) << i;
        }
        for (const size_t count : counts) EXPECT_GT(count, 20u);
    }
}

TEST_F(NearField, SurfacesComeFromWhoAnswered) {
    const TemporaryFolder folder;
    writeFile(folder / "surface_query.comp", SurfaceQuery::shader);
    Registry registry = tracedRegistry();
    // the query takes surfaces, which no shipped pass of these graphs does
    registry.add(SurfaceQuery::type());
    registry.shaderFolders.push_back(folder.path());
    const Scene scene = loadScene("builtin:blob?detail=0.1");
    std::vector<std::vector<glm::vec4>> results;
    for (const char* tracer : {"bvh.tracer", "hybrid.tracer", "nested.tracer"}) {
        Graph query = parseGraph(std::string(R"({"kestrel": 1, "passes": {"gbuffer": {"type": "GBuffer"},
            "rays": {"type": "HemisphereRays"}, "bvh": {"type": "Bvh"}, "hybrid": {"type": "NearFarTracer"},
            "nested": {"type": "NearFarTracer"}, "surfaces": {"type": "SurfaceQuery"}},
            "edges": [["gbuffer.depth", "rays.depth"], ["gbuffer.normal", "rays.normal"],
                ["bvh.tracer", "hybrid.near"], ["bvh.tracer", "hybrid.far"],
                ["hybrid.tracer", "nested.near"], ["hybrid.tracer", "nested.far"],
                ["rays.rays", "surfaces.rays"], [")") +
                                     tracer + R"(", "surfaces.tracer"]],
            "outputs": ["surfaces.normals"]})",
                                 "test.json");
        RenderOptions options;
        options.size = {64, 36, 1};
        Renderer made(query, registry, scene, context().capabilities(), options);
        made.frame();
        results.push_back(as<glm::vec4>(made.readBytes({"surfaces", "normals"})));
    }
    size_t met = 0;
    for (const glm::vec4& one : results[0]) met += one.w > 0 ? 1 : 0;
    EXPECT_GT(met, 100u);
    EXPECT_TRUE(results[0] == results[1]);
    EXPECT_TRUE(results[0] == results[2]);
}

TEST_F(NearField, WithoutReachTheFarTracerAnswersAlone) {
    const Scene scene = loadScene("builtin:blob?detail=0.02");
    Renderer made = traced(scene, {"hybrid.reach=0", "hybrid.far=bvh.tracer", "other.tracer=hybrid.tracer"},
                           {{"query", "hits"}, {"other", "hits"}});
    std::string all;
    for (const LeftOut& left : made.plan().leftOut) all += left.what + ": " + left.why + "\n";
    EXPECT_NE(all.find("its reach is 0"), std::string::npos) << all;
    for (const PlanPass& pass : made.plan().passes) EXPECT_NE(pass.type, "ScreenTrace");
    made.frame();
    EXPECT_TRUE(made.readBytes({"query", "hits"}) == made.readBytes({"other", "hits"}));
}

TEST_F(NearField, ANearHalfThatAlwaysSnapsIsRefused) {
    Registry registry = tracedRegistry();
    registry.add(AlwaysSnapping::type());
    Graph graph = parseGraph(
        R"({"kestrel": 1, "passes": {"snapping": {"type": "AlwaysSnapping"}, "bvh": {"type": "Bvh"},
        "hybrid": {"type": "NearFarTracer"}, "own": {"type": "RaySource"}, "query": {"type": "RayQuery", "properties": {"snap": true}}},
        "edges": [["snapping.tracer", "hybrid.near"], ["bvh.tracer", "hybrid.far"], ["own.rays", "query.rays"],
            ["hybrid.tracer", "query.tracer"]], "outputs": ["query.hits"]})",
        "test.json");
    RaySource::rays = {rayRecord({0, 0, 0}, {0, 0, 1})};
    try {
        const Renderer made(graph, registry, trianglesScene(square()), context().capabilities());
        FAIL() << "a tracer that always snaps cannot be the near half";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("always snaps"), std::string::npos) << error.what();
    }
}

TEST_F(NearField, TheFarHalfSnapsAndTheNearFollows) {
    // An open plane sees the whole sky whoever answers; ROMA snaps in the far half, in the near it may not.
    const Scene scene = trianglesScene(square());
    for (const auto& halves :
         {std::vector<std::string>{"hybrid.near=bvh.tracer", "hybrid.far=roma.tracer"},
          std::vector<std::string>{"hybrid.near=roma.tracer", "hybrid.far=bvh.tracer"},
          std::vector<std::string>{"hybrid.near=roma.tracer", "hybrid.far=roma.tracer"}}) {
        std::vector<std::string> settings = halves;
        settings.push_back("roma.offset=1.5");
        const Image open = occlusion(scene, "hybrid.tracer", 16, settings);
        double sum = 0;
        for (const float value : open.values) sum += value;
        EXPECT_GE(sum / static_cast<double>(open.values.size()), 0.99) << halves[0] << " " << halves[1];
    }
}

// ---- the march over the depth buffer

// In the coordinates that a scene was made in; what is rendered is relative to its origin.
CameraState lookingFrom(const Scene& scene, const glm::vec3& from, const glm::vec3& to) {
    const glm::vec3 eye = from - glm::vec3(scene.origin), at = to - glm::vec3(scene.origin);
    CameraState camera;
    camera.view = glm::lookAt(eye, at, glm::vec3(0, 0, 1));
    camera.position = eye;
    camera.nearPlane = 0.05f;
    camera.farPlane = 50;
    return camera;
}

TEST_F(NearField, AnOpenPlaneSeesTheSkyOnScreen) {
    // At any angle towards the camera the plane must not hide itself.
    for (const float degrees : {10.0f, 30.0f, 60.0f, 89.0f})
        for (const char* stride : {"screen.stride=1", "screen.stride=3"}) {
            const Scene scene = trianglesScene(square());
            Renderer made = traced(scene, {"ao.tracer=screen.tracer", stride},
                                   {{"mean", "result"}, {"gbuffer", "coverage"}}, {}, {160, 90, 1});
            const float angle = glm::radians(degrees);
            made.setFreeCamera(
                lookingFrom(scene, 3.0f * glm::vec3(0.2f, -std::cos(angle), std::sin(angle)), glm::vec3(0)));
            for (int i = 0; i < 8; ++i) made.frame();
            const Image coverage = made.read({"gbuffer", "coverage"});
            EXPECT_GE(meanWhere(made.read({"mean", "result"}), coverage), 0.99) << degrees << " " << stride;
        }
}

TEST_F(NearField, AWallOnScreenHidesHalfOfTheSky) {
    // The whole wall is in view; rays start at its foot, and the closed form counts what it stops.
    std::vector<glm::vec3> corners = square();
    const float wall = 0.08f;
    for (const glm::vec3& p : square()) corners.emplace_back(p.x, wall, p.y + 1);
    const Scene scene = trianglesScene(corners);
    std::vector<shared::RayRecord> rays;
    double open = 0;
    for (const glm::vec3& direction : hemisphereDirections(4000)) {
        rays.push_back(rayRecord(-glm::vec3(scene.origin), direction, {0, 0, 1}));
        const float t = wall / direction.y;
        const bool stopped = t > 0 && std::abs(t * direction.x) < 1 && t * direction.z < 2;
        open += stopped ? 0 : 1;
    }
    open /= static_cast<double>(rays.size());
    EXPECT_NEAR(open, 0.5, 0.04); // the wall ends
    RaySource::rays = rays;
    for (const char* stride : {"screen.stride=1", "screen.stride=4"}) {
        Renderer made =
            traced(scene, {"query.rays=own.rays", "query.tracer=screen.tracer", "screen.steps=512", stride},
                   {{"query", "hits"}}, {}, {320, 180, 1});
        made.setFreeCamera(lookingFrom(scene, {0.5f, -4, 2.5f}, {0, 0, 0.8f}));
        made.frame();
        double seen = 0;
        size_t wrong = 0;
        const auto hits = as<shared::HitRecord>(made.readBytes({"query", "hits"}));
        for (size_t i = 0; i < rays.size(); ++i) {
            seen += std::isfinite(hits[i].t) ? 0 : 1;
            const float t = wall / rays[i].direction.y;
            if (std::isfinite(hits[i].t) && std::abs(hits[i].t - t) > 0.05f + 0.1f * t) ++wrong;
        }
        EXPECT_NEAR(seen / static_cast<double>(rays.size()), open, 0.03) << stride;
        EXPECT_LE(wrong, rays.size() / 25) << stride; // samples four pixels apart see less of edges
    }
}

TEST_F(NearField, HitsOnScreenAreThoseOfTheBvh) {
    // Of rays that end within a tenth of the scene, and whose exact hit the screen may show, most are found
    // and few are invented.
    const Scene scene = loadScene("builtin:blob?detail=0.1");
    const float reach = 0.2f * radius(scene);
    const Answers answers = both(scene, "bvh.tracer", "screen.tracer",
                                 {fmt::format("rays.distance={}", reach), "screen.steps=256"});
    size_t traced = 0, alike = 0, bothHit = 0, close = 0;
    for (size_t i = 0; i < answers.rays.size(); ++i) {
        if ((answers.rays[i].flags & 1u) == 0) continue;
        ++traced;
        const bool a = std::isfinite(answers.a[i].t), b = std::isfinite(answers.b[i].t);
        alike += a == b ? 1 : 0;
        if (!a || !b) continue;
        ++bothHit;
        close += std::abs(answers.a[i].t - answers.b[i].t) < 0.25f * reach ? 1 : 0;
    }
    ASSERT_GT(traced, 1000u);
    RecordProperty("alike", fmt::format("{}", double(alike) / double(traced)));
    RecordProperty("close", fmt::format("{}", double(close) / double(bothHit)));
    EXPECT_GE(alike, traced * 85 / 100);
    EXPECT_GE(close, bothHit * 75 / 100);
}

TEST_F(NearField, TheScreenSharpensWhatVoxelsBlur) {
    const Scene scene = loadScene("builtin:blob?detail=0.2");
    const Extent size{192, 108, 1};
    const Image reference = occlusion(scene, "bvh.tracer", 16, {"ao.rays=16"}, size);
    const ErrorFigures alone = measureError(reference, occlusion(scene, "roma.tracer", 32, {}, size));
    const ErrorFigures screen = measureError(reference, occlusion(scene, "screen.tracer", 32, {}, size));
    const ErrorFigures hybrid = measureError(reference, occlusion(scene, "hybrid.tracer", 32, {}, size));
    const ErrorFigures exactFar =
        measureError(reference, occlusion(scene, "hybrid.tracer", 32, {"hybrid.far=bvh.tracer"}, size));
    RecordProperty("roma", toJson(alone));
    RecordProperty("screen", toJson(screen));
    RecordProperty("screen, then roma", toJson(hybrid));
    RecordProperty("screen, then bvh", toJson(exactFar));
    EXPECT_LT(hybrid.flip.mean, alone.flip.mean);
    EXPECT_LT(hybrid.mse, alone.mse);
    EXPECT_LT(exactFar.mse, 0.5 * screen.mse);
}

TEST_F(NearField, EveryTracerIsSoundOnWhateverThereIs) {
    for (const char* tracer : {"screen.tracer", "hybrid.tracer", "nested.tracer"}) {
        expectSound(trianglesScene({}), tracer);
        expectSound(trianglesScene({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0.5f}}), tracer);
        expectSound(trianglesScene({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}), tracer);
        const Scene scene = loadScene("builtin:blob?detail=0.02");
        expectSound(scene, tracer, {}, {1, 1, 1});
        expectSound(scene, tracer, {"screen.jitter=true", "screen.stride=5", "hybrid.relative=false"});
    }
}

TEST_F(NearField, ScaleDoesNotMatter) {
    const char* source = "builtin:blob?detail=0.02";
    for (const char* tracer : {"screen.tracer", "hybrid.tracer"}) {
        const Image usual = occlusion(transformed(source, glm::dmat4(1)), tracer, 4);
        for (const double scale : {1e-4, 1e4}) {
            const Scene changed = transformed(source, glm::scale(glm::dmat4(1), glm::dvec3(scale)));
            expectSound(changed, tracer);
            EXPECT_LE(difference(usual, occlusion(changed, tracer, 4)).rms, 0.05) << tracer << " " << scale;
        }
    }
}

TEST_F(NearField, JitteredStridesConvergeToSingleSteps) {
    const Scene scene = loadScene("builtin:blob?detail=0.05");
    const Image fine = occlusion(scene, "screen.tracer", 16, {"screen.steps=256"});
    const Image jittered =
        occlusion(scene, "screen.tracer", 16, {"screen.steps=64", "screen.stride=4", "screen.jitter=true"});
    EXPECT_LE(difference(fine, jittered).rms, 0.1);
    EXPECT_GT(difference(fine, jittered).rms, 0);
}

TEST_F(NearField, RaysFromTheEyeAndFromBehindAreSound) {
    // Through the eye a ray is one pixel; from behind it, or along its plane, nothing is seen.
    std::vector<glm::vec3> corners;
    for (const glm::vec3& p : square()) corners.emplace_back(p.x, 1, p.y);
    const Scene scene = trianglesScene(corners);
    RaySource::rays = {rayRecord({0, -3, 0.5f}, {0, 1, 0}), rayRecord({0, -4, 0.5f}, {0, -1, 0}),
                       rayRecord({0, -3, 0.5f}, {1, 0, 0}), rayRecord({0, -5, 0.5f}, {0, 1, 0}),
                       rayRecord({0, 2, 0.5f}, {0, 1, 0})};
    for (shared::RayRecord& ray : RaySource::rays) ray.origin -= glm::vec3(scene.origin);
    Renderer made = traced(scene, {"query.rays=own.rays", "query.tracer=screen.tracer"}, {{"query", "hits"}});
    made.setFreeCamera(lookingFrom(scene, {0, -3, 0.5f}, {0, 1, 0.5f}));
    made.frame();
    const auto hits = as<shared::HitRecord>(made.readBytes({"query", "hits"}));
    EXPECT_NEAR(hits[0].t, 4, 0.02);
    EXPECT_FALSE(std::isfinite(hits[1].t));
    EXPECT_FALSE(std::isfinite(hits[2].t));
    EXPECT_NEAR(hits[3].t, 6, 0.02);
    EXPECT_FALSE(std::isfinite(hits[4].t)); // behind what is shown, beyond the thickness
}

} // namespace
} // namespace kestrel::test
