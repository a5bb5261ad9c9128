// Ambient occlusion: analytic truth, then the reference ray tracer, then what leaving out must not change.
#include "image/error_figures.h"
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
        EXPECT_GE(meanWhere(visibility(scene, {"roma.offset=1.5"}, 32), mask), 0.995)
            << "ROMA, tilted by " << degrees;
        // Two thirds of a cell off the surface, where the mean error of scenes is least, a plane of two sides
        // meets itself: measured 0.879 for one between two layers of cells, which both hold it, and 0.904 and
        // more at other tilts, where cells over each other do; where cells are rasterized 0.97.
        EXPECT_GE(meanWhere(visibility(scene, {}, 32), mask), degrees == 0 ? 0.87 : 0.895)
            << "ROMA, tilted by " << degrees;
        EXPECT_GE(meanWhere(visibility(scene, {"bom.method=three_axis"}, 32), mask),
                  degrees == 0 ? 0.87 : 0.97)
            << "ROMA, tilted by " << degrees;
    }
}

// What a rectangle with these corners takes of the sky over a point with normal y: Lambert's formula.
double rectangleFactor(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& p) {
    double sum = 0;
    for (size_t i = 0; i < 4; ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - p), b = glm::normalize(corners[(i + 1) % 4] - p);
        sum += std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)) * glm::normalize(glm::cross(a, b)).y;
    }
    return std::abs(sum) / (2 * glm::pi<double>());
}

// A strip of floor at the foot of a wall that takes nearly half of its sky.
TEST_F(Ao, BesideAWallThereIsHalfASky) {
    const float height = 8, length = 16, width = 1;
    std::vector<glm::vec3> corners;
    const auto add = [&corners](const glm::vec3& at, const glm::vec3& u, const glm::vec3& v) {
        for (const glm::vec3& p : {at, at + u, at + u + v, at, at + u + v, at + v}) corners.push_back(p);
    };
    add({0, 0, -length / 2}, {0, 0, length}, {width, 0, 0});
    add({0, 0, -length / 2}, {0, height, 0}, {0, 0, length});
    const Scene scene = trianglesScene(corners);
    const glm::dvec3 middle(width / 2, height / 2, 0); // what render space counts from
    std::array<glm::dvec3, 4> wall{
        glm::dvec3(0, 0, -length / 2), {0, height, -length / 2}, {0, height, length / 2}, {0, 0, length / 2}};
    for (glm::dvec3& corner : wall) corner -= middle;
    const glm::vec3 target = -glm::vec3(middle) + glm::vec3(width / 2, 0, 0),
                    eye = target + glm::vec3(0, 2, 0);
    const double cell = std::sqrt(width * width + height * height + length * length) / 128;
    const auto errors = [&](const std::vector<std::string>& settings) {
        Graph graph = shippedGraph("ray_ao", settings);
        graph.outputs.push_back({{"gbuffer", "position"}, {}});
        Renderer made = renderer(graph, scene);
        made.setFreeCamera(CameraState{.view = glm::lookAt(eye, target, glm::vec3(1, 0, 0)),
                                       .position = eye,
                                       .nearPlane = 0.1f,
                                       .farPlane = 0});
        for (int i = 0; i < 64; ++i) made.frame();
        const Image seen = made.read(mean), position = made.read({"gbuffer", "position"});
        double bias = 0, squares = 0, level = 0, count = 0;
        for (int y = 0; y < seen.height; ++y)
            for (int x = 0; x < seen.width; ++x) {
                const glm::dvec3 p(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2));
                const bool floor = position.at(x, y, 3) > 0 && std::abs(p.y - target.y) < 1e-3;
                // Nearer than two cells the map does not tell the wall from the floor.
                if (!floor || p.x + middle.x < 2 * cell) continue;
                const double expected = 1 - rectangleFactor(wall, p);
                level += expected;
                bias += double{seen.at(x, y)} - expected;
                squares += std::pow(double{seen.at(x, y)} - expected, 2);
                ++count;
            }
        EXPECT_GT(count, 100);
        EXPECT_NEAR(level / count, 0.5, 0.06);
        return std::pair{bias / count, std::sqrt(squares / count)};
    };
    // 64 independent rays of a fair coin: 1/16; a stratified sequence stays well below (measured 0.008).
    const auto [exactBias, exactNoise] = errors(byBvh);
    EXPECT_LE(std::abs(exactBias), 0.001);
    EXPECT_LE(exactNoise, 0.012);
    // Measured: 0.004 to 0.006 too dark in the mean, 0.025 to 0.031 by pixels.
    for (const auto& settings : {std::vector<std::string>{"bom.method=exact"},
                                 {"bom.method=exact", "roma.angular=8"},
                                 {"bom.method=exact", "roma.offset=1.5"}}) {
        const auto [bias, noise] = errors(settings);
        EXPECT_LE(std::abs(bias), 0.01) << settings.back();
        EXPECT_LE(noise, 0.04) << settings.back();
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

// The scene that is hardest for a map of cells: thin treads and balusters, many of them.
TEST_F(Ao, OnTheTowerRomaStaysAsNearEmbreeAsItWasMeasured) {
    if (shipped().find("ReferenceAmbientOcclusion") == nullptr) GTEST_SKIP() << "Embree is not built in";
    const Scene scene = loadScene("builtin:tower?detail=0.3");
    const Extent size{160, 90, 1};
    Renderer truth = renderer(shippedGraph("reference_ao", {"reference.samples=256"}), scene, {}, size);
    truth.frame();
    const Image reference = truth.read({"reference", "visibility"}),
                mask = convertChannels(truth.read({"gbuffer", "coverage"}), 1);
    const auto flip = [&](const std::vector<std::string>& settings) {
        const Image picture = render(shippedGraph("ray_ao", settings), scene, mean, 16, {}, size);
        return measureError(reference, picture, {.mask = &mask}).flip.mean;
    };
    // Measured 0.2226 (0.1940 where cells are rasterized along three axes), and 0.0882 by the BVH. Another
    // driver's rounding moves single rays at edges, which is a hundredth of either; a map whose one-sided
    // surfaces are not set back has 0.2678 and must not pass.
    EXPECT_NEAR(flip({}), 0.2226, 0.003);
    EXPECT_NEAR(flip(byBvh), 0.0882, 0.002);
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
