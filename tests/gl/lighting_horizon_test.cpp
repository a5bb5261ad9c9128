// Direct light on surfaces whose normals lean away from their faces: nothing arrives from below a face.
#include "lighting_fixture.h"
#include "ray_effects_fixture.h"

namespace kestrel::test {
namespace {

const glm::vec3 leaning(std::sqrt(0.75f), 0, 0.5f); // by 60 degrees from a face along +z

Graph horizonGraph(const std::string& properties = R"("shadows": false)") {
    Graph graph = directGraph(properties);
    applySetting(graph, shipped(), "direct.face_normal=g.face_normal");
    return graph;
}

struct DirectHorizon : LightingTest {
    static Scene leaningSquare(const std::vector<PlacedLight>& lights) {
        Scene scene = litScene(square(), lights);
        for (glm::vec3& normal : scene.meshes[0].primitives[0].normals) normal = leaning;
        finishScene(scene);
        return scene;
    }
    // Holds `result` / pi against the mean, over a light's area, of what its pieces bring: those above both
    // horizons.
    static void
    expectSum(const Scene& scene, const std::function<glm::vec3(float, float)>& piece,
              const std::function<float(const glm::vec3& point, const glm::vec3& toPiece)>& brings) {
        const Image image = picture(horizonGraph(), scene);
        constexpr int n = 200;
        int cut = 0;
        for (int y = 4; y < 64; y += 11)
            for (int x = 4; x < 64; x += 11) {
                const glm::vec3 point = squarePoint(image, x, y);
                double sum = 0;
                int below = 0;
                for (int i = 0; i < n; ++i)
                    for (int j = 0; j < n; ++j) {
                        const glm::vec3 to =
                            piece((static_cast<float>(i) + 0.5f) / n, (static_cast<float>(j) + 0.5f) / n) -
                            point;
                        if (to.z <= 0) ++below;
                        if (to.z > 0 && glm::dot(to, leaning) > 0) sum += double{brings(point, to)};
                    }
                cut += below > 0 && below < n * n;
                const double expected = sum / (n * n) / glm::pi<double>();
                ASSERT_NEAR(image.at(x, y, 0), expected, 0.01 * expected + 2e-4) << x << ", " << y;
            }
        EXPECT_GT(cut, 5) << "the plane of the face cuts the light";
    }
};

TEST_F(DirectHorizon, ALampBelowTheFaceLightsNothing) {
    for (const LightKind kind :
         {LightKind::Point, LightKind::Spot, LightKind::Directional, LightKind::Rectangle, LightKind::Sphere})
        for (const float height : {-0.01f, 0.01f}) { // of the lamp over the plane, far to the side
            Light light = lightOf(kind, 100);
            light.halfSize = glm::vec2(0.005f);
            light.outerCone = 0.5f;
            const glm::vec3 at(4, 0, height);
            const Image image = picture(horizonGraph(), leaningSquare({{light, at, glm::normalize(-at)}}));
            for (int y = 0; y < 64; y += 7)
                for (int x = 0; x < 64; x += 7) {
                    if (height < 0) {
                        ASSERT_EQ(image.at(x, y, 0), 0.0f) << static_cast<int>(kind);
                    } else {
                        ASSERT_GT(image.at(x, y, 0), 0.0f) << static_cast<int>(kind);
                    }
                }
        }
    // Without the faces the normals let it through.
    const Scene scene = leaningSquare({{lightOf(LightKind::Point, 100), {4, 0, -0.01f}, {-1, 0, 0}}});
    EXPECT_GT(picture(directGraph(R"("shadows": false)"), scene).at(32, 32, 0), 1);
}

TEST_F(DirectHorizon, ARectangleThatTheFaceCutsCountsByItsUpperPart) {
    Light light = lightOf(LightKind::Rectangle, 3);
    light.halfSize = {0.5f, 0.8f};
    const glm::vec3 at(1.5f, 0.2f, 0.1f), ahead = glm::normalize(glm::vec3(-1, 0, -0.1f));
    const Scene scene = leaningSquare({{light, at, ahead}});
    const LightState state = lightsAt(scene, 0)[0];
    expectSum(
        scene,
        [&](float u, float v) {
            return at + (2 * u - 1) * 0.5f * state.tangent + (2 * v - 1) * 0.8f * state.bitangent;
        },
        [&](const glm::vec3&, const glm::vec3& to) {
            const float d2 = glm::dot(to, to);
            return 3 * 4 * 0.4f * glm::dot(to, leaning) * std::max(0.0f, -glm::dot(ahead, to)) / (d2 * d2);
        });
}

TEST_F(DirectHorizon, ASphereThatTheFaceCutsCountsByItsUpperPart) {
    Light light = lightOf(LightKind::Sphere, 3);
    light.halfSize.x = 0.4f;
    const glm::vec3 at(1.6f, -0.1f, 0.05f);
    // Pieces of equal height of the whole sphere; those that look away bring nothing.
    expectSum(
        leaningSquare({{light, at, {0, 0, -1}}}),
        [&](float u, float v) {
            const float z = 2 * u - 1, r = std::sqrt(1 - z * z), phi = 2 * pi * v;
            return at + 0.4f * glm::vec3(r * std::cos(phi), r * std::sin(phi), z);
        },
        [&](const glm::vec3& point, const glm::vec3& to) {
            const glm::vec3 outward = (point + to - at) / 0.4f;
            const float d2 = glm::dot(to, to);
            return 3 * 4 * pi * 0.16f * glm::dot(to, leaning) * std::max(0.0f, -glm::dot(outward, to)) /
                   (d2 * d2);
        });
}

// A coarse ball with smooth normals: every facet is lit where the sun stands over its plane, also just so.
TEST_F(DirectHorizon, FacetsOfAConvexBodyAreLitWhereTheLightStandsOverThem) {
    Scene scene = litScene(ball(0.9f, 5), {{lightOf(LightKind::Directional, 2), {}, {-1, 0.3f, -0.47f}}});
    Primitive& primitive = scene.meshes[0].primitives[0];
    for (size_t i = 0; i < primitive.positions.size(); ++i)
        primitive.normals[i] = -glm::normalize(primitive.positions[i]); // ball()'s triangles look inwards
    finishScene(scene);
    Graph graph = horizonGraph();
    const PortRef result{"direct", "result"}, normal{"g", "normal"}, face{"g", "face_normal"};
    for (const PortRef& port : {normal, face}) graph.outputs.push_back({port, {}});
    auto made = lit(graph, scene);
    made.frame();
    const Image light = made.read(result), normals = made.read(normal), faces = made.read(face);
    const glm::vec3 toSun = -glm::normalize(glm::vec3(-1, 0.3f, -0.47f));
    int hidden = 0, bright = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const glm::vec3 n = pixelColour(normals, x, y), f = pixelColour(faces, x, y);
            if (n == glm::vec3(0)) continue;
            const float cosine = glm::dot(glm::normalize(n), toSun);
            const bool leaves = glm::dot(f, toSun) > 1e-6f;
            hidden += cosine > 0.02f && !leaves;
            bright += leaves;
            const float expected = leaves ? 2 * std::max(0.0f, cosine) / pi : 0;
            ASSERT_NEAR(light.at(x, y, 0), expected, 1e-3f) << x << ", " << y;
            if (!leaves) {
                ASSERT_EQ(light.at(x, y, 0), 0.0f) << x << ", " << y;
            }
        }
    EXPECT_GT(hidden, 10) << "facets that the normals alone would light";
    EXPECT_GT(bright, 300);
}

// What glows in a rectangle's place stands a ten-thousandth before it, as after a file was quantized.
TEST_F(DirectHorizon, APanelDoesNotShadowTheLightThatItStandsFor) {
    Light light = lightOf(LightKind::Rectangle, 3);
    light.halfSize = {0.5f, 0.4f};
    const std::vector<PlacedLight> lights = {{light, {0, 0, 0.8f}, {0, 0, -1}}};
    const Image alone = picture(
        directGraph(), litScene(join(square(), quad({0, 0, -0.8f}, {0.1f, 0, 0}, {0, 0.1f, 0})), lights));
    const Image behind = picture(
        directGraph(), litScene(join(square(), quad({0, 0, 0.7999f}, {0.5f, 0, 0}, {0, 0.4f, 0})), lights));
    EXPECT_GT(alone.at(10, 32, 0), 0.1f);
    for (int y = 0; y < 64; y += 9)
        EXPECT_NEAR(behind.at(5, y, 0), alone.at(5, y, 0), 1e-3f * alone.at(5, y, 0));
}

// Area lights on the same body, by the reference: alone it casts no shadow, only its horizons count.
TEST_F(DirectHorizon, AreaLightsOnAConvexBodyAreThoseOfTheReference) {
    if (!hasReferences()) GTEST_SKIP() << "Embree is not built in";
    for (const LightKind kind : {LightKind::Rectangle, LightKind::Sphere}) {
        Light light = lightOf(kind, 3);
        light.halfSize = {0.5f, 0.4f};
        Scene scene = litScene(ball(0.9f, 5), {{light, {1.6f, 0.3f, 0.8f}, {-1, -0.2f, -0.5f}}});
        Primitive& primitive = scene.meshes[0].primitives[0];
        for (size_t i = 0; i < primitive.positions.size(); ++i)
            primitive.normals[i] = -glm::normalize(primitive.positions[i]);
        finishScene(scene);
        const Image direct = picture(horizonGraph(), scene);
        const PortRef reference{"shadow", "result"};
        const Image truth = picture(embreeGraph({reference}), scene);
        double square = 0, sum = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                square += std::pow(double{direct.at(x, y, 0)} - double{truth.at(x, y, 0)}, 2);
                sum += double{truth.at(x, y, 0)};
            }
        const double mean = sum / (64 * 64);
        EXPECT_GT(mean, 0.01);
        // The noise of the reference, and facets where both horizons cut the light: 0.014 and 0.024 measured.
        EXPECT_LT(std::sqrt(square / (64 * 64)), 0.03 * mean) << static_cast<int>(kind);
    }
}

} // namespace
} // namespace kestrel::test
