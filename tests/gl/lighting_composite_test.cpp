// The arithmetic of composites, and light from the surroundings.
#include "image/io.h"
#include "lighting_fixture.h"
#include "support/temporary_folder.h"

namespace kestrel::test {
namespace {

struct CompositeTest : LightingTest {};

constexpr const char* parts = R"("g": {"type": "GBuffer"}, "direct": {"type": "DirectLight"},
    "indirect": {"type": "DirectLight", "properties": {"shadows": false}}, "ao": {"type": "RayAmbientOcclusion"},
    "bvh": {"type": "Bvh"}, "sky": {"type": "Environment"},
    "composite": {"type": "Composite", "properties": {"ambient": [0.1, 0.2, 0.3]}})";
constexpr const char* partEdges =
    R"(["g.depth", "direct.depth"], ["g.normal", "direct.normal"], ["g.albedo", "direct.albedo"],
    ["g.material", "direct.material"], ["g.depth", "indirect.depth"], ["g.normal", "indirect.normal"],
    ["g.depth", "ao.depth"], ["g.normal", "ao.normal"], ["bvh.tracer", "ao.tracer"], ["g.depth", "sky.depth"],
    ["g.albedo", "composite.albedo"], ["g.material", "composite.material"], ["g.emission", "composite.emission"],
    ["direct.result", "composite.direct"], ["indirect.result", "composite.indirect"], ["ao.visibility", "composite.visibility"],
    ["ao.visibility", "composite.shadow"], ["indirect.result", "composite.area"], ["direct.specular", "composite.reflection"], ["direct.specular", "composite.specular"],
    ["sky.background", "composite.background"])";

TEST_F(CompositeTest, IsEmissionAlbedoTimesLightAndSpecular) {
    std::vector<glm::vec3> corners =
        join(square(glm::mat3(0.6f)), quad({0, 0, 0.3f}, {0.25f, 0, 0}, {0, 0.25f, 0}));
    Scene scene =
        litScene(corners, {{lightOf(LightKind::Point, 3), {0.5f, 0.4f, 1}, {0, 0, -1}}}, {0.2f, 0.4f, 0.8f});
    scene.materials[0].metallic = 0.25f;
    scene.materials[0].roughness = 0.5f;
    scene.materials[0].emission = {0.5f, 0, 0.25f};
    RenderOptions options;
    options.keepAll = true;
    auto made = lit(graphOf(parts, partEdges, R"("composite.result")"), scene, options);
    made.frame();
    const auto read = [&](const char* pass, const char* port) { return made.read({pass, port}); };
    const Image albedo = read("g", "albedo"), material = read("g", "material"),
                emission = read("g", "emission"), direct = read("direct", "result"),
                specular = read("direct", "specular"), indirect = read("indirect", "result"),
                visibility = read("ao", "visibility"), background = read("sky", "background"),
                result = read("composite", "result");
    int covered = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            if (albedo.at(x, y, 3) == 0) {
                ASSERT_EQ(pixelColour(result, x, y), pixelColour(background, x, y));
                ASSERT_GT(result.at(x, y, 2), 0);
                ASSERT_EQ(result.at(x, y, 3), 0);
                continue;
            }
            ++covered;
            const glm::vec3 ambient(0.1f, 0.2f, 0.3f);
            const glm::vec3 light =
                visibility.at(x, y) * (pixelColour(indirect, x, y) + ambient + pixelColour(direct, x, y)) +
                pixelColour(indirect, x, y);
            const glm::vec3 expected = pixelColour(albedo, x, y) * light * (1 - material.at(x, y, 1)) +
                                       2.0f * pixelColour(specular, x, y) + pixelColour(emission, x, y);
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(result.at(x, y, c), expected[c], 1e-5f * expected[c] + 1e-6f) << x << ", " << y;
            ASSERT_EQ(result.at(x, y, 3), 1);
        }
    EXPECT_GT(covered, 500);
}

TEST_F(CompositeTest, AnUnlitSurfaceShowsItsColour) {
    Scene scene =
        litScene(square(), {{lightOf(LightKind::Point, 3), {0.5f, 0.4f, 1}, {0, 0, -1}}}, {0.25f, 0.5f, 1});
    scene.materials[0].unlit = true;
    const Image image = picture(graphOf(parts, partEdges, R"("composite.result")"), scene);
    EXPECT_EQ(pixelColour(image, 30, 30), glm::vec3(0.25f, 0.5f, 1));
}

TEST_F(CompositeTest, LeavesOutWhatIsNeutral) {
    const auto made = lit(graphOf(parts, partEdges, R"("composite.result")"), litScene(square(), {}));
    EXPECT_TRUE(leavesOut(made.plan(), "direct: it is 0 everywhere"));
    EXPECT_TRUE(leavesOut(made.plan(), "emission: it is 0 everywhere"));
    EXPECT_TRUE(leavesOut(made.plan(), "specular: it is 0 everywhere"));
}

// The specular lobe against glTF's own formulas, at one pixel each.
TEST_F(CompositeTest, SpecularLightFollowsTheMicrofacetModel) {
    for (const float roughness : {0.1f, 0.2f, 0.5f, 1.0f}) {
        const glm::vec3 at(0.4f, -0.3f, 1), colour(0.9f, 0.6f, 0.3f);
        Scene scene = litScene(square(), {{lightOf(LightKind::Point, 3), at, {0, 0, -1}}}, colour);
        scene.materials[0].roughness = roughness;
        scene.materials[0].metallic = 1;
        Graph graph = graphOf(parts, partEdges, R"("direct.specular")");
        const Image image = picture(graph, scene);
        for (const glm::ivec2 pixel : {glm::ivec2(20, 30), glm::ivec2(40, 36), glm::ivec2(60, 5)}) {
            const glm::vec3 p = squarePoint(image, pixel.x, pixel.y), n(0, 0, 1), view(0, 0, 1);
            const glm::vec3 to = at - p, l = glm::normalize(to), h = glm::normalize(l + view);
            const double a2 = std::pow(double{roughness}, 4.0);
            const double nh = double{glm::dot(n, h)}, nl = double{glm::dot(n, l)}, nv = 1;
            const double d = a2 / (std::numbers::pi * std::pow(nh * nh * (a2 - 1) + 1, 2));
            const double v =
                0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
            const double fresnel = std::pow(1 - double{glm::dot(view, h)}, 5);
            for (int c = 0; c < 3; ++c) {
                const double f = double{colour[c]} + (1 - double{colour[c]}) * fresnel;
                const double expected = d * v * f * nl * 3 / double{glm::dot(to, to)};
                EXPECT_NEAR(double{image.at(pixel.x, pixel.y, c)}, expected, 5e-3 * expected)
                    << roughness << " at " << pixel.x;
            }
        }
    }
}

// In a white surrounding of radiance 1 no surface shines more than it: diffuse light under the layer and what
// the specular lobe reflects.
TEST_F(CompositeTest, AWhiteSurfaceInAWhiteFurnaceGivesBackAtMostWhatArrives) {
    for (const float roughness : {0.05f, 0.3f, 1.0f})
        for (const float metallic : {0.0f, 0.5f, 1.0f})
            for (const float tilt : {0.0f, 50.0f, 70.0f, 80.0f, 87.0f}) {
                Scene scene = litScene(
                    square(glm::mat3(glm::rotate(glm::mat4(1), glm::radians(tilt), glm::vec3(1, 0, 0)))), {},
                    {1, 1, 1});
                scene.materials[0].roughness = roughness;
                scene.materials[0].metallic = metallic;
                Graph graph = graphOf(
                    R"("g": {"type": "GBuffer"}, "sky": {"type": "Environment", "properties": {"kind": "constant"}},
                    "bvh": {"type": "Bvh"}, "glossy": {"type": "GlossyReflection", "properties": {"rays": 64}},
                    "composite": {"type": "Composite", "properties": {"ambient": [1, 1, 1]}})",
                    R"(["g.depth", "glossy.depth"], ["g.normal", "glossy.normal"], ["g.albedo", "glossy.albedo"],
                    ["g.material", "glossy.material"], ["bvh.tracer", "glossy.tracer"], ["sky.radiance", "glossy.radiance"],
                    ["g.albedo", "composite.albedo"], ["g.material", "composite.material"], ["g.depth", "composite.depth"],
                    ["g.normal", "composite.normal"], ["glossy.result", "composite.reflection"])",
                    R"("composite.result")");
                applySetting(graph, shipped(), "sky.colour=[1,1,1]");
                const Image image = picture(graph, scene);
                double sum = 0, count = 0;
                for (int y = 0; y < 64; ++y)
                    for (int x = 0; x < 64; ++x)
                        if (image.at(x, y, 3) > 0) {
                            sum += image.at(x, y, 0);
                            ++count;
                        }
                ASSERT_GT(count, 0);
                EXPECT_LE(sum / count, 1.005) << roughness << " " << metallic << " " << tilt;
                // Seen from above a smooth surface gives back nearly all of it; single scattering loses some
                // of rough ones.
                if (tilt == 0 && roughness < 0.5f) {
                    EXPECT_GE(sum / count, 0.97) << roughness << " " << metallic;
                }
            }
}

struct EnvironmentTest : LightingTest {
    // What an empty scene shows through the probe, which sees along the camera's rays.
    static Image seen(const std::string& properties, const std::string& source = "") {
        Scene scene = litScene({}, {});
        scene.source = source;
        Graph graph = probeGraph(
            fmt::format(R"("source": {{"type": "Environment", "properties": {{{}}}}})", properties),
            R"(, ["g.depth", "source.depth"])");
        graph.outputs.push_back({{"source", "background"}, {}});
        RenderOptions options;
        options.size = frame;
        Renderer made(graph, withProbe(), scene, context().capabilities(), options);
        CameraState camera; // along -z, 90 degrees wide
        camera.verticalFov = pi / 2;
        camera.aspect = 1;
        made.setFreeCamera(camera);
        made.frame();
        const Image background = made.read({"source", "background"});
        const Image probe = made.read({"probe", "result"});
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x)
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(background.at(x, y, c), probe.at(x, y, c), 2e-3f * probe.at(x, y, c) + 1e-4f);
        return probe;
    }
    // The direction of a pixel of it.
    static glm::vec3 direction(int x, int y) {
        return glm::normalize(glm::vec3((2 * static_cast<float>(x) + 1) / 64 - 1,
                                        1 - (2 * static_cast<float>(y) + 1) / 64, -1));
    }
};

TEST_F(EnvironmentTest, AConstantIsTheSameEverywhere) {
    const Image image = seen(R"("kind": "constant", "colour": [1, 2, 3], "intensity": 0.5)");
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) ASSERT_EQ(pixelColour(image, x, y), glm::vec3(0.5f, 1, 1.5f));
}

TEST_F(EnvironmentTest, AGradientGoesFromGroundOverHorizonToZenith) {
    const Image image = seen(R"("zenith": [0, 0, 1], "horizon": [1, 1, 1], "ground": [0.25, 0, 0])");
    for (int y = 0; y < 64; ++y) {
        const float up = direction(20, y).y;
        const glm::vec3 expected =
            up >= 0 ? glm::mix(glm::vec3(1), glm::vec3(0, 0, 1), std::sqrt(up))
                    : glm::mix(glm::vec3(1), glm::vec3(0.25f, 0, 0), std::min(1.0f, -50 * up));
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(image.at(20, y, c), expected[c], 1e-4f) << y;
    }
}

TEST_F(EnvironmentTest, APictureIsLookedUpByDirection) {
    // Red tells the longitude, green the latitude; both run from 0 to 1.
    const TemporaryFolder folder;
    Image picture(256, 128, 3);
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            picture.at(x, y, 0) = (static_cast<float>(x) + 0.5f) / 256;
            picture.at(x, y, 1) = 1 - (static_cast<float>(y) + 0.5f) / 128;
            picture.at(x, y, 2) = 40;
        }
    writeImage(folder / "surroundings.exr", picture, Encoding::Linear);
    const Image image = seen(R"("kind": "picture", "file": "surroundings.exr", "rotation": 180)",
                             (folder / "scene.gltf").string());
    for (int y = 0; y < 64; y += 7)
        for (int x = 0; x < 64; x += 7) {
            const glm::vec3 d = direction(x, y);
            float longitude = 0.5f + (std::atan2(d.x, d.z) + pi) / (2 * pi);
            longitude -= std::floor(longitude);
            ASSERT_NEAR(image.at(x, y, 0), longitude, 0.005f) << x << ", " << y;
            ASSERT_NEAR(image.at(x, y, 1), 0.5f + std::asin(d.y) / pi, 0.01f);
            ASSERT_NEAR(image.at(x, y, 2), 40, 0.1f);
        }
}

TEST_F(EnvironmentTest, PicturesMayLieAnywhereButMustBeThere) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder / "model");
    writeImage(folder / "grey.exr", Image(2, 1, 3, 0.25f), Encoding::Linear);
    const std::string scene = (folder / "model" / "scene.gltf").string();
    for (const std::string& file : {std::string("../grey.exr"), (folder / "grey.exr").string()})
        EXPECT_NEAR(seen(fmt::format(R"("kind": "picture", "file": "{}")", file), scene).at(3, 3, 1), 0.25f,
                    1e-3f)
            << file;
    for (const char* file : {"../secret.exr", "/etc/passwd.exr", "missing.exr"})
        EXPECT_THROW(
            seen(fmt::format(R"("kind": "picture", "file": "{}")", file), (folder / "scene.gltf").string()),
            InputError)
            << file;
    EXPECT_THROW(seen(R"("kind": "picture")"), InputError);
}

} // namespace
} // namespace kestrel::test
