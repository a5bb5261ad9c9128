// What is far away changes no shadow near the eye.
#include "lighting_fixture.h"
#include "ray_effects_fixture.h"
#include "scene/setup.h"

namespace kestrel::test {
namespace {

// A ground in sun, on which a box stands and over which a bar hangs.
Scene sunlitBox(float half) {
    std::vector<glm::vec3> corners = parallelogram({-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0});
    const auto addBox = [&](const glm::vec3& low, const glm::vec3& size) {
        for (int axis = 0; axis < 3; ++axis)
            for (const float side : {0.0f, 1.0f}) {
                glm::vec3 corner = low, u(0), v(0);
                corner[axis] += side * size[axis];
                u[(axis + 1) % 3] = size[(axis + 1) % 3];
                v[(axis + 2) % 3] = size[(axis + 2) % 3];
                corners = joined(corners, parallelogram(corner, u, v));
            }
    };
    addBox({-0.5f, 0, -0.5f}, {1, 1, 1});
    addBox({-1.5f, 1.4f, 0.2f}, {0.1f, 0.1f, 1.2f});
    Scene scene = trianglesScene(corners);
    scene.materials[0].metallic = 0;
    SceneSetup setup;
    setup.camera = parseCamera("eye=2.4,1.6,3 target=-0.3,0.4,0 fov=45", "test");
    setup.lights = {parseLight("directional direction=0.9,-1,0.4 intensity=3", "test")};
    setUpScene(scene, setup, {});
    return scene;
}

struct Far : ShippedTest {};

TEST_F(Far, AGroundOfTwoHundredKilometresChangesNoShadowInTheSun) {
    Graph graph = directGraph();
    applySetting(graph, shipped(), "direct.face_normal=g.face_normal");
    const PortRef port{"direct", "result"}, coverage{"g", "coverage"};
    graph.outputs.push_back({coverage, {}});
    const auto images = [&](float half) {
        Renderer made = renderer(graph, sunlitBox(half), {}, {320, 180, 1});
        made.frame();
        return std::pair(made.read(port), made.read(coverage));
    };
    const auto [near, covered] = images(6);
    const Image far = images(100'000).first;
    // Shadow or light where a pixel and its neighbours are alike by the ground of six metres, whose map has
    // texels of a centimetre and a half.
    int lit = 0, shadow = 0, other = 0;
    for (int y = 1; y + 1 < 180; ++y)
        for (int x = 1; x + 1 < 320; ++x) {
            bool alike = true;
            for (int v = -1; v <= 1; ++v)
                for (int u = -1; u <= 1; ++u)
                    alike = alike && covered.at(x + u, y + v) > 0 &&
                            (near.at(x + u, y + v, 0) < 0.1f) == (near.at(x, y, 0) < 0.1f);
            if (!alike) continue;
            const bool dark = near.at(x, y, 0) < 0.1f;
            ++(dark ? shadow : lit);
            other += (far.at(x, y, 0) < 0.1f) != dark;
        }
    EXPECT_GT(shadow, 5000);
    EXPECT_GT(lit, 10'000);
    EXPECT_LT(other, 20);
}

// One bounce of the sun through a reflective shadow map, and gathered from it: the wall of the box lights the
// ground beside it.
TEST_F(Far, AGroundOfTwoHundredKilometresChangesNoBounceOfTheSun) {
    const PortRef gathered{"gather", "result"}, coverage{"gbuffer", "coverage"};
    const Graph graph = effectsGraph({bounce, gathered, coverage}, {"indirect.radiance=rsm.radiance"});
    const auto images = [&](float half) {
        Renderer made = renderer(graph, sunlitBox(half), {}, {96, 54, 1});
        for (int i = 0; i < 8; ++i) made.frame();
        return std::array{made.read(bounce), made.read(gathered), made.read(coverage)};
    };
    const auto near = images(6), far = images(100'000);
    for (size_t kind = 0; kind < 2; ++kind) {
        double sum = 0, other = 0, square = 0, count = 0;
        for (int y = 27; y < 54; ++y)
            for (int x = 0; x < 96; ++x) {
                if (!(near[2].at(x, y) > 0)) continue;
                sum += double{near[kind].at(x, y, 0)};
                other += double{far[kind].at(x, y, 0)};
                square += std::pow(double{near[kind].at(x, y, 0)} - double{far[kind].at(x, y, 0)}, 2);
                count += 1;
            }
        const double mean = sum / count;
        EXPECT_GT(mean, 0.005) << kind;
        // The wide ground goes on and the map's texels are others: 0.06 and 0.02 measured.
        EXPECT_NEAR(other / sum, 1, 0.12) << kind;
        if (kind == 0) { // 0.26, most of it noise
            EXPECT_LT(std::sqrt(square / count), 0.35 * mean);
        }
    }
}

// As the camera goes, the smaller maps go with it, and nothing else changes.
TEST_F(Far, TheSmallerMapsFollowTheCamera) {
    Graph graph = directGraph();
    Renderer made = renderer(graph, sunlitBox(100'000), {}, {160, 90, 1});
    const PortRef port{"direct", "result"};
    made.frame();
    const Image before = made.read(port);
    made.setFreeCamera(lookingAt({1e3f, 1.6f, 1e3f}, {1e3f, 0.4f, 1e3f - 3})); // the empty ground
    made.frame();
    const Image ground = made.read(port);
    for (int x = 0; x < 160; x += 7) EXPECT_GT(ground.at(x, 88, 0), 0.1f);
    made.setFreeCamera({});
    made.frame();
    EXPECT_EQ(made.read(port).values, before.values);
}

} // namespace
} // namespace kestrel::test
