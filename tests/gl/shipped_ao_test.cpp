// Ambient occlusion: analytic truth, then the reference ray tracer, then what leaving out must not change.
#include "shipped_fixture.h"

namespace kestrel::test {
namespace {

const std::vector<std::string> byBvh = {"ao.tracer=bvh.tracer"};
const PortRef mean{"mean", "result"};

struct Ao : ShippedTest {
    static Image visibility(Scene scene, const std::vector<std::string>& settings, int frames) {
        return render(shippedGraph("ray_ao", settings), std::move(scene), mean, frames);
    }
    static Image coverage(Scene scene) {
        Graph graph = shippedGraph("reference_ao");
        graph.outputs = {{{"gbuffer", "coverage"}, {}}};
        return render(graph, std::move(scene), {"gbuffer", "coverage"});
    }
};

glm::mat3 tilt(float degrees, const glm::vec3& axis) {
    return glm::mat3(glm::rotate(glm::mat4(1), glm::radians(degrees), glm::normalize(axis)));
}

TEST_F(Ao, AnOpenPlaneSeesTheWholeSkyAtAnyTilt) {
    for (const float degrees : {0.0f, 17.0f, 45.0f, 73.0f, 90.0f}) {
        const Scene scene = trianglesScene(square(tilt(degrees, {1, 0.3f, 0.2f})));
        const Image mask = coverage(scene);
        ASSERT_GT(meanWhere(mask, mask), 0);
        for (const float value : visibility(scene, byBvh, 4).values) ASSERT_EQ(value, 1.0f) << degrees;
        EXPECT_GE(meanWhere(visibility(scene, {"roma.offset=1.5"}, 32), mask), 0.995) << "ROMA, tilted by " << degrees;
    }
}

TEST_F(Ao, InsideAClosedBoxNothingIsVisible) {
    // Six squares around the camera; what a ray meets does not depend on the side.
    std::vector<glm::vec3> corners;
    const glm::mat3 sides[] = {tilt(0, {1, 0, 0}),   tilt(90, {1, 0, 0}), tilt(180, {1, 0, 0}),
                               tilt(270, {1, 0, 0}), tilt(90, {0, 1, 0}), tilt(270, {0, 1, 0})};
    for (const glm::mat3& side : sides)
        for (const glm::vec3& p : square()) corners.push_back(side * (p + glm::vec3(0, 0, 1)));
    Scene scene = trianglesScene(corners);
    for (const auto& settings : {byBvh, std::vector<std::string>{}}) {
        Renderer made = renderer(shippedGraph("ray_ao", settings), scene);
        made.setFreeCamera(
            CameraState{.view = glm::mat4(1), .position = glm::vec3(0), .nearPlane = 0.01f, .farPlane = 10});
        for (int i = 0; i < 8; ++i) made.frame();
        double sum = 0;
        const Image image = made.read(mean);
        for (const float value : image.values) sum += value;
        // The three-axis raster misses cells where walls meet (notes of the paper's section 6): a little
        // light leaks.
        EXPECT_LE(sum / static_cast<double>(image.values.size()), settings.empty() ? 0.02 : 0.0);
    }
}

TEST_F(Ao, TheBvhConvergesToEmbree) {
    if (shipped().find("ReferenceAmbientOcclusion") == nullptr) GTEST_SKIP() << "Embree is not built in";
    const Scene scene = loadScene("builtin:blob?detail=0.05");
    const Image reference =
        render(shippedGraph("reference_ao", {"reference.samples=256"}), scene, {"reference", "visibility"});
    const Image few = visibility(scene, {"ao.tracer=bvh.tracer", "ao.rays=16"}, 1);
    const Image many = visibility(scene, {"ao.tracer=bvh.tracer", "ao.rays=16"}, 16);
    // 256 rays of a fair coin have a standard error of at most 1/32; a stratified sequence stays well below.
    EXPECT_LE(difference(reference, many).rms, 0.02);
    EXPECT_LE(difference(reference, many).rms, 0.5 * difference(reference, few).rms);
}

TEST_F(Ao, RomaComesNearEmbree) {
    if (shipped().find("ReferenceAmbientOcclusion") == nullptr) GTEST_SKIP() << "Embree is not built in";
    const Scene scene = loadScene("builtin:blob?detail=0.05");
    const Image reference =
        render(shippedGraph("reference_ao", {"reference.samples=256"}), scene, {"reference", "visibility"});
    EXPECT_LE(difference(reference, visibility(scene, {}, 32)).rms, 0.12);
}

TEST_F(Ao, RaysOfOneStepAndOfSeveralAreTheSame) {
    // 32 rays take two steps; the same 32 samples over two frames of 16 take one step each.
    const Scene scene = loadScene("builtin:blob?detail=0.02");
    const Image once = visibility(scene, {"ao.tracer=bvh.tracer", "ao.rays=32"}, 1);
    const Image twice = visibility(scene, {"ao.tracer=bvh.tracer", "ao.rays=16"}, 2);
    EXPECT_LE(difference(once, twice).largest, 1e-6); // sums of halves against a mean of means: rounding only
}

TEST_F(Ao, SwappingTheTracerLeavesTheMapOut) {
    const Renderer made = renderer(shippedGraph("ray_ao", byBvh), loadScene("builtin:blob?detail=0.02"));
    std::string all;
    for (const LeftOut& left : made.plan().leftOut) all += left.what + ": " + left.why + "\n";
    EXPECT_NE(all.find("roma: nobody reads 'roma.tracer'"), std::string::npos) << all;
    EXPECT_NE(all.find("bom: "), std::string::npos) << all;
    for (const PlanPass& pass : made.plan().passes) EXPECT_NE(pass.type, "OccupancyMap");
}

TEST_F(Ao, ABoundedDistanceSeesMore) {
    const Scene scene = loadScene("builtin:blob?detail=0.02");
    const Image mask = coverage(scene);
    const double bounded = meanWhere(visibility(scene, {"ao.tracer=bvh.tracer", "ao.distance=0.1"}, 8), mask);
    const double unbounded = meanWhere(visibility(scene, byBvh, 8), mask);
    EXPECT_GT(bounded, unbounded + 0.01);
}

} // namespace
} // namespace kestrel::test
