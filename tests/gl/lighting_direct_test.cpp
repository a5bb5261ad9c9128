// Direct light: closed forms and sums over areas, edges of shadows, what is left out, extreme cases.
#include "lighting_fixture.h"
#include "support/temporary_folder.h"

namespace kestrel::test {
namespace {

struct DirectLightTest : LightingTest {
    // Holds `result` against irradiance / pi at every `step`-th pixel; true values below `least` are not
    // asked for relatively.
    static void expectIrradiance(const Image& image, const std::function<float(const glm::vec3&)>& truth,
                                 float tolerance, int step = 5) {
        float largest = 0;
        for (int y = 0; y < image.height; y += step)
            for (int x = 0; x < image.width; x += step)
                largest = std::max(largest, truth(squarePoint(image, x, y)));
        ASSERT_GT(largest, 0);
        for (int y = 0; y < image.height; y += step)
            for (int x = 0; x < image.width; x += step) {
                const float expected = truth(squarePoint(image, x, y)) / pi;
                ASSERT_NEAR(image.at(x, y, 1), expected, tolerance * std::max(expected, 0.01f * largest))
                    << "at " << x << ", " << y;
            }
    }
    // Irradiance at a point of the plane z = 0 from a patch of radiance 1, by its middle.
    static float patch(const glm::vec3& point, const glm::vec3& from, const glm::vec3& normal, float area) {
        const glm::vec3 to = from - point;
        const float d2 = glm::dot(to, to);
        return std::max(0.0f, to.z) * std::max(0.0f, -glm::dot(normal, to)) * area / (d2 * d2);
    }
};

TEST_F(DirectLightTest, APointLightIsIntensityTimesCosineOverDistanceSquared) {
    const glm::vec3 at(0.3f, -0.2f, 0.7f);
    const Scene scene = litScene(square(), {{lightOf(LightKind::Point, 5), at, {0, 0, -1}}});
    expectIrradiance(
        picture(directGraph(), scene),
        [&](const glm::vec3& p) {
            const glm::vec3 to = at - p;
            return 5 * to.z / std::pow(glm::length(to), 3.0f);
        },
        1e-4f);
}

TEST_F(DirectLightTest, ARangeEndsAPointLightSmoothly) {
    const glm::vec3 at(0, 0, 0.5f);
    Light light = lightOf(LightKind::Point, 2);
    light.range = 1.1f;
    expectIrradiance(
        picture(directGraph(), litScene(square(), {{light, at, {0, 0, -1}}})),
        [&](const glm::vec3& p) {
            const float d = glm::length(at - p);
            return 2 * 0.5f / (d * d * d) * std::clamp(1 - std::pow(d / 1.1f, 4.0f), 0.0f, 1.0f);
        },
        2e-4f);
}

TEST_F(DirectLightTest, ASpotLightFallsOffBetweenItsCones) {
    const glm::vec3 at(0.2f, 0.1f, 1.2f), direction = glm::normalize(glm::vec3(0.1f, -0.2f, -1));
    Light light = lightOf(LightKind::Spot, 3);
    light.innerCone = 0.3f;
    light.outerCone = 0.6f;
    expectIrradiance(
        picture(directGraph(), litScene(square(), {{light, at, direction}})),
        [&](const glm::vec3& p) {
            const glm::vec3 to = at - p;
            const float d = glm::length(to);
            const float scale = 1 / (std::cos(0.3f) - std::cos(0.6f));
            const float share =
                std::clamp((glm::dot(direction, -to / d) - std::cos(0.6f)) * scale, 0.0f, 1.0f);
            return 3 * share * share * to.z / (d * d * d);
        },
        1e-3f);
}

TEST_F(DirectLightTest, ADirectionalLightIsLuxTimesCosine) {
    const glm::vec3 direction = glm::normalize(glm::vec3(1, 0.5f, -0.7f));
    expectIrradiance(
        picture(directGraph(),
                litScene(square(), {{lightOf(LightKind::Directional, 4), {0, 0, 2}, direction}})),
        [&](const glm::vec3&) { return -4 * direction.z; }, 1e-5f);
}

TEST_F(DirectLightTest, LightsOfAllKindsAdd) {
    std::vector<PlacedLight> lights = {{lightOf(LightKind::Directional, 1), {0, 0, 2}, {0, 0, -1}},
                                       {lightOf(LightKind::Point, 1), {0.5f, 0, 1}, {0, 0, -1}},
                                       {lightOf(LightKind::Point, 2), {-0.5f, 0, 1}, {0, 0, -1}},
                                       {lightOf(LightKind::Spot, 3), {0, 0.5f, 1}, {0, 0, -1}},
                                       {lightOf(LightKind::Point, 1), {0, 0.1f, 1}, {0, 0, -1}},
                                       {lightOf(LightKind::Rectangle, 1), {0, 0, 1}, {0, 0, -1}},
                                       {lightOf(LightKind::Sphere, 1), {0, 0, 1}, {0, 0, -1}}};
    lights[5].light.halfSize = {0.2f, 0.1f};
    lights[6].light.halfSize = {0.1f, 0};
    Image sum(64, 64, 4);
    for (const PlacedLight& light : lights) {
        const Image one = picture(directGraph(), litScene(square(), {light}));
        for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += one.values[i];
    }
    const Image all = picture(directGraph(), litScene(square(), lights));
    for (int y = 0; y < 64; y += 7)
        for (int x = 0; x < 64; x += 7)
            ASSERT_NEAR(all.at(x, y), sum.at(x, y), 1e-5f * sum.at(x, y) + 1e-6f) << x << ", " << y;
}

TEST_F(DirectLightTest, ARectangleIsTheSumOverItsArea) {
    // Above the plane, tilted; and upright on it, half of it below the horizon, shining along the plane.
    const std::pair<glm::vec3, glm::vec3> places[] = {{{0.1f, 0.2f, 0.6f}, {0.3f, 0.2f, -1}},
                                                      {{-0.6f, 0, 0.1f}, {1, 0, 0}}};
    for (const auto& [at, along] : places) {
        const glm::vec3 direction = glm::normalize(along);
        Light light = lightOf(LightKind::Rectangle, 2);
        light.halfSize = {0.3f, 0.2f};
        const Scene scene = litScene(square(), {{light, at, direction}});
        const LightState state = lightsAt(scene, 0).at(0);
        expectIrradiance(
            picture(directGraph("\"shadows\": false"), scene),
            [&](const glm::vec3& p) {
                constexpr int n = 200;
                double sum = 0;
                for (int i = 0; i < n; ++i)
                    for (int j = 0; j < n; ++j) {
                        const float u = (2 * static_cast<float>(i) + 1) / n - 1;
                        const float v = (2 * static_cast<float>(j) + 1) / n - 1;
                        sum += double{
                            patch(p, state.position + 0.3f * u * state.tangent + 0.2f * v * state.bitangent,
                                  direction, 4 * 0.3f * 0.2f / (n * n))};
                    }
                return static_cast<float>(2 * sum);
            },
            2e-3f, 9);
    }
}

TEST_F(DirectLightTest, ASphereIsTheSumOverItsSurface) {
    for (const float height : {0.5f, 0.1f, -0.1f}) { // above the horizon, and through it
        Light light = lightOf(LightKind::Sphere, 2);
        light.halfSize = {0.25f, 0};
        const glm::vec3 at(0.1f, 0, height);
        const Image image =
            picture(directGraph("\"shadows\": false"), litScene(square(), {{light, at, {0, 0, -1}}}));
        const auto truth = [&](const glm::vec3& p) {
            constexpr int n = 300;
            double sum = 0;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < 2 * n; ++j) {
                    const float z = (2 * static_cast<float>(i) + 1) / n - 1;
                    const float phi = pi * (static_cast<float>(j) + 0.5f) / n;
                    const float r = std::sqrt(1 - z * z);
                    const glm::vec3 out(r * std::cos(phi), r * std::sin(phi), z);
                    const glm::vec3 from = at + 0.25f * out;
                    const glm::vec3 to = from - p;
                    const float d2 = glm::dot(to, to);
                    sum += double{std::max(0.0f, to.z) * std::max(0.0f, -glm::dot(out, to)) / (d2 * d2)};
                }
            return static_cast<float>(2 * sum * (4 * pi * 0.25 * 0.25 / (2.0 * n * n)));
        };
        for (const glm::ivec2 pixel :
             {glm::ivec2(8, 20), glm::ivec2(20, 50), glm::ivec2(60, 31), glm::ivec2(24, 40)}) {
            const glm::vec3 p = squarePoint(image, pixel.x, pixel.y);
            if (glm::length(p - at) < 0.3f) continue;
            const float expected = truth(p) / pi;
            EXPECT_NEAR(image.at(pixel.x, pixel.y), expected, 0.01f * expected + 1e-4f)
                << height << " at " << pixel.x;
        }
    }
}

// A square of half width 0.25 at half the height of the light throws a shadow of half width 0.5; a
// directional light from straight above one of 0.25.
TEST_F(DirectLightTest, AShadowEndsWhereItShould) {
    for (const LightKind kind :
         {LightKind::Point, LightKind::Spot, LightKind::Directional, LightKind::Sphere}) {
        Light light = lightOf(kind, 3);
        light.innerCone = 0.9f;
        light.outerCone = 1.0f;
        light.halfSize = {1e-3f, 0};
        // A square below the plane keeps the middle of the bounds at the origin.
        std::vector<glm::vec3> corners = join(square(), quad({0, 0, 0.5f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
        corners = join(corners, quad({0, 0, -0.5f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
        const float edge = kind == LightKind::Directional ? 0.25f : 0.5f;
        for (const char* filter : {"nearest", "two", "four"}) {
            auto made = lit(directGraph(fmt::format(R"("filter": "{}")", filter)),
                            litScene(corners, {{light, {0, 0, 1}, {0, 0, -1}}}));
            // From below the occluder, so that it does not hide its shadow.
            CameraState camera = squareCamera();
            camera.view = glm::translate(glm::mat4(1), glm::vec3(0, 0, -0.45f));
            camera.position = glm::vec3(0, 0, 0.45f);
            made.setFreeCamera(camera);
            made.frame();
            const Image image = made.read({"direct", "result"});
            for (int y = 0; y < 64; ++y)
                for (int x = 0; x < 64; ++x) {
                    const glm::vec3 p = squarePoint(image, x, y);
                    const float reach = std::max(std::abs(p.x), std::abs(p.y));
                    if (std::abs(reach - edge) < 0.02f) continue;
                    if (reach < edge)
                        ASSERT_LE(image.at(x, y), 1e-6f)
                            << static_cast<int>(kind) << filter << x << ", " << y;
                    else
                        ASSERT_GT(image.at(x, y), 0) << static_cast<int>(kind) << filter << x << ", " << y;
                }
        }
    }
}

TEST_F(DirectLightTest, NoSurfaceShadowsItselfAtAnyTilt) {
    for (const LightKind kind : {LightKind::Point, LightKind::Spot, LightKind::Directional})
        for (const float tilt : {0.1f, 0.7f, 1.2f, 1.5f})
            for (const char* filter : {"nearest", "two", "four"}) {
                Light light = lightOf(kind, 1);
                light.innerCone = 0.9f;
                light.outerCone = 1.2f;
                const glm::vec3 direction(std::sin(tilt), 0.1f, -std::cos(tilt));
                const Scene scene = litScene(square(), {{light, -2.0f * direction, direction}});
                const auto shaded = [&](const char* shadows) {
                    return picture(
                        directGraph(fmt::format(R"("resolution": 256, "filter": "{}", "shadows": {})", filter,
                                                shadows)),
                        scene);
                };
                const Difference with = difference(shaded("true"), shaded("false"));
                EXPECT_EQ(with.largest, 0) << static_cast<int>(kind) << " at " << tilt << " by " << filter;
            }
}

TEST_F(DirectLightTest, TheModuleSaysWhatTheScreenShows) {
    std::vector<PlacedLight> lights = {{lightOf(LightKind::Point, 2), {0.5f, 0.1f, 1}, {0, 0, -1}},
                                       {lightOf(LightKind::Rectangle, 2), {0, 0, 1.5f}, {0, 0, -1}}};
    lights[1].light.halfSize = {0.2f, 0.2f};
    const glm::vec3 albedo(0.2f, 0.4f, 0.8f);
    std::vector<glm::vec3> corners = join(square(), quad({0, 0, 0.5f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
    corners = join(corners, quad({0, 0, -0.5f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
    const Scene scene = litScene(corners, lights, albedo);
    const Image direct = picture(directGraph(), scene);
    const Image probe = picture(probeGraph(R"("source": {"type": "DirectLight"})",
                                           R"(,["g.depth", "source.depth"], ["g.normal", "source.normal"])"),
                                scene);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(probe.at(x, y, c), albedo[c] * direct.at(x, y, c), 2e-3f * direct.at(x, y, c))
                    << x << ", " << y; // the albedo is stored as half floats
}

TEST_F(DirectLightTest, LeavesOutWhatTheSceneHasNot) {
    const auto point =
        lit(directGraph(), litScene(square(), {{lightOf(LightKind::Point, 1), {0, 0, 1}, {}}}));
    EXPECT_TRUE(leavesOut(point.plan(), "spot lights: the scene has none"));
    EXPECT_TRUE(leavesOut(point.plan(), "rectangle lights: the scene has none"));
    auto dark = lit(directGraph(), litScene(square(), {}));
    dark.frame();
    EXPECT_TRUE(leavesOut(dark.plan(), "lights: the scene has none"));
    for (const PlanStep& step : dark.plan().steps) EXPECT_NE(step.step.name, "shadows");
    const Image none = dark.read({"direct", "result"});
    for (int y = 0; y < none.height; ++y)
        for (int x = 0; x < none.width; ++x)
            ASSERT_EQ(glm::vec4(pixelColour(none, x, y), none.at(x, y, 3)), glm::vec4(0, 0, 0, 1));
}

TEST_F(DirectLightTest, AStaticSceneIsLitOnce) {
    RenderOptions options;
    options.timing = true;
    auto made = lit(directGraph(), litScene(square(), {{lightOf(LightKind::Spot, 1), {0, 0, 1}, {0, 0, -1}}}),
                    options);
    EXPECT_FALSE(made.frame().samples.empty());
    EXPECT_TRUE(made.frame().samples.empty());
}

TEST_F(DirectLightTest, ScaleDoesNotMatter) {
    std::vector<PlacedLight> lights = {{lightOf(LightKind::Point, 2), {0.5f, 0.1f, 1}, {0, 0, -1}},
                                       {lightOf(LightKind::Spot, 2), {-0.5f, 0.1f, 1}, {0, 0, -1}},
                                       {lightOf(LightKind::Directional, 1), {0, 0, 1}, {0.3f, 0.2f, -1}},
                                       {lightOf(LightKind::Rectangle, 2), {0, 0, 1.5f}, {0, 0, -1}},
                                       {lightOf(LightKind::Sphere, 2), {0, 0.4f, 1.5f}, {0, 0, -1}}};
    for (PlacedLight& light : lights) light.light.halfSize = {0.2f, 0.2f};
    std::vector<glm::vec3> corners = join(square(), quad({0, 0, 0.5f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
    corners = join(corners, quad({0, 0, -0.5f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
    const auto at = [&](float scale) {
        return picture(
            directGraph(),
            litScene(corners, lights, glm::vec3(0.5f), glm::scale(glm::dmat4(1), glm::dvec3(double{scale}))),
            1, scale);
    };
    const Image usual = at(1);
    for (const float scale : {1e-4f, 1e4f}) {
        // Single pixels at edges of shadows may flip.
        EXPECT_LE(difference(usual, at(scale)).rms, 0.01) << scale;
    }
}

TEST_F(DirectLightTest, StrongAndOddLightsStayFinite) {
    RenderOptions options;
    options.checkFinite = true;
    for (const LightKind kind :
         {LightKind::Point, LightKind::Spot, LightKind::Directional, LightKind::Rectangle, LightKind::Sphere})
        for (const glm::vec3 at : {glm::vec3(0), glm::vec3(0, 0, 1e-6f), glm::vec3(0, 0, 1)})
            for (const float size : {0.0f, 0.3f}) {
                Light light = lightOf(kind, 1e9f);
                light.halfSize = {size, size};
                light.innerCone = light.outerCone =
                    size * 5; // a cone without width, or of almost all directions
                Graph graph = shippedGraph("direct_light");
                auto made = lit(graph, litScene(square(), {{light, at, {0, 0, -1}}}), options);
                made.frame();
                auto probe = lit(probeGraph(R"("source": {"type": "DirectLight"})",
                                            R"(,["g.depth", "source.depth"], ["g.normal", "source.normal"])"),
                                 litScene(square(), {{light, at, {0, 0, -1}}}), options);
                probe.frame();
            }
    auto empty = lit(shippedGraph("direct_light"),
                     litScene({}, {{lightOf(LightKind::Point, 1), {0, 0, 1}, {}}}), options);
    empty.frame();
}

// A ring of walls around a light that stands low over the plane: nothing outside of it is lit, by a cone of
// 180 degrees as by all directions.
TEST_F(DirectLightTest, AWideSpotLightIsShadowedToItsEdge) {
    std::vector<glm::vec3> corners = square();
    for (const glm::vec3& out :
         {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0)})
        for (const float z : {0.15f, -0.15f}) // the lower one keeps the middle of the bounds at the origin
            corners = join(corners, quad(0.5f * out + glm::vec3(0, 0, z), 0.51f * glm::vec3(out.y, out.x, 0),
                                         {0, 0, 0.16f}));
    Light wide = lightOf(LightKind::Spot, 3);
    for (const float cone : {1.45f, pi / 2}) {
        wide.innerCone = wide.outerCone = cone;
        const glm::vec3 at(0.05f, 0.02f, 0.05f);
        const Image spot = picture(directGraph(), litScene(corners, {{wide, at, {0, 0, -1}}}));
        const Image point =
            picture(directGraph(), litScene(corners, {{lightOf(LightKind::Point, 3), at, {0, 0, -1}}}));
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const glm::vec3 p = squarePoint(spot, x, y);
                const float reach = std::max(std::abs(p.x), std::abs(p.y));
                if (std::abs(reach - 0.5f) < 0.04f) continue;
                const float angle = std::atan2(glm::length(glm::vec2(p - at)), at.z);
                if (reach > 0.5f) {
                    ASSERT_NEAR(spot.at(x, y), 0, 1e-6f) << cone << " at " << x << ", " << y;
                } else if (angle < cone - 0.02f) {
                    ASSERT_NEAR(spot.at(x, y), point.at(x, y), 1e-3f * point.at(x, y)) << x << ", " << y;
                }
            }
    }
}

TEST_F(DirectLightTest, ThirtyThreeLampsAndASunAllShine) {
    std::vector<PlacedLight> lights;
    for (int i = 0; i < 33; ++i)
        lights.push_back(
            {lightOf(LightKind::Point, 1),
             {0.25f * static_cast<float>(i % 6) - 0.6f, 0.25f * static_cast<float>(i / 6) - 0.6f, 1},
             {0, 0, -1}});
    lights.push_back({lightOf(LightKind::Directional, 2), {0, 0, 1}, {0, 0, -1}});
    const Scene scene = litScene(square(), lights);
    expectIrradiance(
        picture(directGraph("\"resolution\": 64"), scene),
        [&](const glm::vec3& p) {
            float sum = 2;
            for (size_t i = 0; i < 33; ++i) sum += 1 / std::pow(glm::length(lights[i].position - p), 3.0f);
            return sum;
        },
        1e-4f);
}

// Draws the depth that a light's view sees.
class LightViewProbe : public Pass {
public:
    static PassType type() {
        return Describe<LightViewProbe>("LightViewProbe", "Shows the depth that a light sees")
            .output("depth", PortKind::Texture, "Depth")
            .number("light", &LightViewProbe::light, 0, 100, "", "Which light")
            .number("face", &LightViewProbe::face, 0, 5, "", "Which face");
    }
    [[nodiscard]] Declaration declare(const World& world, const Inputs&, const Demand&) const override {
        // 64 texels, of which 3 on each side are a guard, as of a shadow map.
        const View view{.source = LightView{.light = light, .face = face, .side = 58}, .guard = 3};
        Declaration declaration;
        declaration.outputs = {{.port = "depth",
                                .desc = Desc::texture2D(Format::D32F, world.extentOf(view), view),
                                .clear = glm::vec4(0)}};
        declaration.steps = {{.name = "draw",
                              .shaders = {"light_view.vert", "light_view.frag"},
                              .uses = {{.port = "depth", .access = Access::Attachment, .write = true}}}};
        return declaration;
    }
    void execute(const Step&, Commands& commands) override {
        DrawState state;
        state.cull = Cull::None;
        commands.drawScene(state, {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided});
    }
    int light = 0, face = 0;
};

TEST_F(DirectLightTest, ALightsViewSeesWhatItsShadowMapHolds) {
    Registry registry = shipped();
    registry.add(LightViewProbe::type());
    const TemporaryFolder folder;
    std::ofstream(folder / "light_view.vert") << R"(#include "lib/vertex.glsl"
#include "shared/view.h"
layout(std140) uniform DepthView { ViewData depth_view; };
void main() { gl_Position = depth_view.viewProjection * vec4(in_position, 1.0); }
)";
    std::ofstream(folder / "light_view.frag") << "void main() {}\n";
    registry.shaderFolders.push_back(folder.path());

    // Something on every side of the lights, which stand off the middle and look askew.
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 6; ++i) {
        glm::vec3 out(0), side(0), along(0);
        out[i / 2] = i % 2 == 0 ? 1 : -1;
        side[(i / 2 + 1) % 3] = 0.7f;
        along[(i / 2 + 2) % 3] = 0.4f;
        corners = join(corners, quad(out + 0.3f * side, side, along + 0.2f * out));
        corners = join(corners, quad(-out - 0.3f * side, side, along + 0.2f * out));
    }
    for (const LightKind kind :
         {LightKind::Point, LightKind::Spot, LightKind::Directional, LightKind::Rectangle})
        for (const float cone : {0.8f, pi / 2}) {
            if (kind != LightKind::Spot && cone > 1) continue;
            Light light = lightOf(kind, 1);
            light.innerCone = 0.1f;
            light.outerCone = cone;
            light.halfSize = {0.1f, 0.1f};
            const Scene scene = litScene(corners, {{light, {0.1f, -0.2f, 0.05f}, {0.3f, -0.2f, -1}}});
            const int faces = kind == LightKind::Point                                                ? 6
                              : kind == LightKind::Rectangle || (kind == LightKind::Spot && cone > 1) ? 5
                                                                                                      : 1;
            for (int face = 0; face < faces; ++face) {
                SCOPED_TRACE(fmt::format("kind {}, cone {}, face {}", static_cast<int>(kind), cone, face));
                RenderOptions options;
                options.size = {40, 30, 1};
                Renderer made(
                    graphOf(fmt::format(R"("g": {{"type": "GBuffer"}}, "direct": {{"type": "DirectLight",
                                          "properties": {{"resolution": 64}}}},
                                          "probe": {{"type": "LightViewProbe", "properties": {{"face": {}}}}})",
                                        face),
                            R"(["g.depth", "direct.depth"], ["g.normal", "direct.normal"])",
                            R"("direct.shadow_maps", "probe.depth")"),
                    registry, scene, context().capabilities(), options);
                made.frame();
                const Image map = made.read({"direct", "shadow_maps"}, face);
                const Image view = made.read({"probe", "depth"});
                ASSERT_EQ(map.sizeText(), view.sizeText());
                const bool mirrored = face == 2 || face == 4 || face == 5;
                int covered = 0, other = 0;
                for (int y = 0; y < 64; ++y)
                    for (int x = 0; x < 64; ++x) {
                        const float held = map.at(mirrored ? 63 - x : x, y), seen = view.at(x, y);
                        covered += held > 0 ? 1 : 0;
                        other += std::abs(held - seen) > 1e-4f * std::max(held, seen) ? 1 : 0;
                    }
                EXPECT_GT(covered, 200);
                EXPECT_LE(other, 20) << "pixels at edges, where rounding decides";
            }
        }
}

} // namespace
} // namespace kestrel::test
