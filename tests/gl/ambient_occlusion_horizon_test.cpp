// Ambient occlusion by horizons and bitmasks, against planes that are open and rays in a corner that a camera
// sees whole.
#include "ray_effects_fixture.h"

namespace kestrel::test {
namespace {

struct Horizons : ShippedTest {
    static Graph graph(const std::vector<std::string>& settings) {
        Graph made = parseGraph(R"({"kestrel": 1, "passes": {
            "gbuffer": {"type": "GBuffer"}, "bvh": {"type": "Bvh"},
            "rays": {"type": "RayAmbientOcclusion", "properties": {"rays": 256, "distance": 0.5}},
            "horizons": {"type": "HorizonAmbientOcclusion", "properties": {"slices": 16, "steps": 32}}},
            "edges": [["gbuffer.view_depth", "horizons.view_depth"], ["gbuffer.normal", "horizons.normal"],
                ["gbuffer.depth", "rays.depth"], ["gbuffer.normal", "rays.normal"], ["bvh.tracer", "rays.tracer"]],
            "outputs": ["horizons.visibility", "rays.visibility", "gbuffer.coverage"]})",
                                "test.json");
        for (const std::string& setting : settings) applySetting(made, shipped(), setting);
        return made;
    }
    static std::vector<Image> seen(const std::vector<glm::vec3>& corners, const CameraState& camera,
                                   const std::vector<std::string>& settings) {
        RenderOptions options;
        options.checkFinite = true;
        Renderer made = renderer(graph(settings), trianglesScene(corners), options, {96, 64, 1});
        made.setFreeCamera(camera);
        made.frame();
        return {made.read({"horizons", "visibility"}), made.read({"rays", "visibility"}),
                convertChannels(made.read({"gbuffer", "coverage"}), 1)};
    }
};

TEST_F(Horizons, OpenPlanesAreOpen) {
    for (const char* method : {"gtao", "bitmask"})
        for (const float degrees : {0.0f, 30.0f, 70.0f}) {
            const glm::mat3 turn(glm::rotate(glm::mat4(1), glm::radians(degrees), glm::vec3(0.3f, 1, 0)));
            const auto images = seen(square(turn), lookingAt({0, 0, 2.5f}, {0, 0, 0}),
                                     {fmt::format("horizons.method={}", method)});
            // Pixel centres lie beside a slice: of a steep plane they tell of a little more or less than is
            // there.
            EXPECT_GT(meanWhere(images[0], images[2]), 0.98) << method << " " << degrees;
        }
}

// Floor and wall: what the camera sees is all that occludes, and as thick as can be.
TEST_F(Horizons, ACornerIsAsRaysHaveIt) {
    const auto corner = joined(parallelogram({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}),
                               parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}));
    const CameraState camera = lookingAt({0, 0.4f, 2.2f}, {0, -0.4f, 0});
    const auto mask = seen(corner, camera, {"horizons.method=bitmask", "horizons.thickness=100"});
    EXPECT_LE(difference(mask[0], mask[1]).rms, 0.03);
    EXPECT_LT(meanWhere(mask[1], mask[2]), 0.97); // the radius is a fourth of the walls
    // Horizons that sink toward the radius take less.
    const auto gtao = seen(corner, camera, {});
    EXPECT_GT(meanWhere(gtao[0], gtao[2]), meanWhere(gtao[1], gtao[2]));
    EXPECT_LE(difference(gtao[0], gtao[1]).rms, 0.1);
}

// A strip that floats before a wall: thin, it lets light by that the highest horizon stops.
TEST_F(Horizons, LightPassesBehindWhatIsThin) {
    const auto scene = joined(parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}),
                              parallelogram({-1, -0.05f, 0.25f}, {2, 0, 0}, {0, 0.1f, 0}));
    const CameraState camera = lookingAt({0, 0, 3}, {0, 0, 0});
    double before = 0;
    for (const char* thickness : {"1", "0.1", "0.01"}) {
        const auto images =
            seen(scene, camera, {"horizons.method=bitmask", fmt::format("horizons.thickness={}", thickness)});
        const double mean = meanWhere(images[0], images[2]);
        EXPECT_GT(mean, before) << thickness;
        before = mean;
        if (std::string(thickness) == "0.01") {
            EXPECT_LE(difference(images[0], images[1]).rms, 0.06);
        }
    }
}

} // namespace
} // namespace kestrel::test
