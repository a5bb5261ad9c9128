// No ray leaves below the face that it starts on, where normals lean away from it.
#include "ray_effects_fixture.h"
#include <cmath>

namespace kestrel::test {
namespace {

using Settings = std::vector<std::string>;
const PortRef horizonCoverage{"gbuffer", "coverage"}, gathered{"gather", "result"};

// Normals that the triangles do not have.
Scene withNormals(std::vector<glm::vec3> corners, const std::function<glm::vec3(const glm::vec3&)>& normal) {
    Scene scene = trianglesScene(std::move(corners));
    Primitive& primitive = scene.meshes[0].primitives[0];
    for (size_t i = 0; i < primitive.positions.size(); ++i)
        primitive.normals[i] = normal(primitive.positions[i]);
    scene.materials[0].metallic = 0;
    scene.materials[0].roughness = 0.4f;
    finishScene(scene);
    return scene;
}

// ball()'s triangles look inwards.
glm::vec3 roundNormal(const glm::vec3& p) { return -glm::normalize(p); }

void addSun(Scene& scene) {
    Light sun;
    sun.kind = LightKind::Directional;
    sun.intensity = 3;
    addLightTo(scene, sun, {0, 0, 0}, downwards);
    finishScene(scene);
}

struct Horizon : EffectsTest {};

// Of the cosine-weighted hemisphere around a normal that leans by 60 degrees the share (1 + cos 60) / 2 is
// above the face.
TEST_F(Horizon, ALeaningNormalSeesWhatIsAboveTheFace) {
    const glm::vec3 leaning(std::sqrt(0.75f), 0, 0.5f);
    const Scene scene = withNormals(square(), [&](const glm::vec3&) { return leaning; });
    const Settings settings = {"sky.colour=[0.5,1,4]", "indirect.radiance=sky.radiance"};
    const auto images = run(effectsGraph({bounce, skyVisible, horizonCoverage}, settings), scene,
                            {bounce, skyVisible, horizonCoverage}, 16, lookingAt({1.5f, 0, 2.6f}, {0, 0, 0}));
    double sky = 0, open = 0, count = 0;
    for (int y = 0; y < images[0].height; ++y)
        for (int x = 0; x < images[0].width; ++x) {
            if (!(images[2].at(x, y) > 0)) continue;
            sky += images[0].at(x, y, 2);
            open += images[1].at(x, y);
            count += 1;
        }
    ASSERT_GT(count, 50);
    EXPECT_NEAR(sky / count, 4 * 0.75, 4 * 0.002);
    EXPECT_NEAR(open / count, 0.75, 0.002);
}

TEST_F(Horizon, AConvexBodyAloneReceivesExactlyNothingOfItsOwnLight) {
    Scene scene = withNormals(ball(1, 5), roundNormal);
    addSun(scene);
    for (const auto& settings :
         {Settings(), Settings({"indirect.radiance=rsm.radiance", "rsm.directional=true"})}) {
        const std::vector<PortRef> ports = {bounce, shine, gathered};
        const auto images =
            run(effectsGraph(ports, settings), scene, ports, 4, lookingAt({1, 2, 3}, {0, 0, 0}));
        for (size_t i = 0; i < images.size(); ++i)
            for (int y = 0; y < images[i].height; ++y)
                for (int x = 0; x < images[i].width; ++x)
                    for (int k = 0; k < 3; ++k) ASSERT_EQ(images[i].at(x, y, k), 0.0f) << i;
    }
    // By the normals alone it does: that is what the faces are for.
    Graph graph = effectsGraph({bounce});
    std::erase_if(graph.edges, [](const GraphEdge& edge) { return edge.to.port == "face_normal"; });
    const Image without = run(graph, scene, {bounce}, 4, lookingAt({1, 2, 3}, {0, 0, 0}))[0];
    double sum = 0;
    for (const float value : without.values) sum += double{value};
    EXPECT_GT(sum, without.width * without.height); // alpha is 1
}

// At every pixel of a coarse smooth ball, beside edges too, the sky is open where the face and the normal see
// it: the share (1 + n.f) / 2.
TEST_F(Horizon, OcclusionBesideConvexEdgesIsTheFacesOwn) {
    const Scene scene = withNormals(ball(1, 4), roundNormal);
    const PortRef normal{"gbuffer", "normal"}, face{"gbuffer", "face_normal"};
    const std::vector<PortRef> ports = {skyVisible, normal, face};
    const auto images = run(effectsGraph(ports), scene, ports, 64, lookingAt({1, 2, 3}, {0, 0, 0}));
    int count = 0;
    double lowest = 1;
    for (int y = 0; y < images[0].height; ++y)
        for (int x = 0; x < images[0].width; ++x) {
            double cosine = 0;
            for (int k = 0; k < 3; ++k)
                cosine += double{images[1].at(x, y, k)} * double{images[2].at(x, y, k)};
            if (!(cosine > 0)) continue;
            ++count;
            lowest = std::min(lowest, cosine);
            ASSERT_NEAR(images[0].at(x, y), 0.5 * (1 + cosine), 0.01) << x << ", " << y;
        }
    EXPECT_GT(count, 100);
    EXPECT_LT(lowest, 0.95);
}

TEST_F(Horizon, LightFromBelowTheFaceIsShadowedByTheSurface) {
    const glm::vec3 leaning(std::sqrt(0.75f), 0, 0.5f);
    Scene scene = withNormals(square(), [&](const glm::vec3&) { return leaning; });
    Light lamp;
    lamp.kind = LightKind::Sphere;
    lamp.intensity = 5;
    lamp.halfSize.x = 0.2f;
    addLightTo(scene, lamp, {4, 0, -1}, {1, 0, 0, 0});
    finishScene(scene);
    const std::vector<PortRef> ports = {shadowed, openness, horizonCoverage};
    const auto images = run(effectsGraph(ports), scene, ports, 2, lookingAt({1.5f, 0, 2.6f}, {0, 0, 0}));
    int count = 0;
    for (int y = 0; y < images[0].height; ++y)
        for (int x = 0; x < images[0].width; ++x) {
            if (!(images[2].at(x, y) > 0)) continue;
            ++count;
            ASSERT_EQ(images[0].at(x, y, 0), 0.0f);
            ASSERT_EQ(images[1].at(x, y), 0.0f);
        }
    EXPECT_GT(count, 50);
}

// A box on a ground; what is under it and beside it must not see how far the ground goes.
TEST_F(Horizon, AGroundOfTwoHundredKilometresChangesNoContact) {
    const auto scene = [](float half) {
        std::vector<glm::vec3> corners = parallelogram({-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0});
        for (int axis = 0; axis < 3; ++axis)
            for (const float side : {0.0f, 1.0f}) {
                glm::vec3 corner(-0.5f, 0, -0.5f), u(0), v(0);
                corner[axis] += side;
                u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
                corners = joined(corners, parallelogram(corner, u, v));
            }
        return trianglesScene(corners);
    };
    const CameraState camera = lookingAt({2, 0.8f, 2.5f}, {0, -0.3f, 0}); // of a scene of height 1 around 0
    const PortRef embree{"reference", "visibility"};
    for (const bool faces : {true, false}) // also where nothing tells the faces
        for (const bool reference : {true, false}) {
            if (reference && !hasReferences()) continue;
            const PortRef port = reference ? embree : skyVisible;
            Graph graph = reference ? shippedGraph("reference_ao") : effectsGraph({port});
            if (!faces)
                std::erase_if(graph.edges,
                              [](const GraphEdge& edge) { return edge.to.port == "face_normal"; });
            const int frames = reference ? 1 : 16;
            const Image near = run(graph, scene(10), {port}, frames, camera)[0];
            const Image far = run(graph, scene(100'000), {port}, frames, camera)[0];
            double dark = 1, sum = 0;
            for (size_t i = 0; i < near.values.size(); ++i) {
                dark = std::min(dark, double{near.values[i]});
                sum += std::abs(double{near.values[i]} - double{far.values[i]});
            }
            EXPECT_LT(dark, 0.6) << reference; // the contact
            // Rasterized points of triangles of 200 km lie millimetres beside where they ought to: the
            // contact moves by as much.
            EXPECT_LT(sum / static_cast<double>(near.values.size()), reference ? 0.006 : 0.01) << reference;
        }
}

} // namespace
} // namespace kestrel::test
