// Path tracing by shaders: furnaces, Embree's paths, what counts once, adaptive sampling.
#include "ray_effects_fixture.h"

namespace kestrel::test {
namespace {

const PortRef traced{"path", "result"}, bounced{"path", "indirect"}, truth{"reference", "result"},
    truthBounced{"reference", "indirect"}, inView{"gbuffer", "coverage"};

Graph pathGraph(const std::vector<PortRef>& outputs, const std::vector<std::string>& settings = {}) {
    Graph graph = parseGraph(R"({
        "kestrel": 1,
        "passes": {
            "gbuffer": { "type": "GBuffer" },
            "bvh": { "type": "Bvh" },
            "bom": { "type": "OccupancyMap", "properties": { "resolution": 64, "method": "exact" } },
            "roma": { "type": "Roma" },
            "depth_bounds": { "type": "ABufferBounds" },
            "store": { "type": "ABufferStore" },
            "reorder": { "type": "ABufferReorder" },
            "abuffer": { "type": "ABuffer" },
            "direct": { "type": "DirectLight", "properties": { "resolution": 512 } },
            "rsm": { "type": "ReflectiveShadowMap", "properties": { "resolution": 256 } },
            "sky": { "type": "Environment", "properties": { "kind": "constant", "intensity": 0 } },
            "light": { "type": "RadianceSum" },
            "path": { "type": "PathTrace" },
            "indirect": { "type": "IndirectDiffuse", "properties": { "rays": 8, "snap": false } },
            "reference": { "type": "ReferencePathTrace" }
        },
        "edges": [
            ["bom.occupancy", "roma.occupancy"], ["bom.grid", "roma.grid"],
            ["depth_bounds.bounds", "store.bounds"], ["depth_bounds.cube_bounds", "store.cube_bounds"],
            ["store.pixels", "reorder.stored_pixels"], ["store.nodes", "reorder.stored_nodes"],
            ["store.data", "reorder.data"], ["store.segments", "reorder.segments"],
            ["reorder.pixels", "abuffer.pixels"], ["reorder.nodes", "abuffer.nodes"], ["reorder.triangles", "abuffer.data"],
            ["gbuffer.depth", "direct.depth"], ["gbuffer.normal", "direct.normal"],
            ["direct.radiance", "light.first"], ["sky.radiance", "light.second"],
            ["gbuffer.depth", "path.depth"], ["gbuffer.normal", "path.normal"],
            ["gbuffer.face_normal", "path.face_normal"], ["gbuffer.albedo", "path.albedo"],
            ["gbuffer.material", "path.material"], ["gbuffer.emission", "path.emission"],
            ["gbuffer.refraction", "path.refraction"], ["bvh.tracer", "path.tracer"],
            ["light.radiance", "path.radiance"],
            ["gbuffer.depth", "indirect.depth"], ["gbuffer.normal", "indirect.normal"],
            ["gbuffer.face_normal", "indirect.face_normal"], ["roma.tracer", "indirect.tracer"],
            ["rsm.radiance", "indirect.radiance"],
            ["gbuffer.position", "reference.position"], ["gbuffer.normal", "reference.normal"],
            ["gbuffer.face_normal", "reference.face_normal"], ["gbuffer.albedo", "reference.albedo"],
            ["gbuffer.material", "reference.material"], ["gbuffer.emission", "reference.emission"],
            ["gbuffer.refraction", "reference.refraction"]
        ],
        "outputs": []
    })",
                             "path.json");
    for (const std::string& setting : settings) applySetting(graph, shipped(), setting);
    for (const PortRef& output : outputs) graph.outputs.push_back({output, {}});
    return graph;
}

Material surfaceOf(const glm::vec3& colour, float metallic, float roughness) {
    Material material;
    material.baseColour = glm::vec4(colour, 1);
    material.metallic = metallic;
    material.roughness = roughness;
    material.doubleSided = true;
    return material;
}

Material lambert(const glm::vec3& colour, const glm::vec3& emission = glm::vec3(0)) {
    Material material = surfaceOf(colour, 0, 1);
    material.ior = 1; // no interface
    material.emission = emission;
    return material;
}

Material clearGlass(const glm::vec3& colour) {
    Material material = surfaceOf(colour, 0, 0);
    material.transmission = 1;
    return material;
}

void addMesh(Scene& scene, std::vector<glm::vec3> corners, const Material& material) {
    Scene part = trianglesScene(std::move(corners));
    part.meshes[0].primitives[0].material = static_cast<int>(scene.materials.size());
    scene.materials.push_back(material);
    Node node;
    node.mesh = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back(part.meshes[0]);
    scene.roots.push_back(static_cast<int>(scene.nodes.size()));
    scene.nodes.push_back(node);
}

Scene sceneOf(std::vector<glm::vec3> corners, const Material& material) {
    Scene scene;
    addMesh(scene, std::move(corners), material);
    finishScene(scene);
    return scene;
}

std::vector<glm::vec3> moved(std::vector<glm::vec3> corners, const glm::vec3& by) {
    for (glm::vec3& corner : corners) corner += by;
    return corners;
}

// The inside of a cube of half size 1.
std::vector<glm::vec3> cube() {
    std::vector<glm::vec3> corners;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            glm::vec3 corner(-1), u(0), v(0);
            corner[axis] = side;
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2;
            corners = joined(std::move(corners),
                             side < 0 ? parallelogram(corner, u, v) : parallelogram(corner, v, u));
        }
    return corners;
}

double meanColour(const Image& image, const Image* mask = nullptr) {
    double sum = 0, count = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            if (mask != nullptr && !(mask->at(x, y, 0) > 0)) continue;
            for (int k = 0; k < 3; ++k) sum += double{image.at(x, y, k)};
            count += 3;
        }
    return count > 0 ? sum / count : 0;
}

struct Paths : EffectsTest {
    static constexpr Extent tiny{16, 16, 1};
    static CameraState inside() { return lookingAt({0.3f, -0.2f, 0.5f}, {-0.6f, 0.1f, -0.4f}); }
    // A closed room of plaster with a ball of rough metal and one of glass, a lamp and a panel that glows.
    static Scene room() {
        Scene scene;
        addMesh(scene, cube(), lambert({0.7f, 0.6f, 0.5f}));
        addMesh(scene, moved(ball(0.35f, 10), {-0.5f, -0.4f, -0.4f}), surfaceOf({0.9f, 0.7f, 0.4f}, 1, 0.4f));
        addMesh(scene, moved(ball(0.3f, 10), {0.3f, -0.5f, -0.3f}), clearGlass({0.9f, 1, 0.95f}));
        addMesh(scene, moved(ball(0.25f, 10), {-0.1f, 0.3f, -0.6f}), surfaceOf({0.3f, 0.5f, 0.8f}, 0, 0.3f));
        addMesh(scene, parallelogram({-0.4f, 0.95f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}),
                lambert(glm::vec3(0.3f), glm::vec3(2)));
        Light lamp;
        lamp.kind = LightKind::Point;
        lamp.intensity = 1;
        addLightTo(scene, lamp, {0.6f, 0.6f, 0.6f}, {1, 0, 0, 0});
        finishScene(scene);
        return scene;
    }
    static CameraState inRoom() { return lookingAt({0.5f, 0.3f, 0.9f}, {-0.3f, -0.2f, -0.5f}); }
    // Mean of a constant picture, and how far pixels are from it.
    static void expectConstant(const Image& image, double expected, double tolerance) {
        EXPECT_NEAR(meanColour(image), expected, tolerance * expected);
    }
};

TEST_F(Paths, TheFurnaceOfADiffuseRoomIsTheGeometricSeries) {
    const Scene scene = sceneOf(cube(), lambert(glm::vec3(0.8f), glm::vec3(0.5f)));
    for (const int bounces : {1, 2, 8}) {
        const Image image = run(pathGraph({traced}, {fmt::format("path.bounces={}", bounces)}), scene,
                                {traced}, 2, inside(), tiny)[0];
        const double expected = 0.5 * (1 - std::pow(0.8, bounces + 1)) / 0.2;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x)
                ASSERT_NEAR(image.at(x, y, 1), expected, 0.005 * expected) << bounces;
        EXPECT_EQ(image.at(3, 4, 3), 2.0f); // paths a pixel
    }
}

// Each BSDF in a room that glows everywhere: the reference, which is held against sums without sampling.
TEST_F(Paths, FurnacesOfEveryBsdfAreThoseOfTheReference) {
    if (!hasReferences()) GTEST_SKIP() << "Embree is not built in";
    const std::vector<Material> kinds = {surfaceOf(glm::vec3(0.8f), 1, 0.5f),
                                         surfaceOf(glm::vec3(0.8f), 1, 0),
                                         surfaceOf(glm::vec3(0.8f), 0, 0.4f), clearGlass(glm::vec3(0.8f)),
                                         surfaceOf(glm::vec3(0.8f), 0.5f, 0.9f)};
    for (size_t i = 0; i < kinds.size(); ++i) {
        Scene scene;
        addMesh(scene, cube(), lambert(glm::vec3(0.8f), glm::vec3(1)));
        Material kind = kinds[i];
        kind.emission = glm::vec3(0.5f);
        addMesh(scene, moved(ball(0.4f, 8), {-0.3f, 0, -0.2f}), kind);
        finishScene(scene);
        const std::vector<std::string> settings = {"path.bounces=4", "path.samples=8", "reference.bounces=4",
                                                   "reference.samples=256"};
        const Image made = run(pathGraph({traced}, settings), scene, {traced}, 32, inside(), tiny)[0];
        const Image expected = run(pathGraph({truth}, settings), scene, {truth}, 1, inside(), tiny)[0];
        EXPECT_NEAR(meanColour(made) / meanColour(expected), 1, 0.005) << "kind " << i;
    }
}

TEST_F(Paths, ThroughABvhAreEmbrees) {
    if (!hasReferences()) GTEST_SKIP() << "Embree is not built in";
    const Scene scene = room();
    const std::vector<std::string> settings = {"path.bounces=3", "path.samples=8", "reference.bounces=3",
                                               "reference.samples=512", "direct.resolution=2048"};
    const auto made = run(pathGraph({traced, bounced}, settings), scene, {traced, bounced}, 48, inRoom());
    const auto expected =
        run(pathGraph({truth, truthBounced}, settings), scene, {truth, truthBounced}, 1, inRoom());
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_GT(meanColour(expected[i]), 0.05);
        EXPECT_NEAR(meanColour(made[i]) / meanColour(expected[i]), 1, 0.01) << i;
        // Pixels too: noise of both, and edges of shadows.
        double apart = 0;
        for (size_t k = 0; k < made[i].values.size(); ++k)
            if (k % 4 != 3) apart += std::abs(double{made[i].values[k]} - double{expected[i].values[k]});
        EXPECT_LT(apart / (0.75 * static_cast<double>(made[i].values.size())),
                  0.15 * meanColour(expected[i]));
    }
}

TEST_F(Paths, AreTheSameToTheBitAndAnothersSeedIsAnother) {
    const Scene scene = room();
    const Graph graph =
        pathGraph({traced, bounced}, {"path.adaptive=true", "path.share=0.5", "path.warm_up=2"});
    const auto first = run(graph, scene, {traced, bounced}, 6, inRoom());
    EXPECT_EQ(first, run(graph, scene, {traced, bounced}, 6, inRoom()));
    RenderOptions other;
    other.seed = 5;
    Renderer made = renderer(graph, scene, other, small);
    made.setFreeCamera(inRoom());
    for (int i = 0; i < 6; ++i) made.frame();
    EXPECT_NE(made.read(traced), first[0]);
}

// White surfaces of every kind under a white sky: no pixel gets more than the sky has.
TEST_F(Paths, EnergyNeverGrows) {
    Scene scene;
    addMesh(scene, parallelogram({-2, -0.6f, -2}, {0, 0, 4}, {4, 0, 0}), lambert(glm::vec3(1)));
    addMesh(scene, moved(ball(0.4f, 8), {-0.9f, -0.1f, 0}), surfaceOf(glm::vec3(1), 1, 0.3f));
    addMesh(scene, moved(ball(0.4f, 8), {0, -0.1f, 0}), clearGlass(glm::vec3(1)));
    addMesh(scene, moved(ball(0.4f, 8), {0.9f, -0.1f, 0}), surfaceOf(glm::vec3(1), 0.3f, 0.1f));
    finishScene(scene);
    const Image image = run(pathGraph({traced}, {"sky.intensity=1", "path.bounces=8"}), scene, {traced}, 4,
                            lookingAt({0, 0.8f, 3}, {0, -0.2f, 0}))[0];
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int k = 0; k < 3; ++k) {
                ASSERT_LE(image.at(x, y, k), 1.0001f) << x << ", " << y;
                sum += double{image.at(x, y, k)};
            }
    EXPECT_GT(sum / (3.0 * static_cast<double>(image.pixelCount())), 0.8);
}

// Without lights there is emission alone; under a sky alone an open diffuse square shows its albedo of it.
TEST_F(Paths, WithoutLightsAndUnderASkyAlone) {
    const Scene square0 = sceneOf(square(), lambert(glm::vec3(0.5f)));
    const CameraState camera = lookingAt({0, 0, 3}, {0, 0, 0});
    const auto dark = run(pathGraph({traced, inView}), square0, {traced, inView}, 2, camera);
    EXPECT_EQ(meanColour(dark[0]), 0);
    EXPECT_GT(meanWhere(dark[1], dark[1]), 0.5);
    const auto lit =
        run(pathGraph({traced, inView}, {"sky.intensity=2"}), square0, {traced, inView}, 2, camera);
    for (int y = 0; y < lit[0].height; ++y)
        for (int x = 0; x < lit[0].width; ++x)
            ASSERT_NEAR(lit[0].at(x, y, 0), lit[1].at(x, y, 0) > 0 ? 1.0f : 2.0f, 1e-5f);
    // Nothing at all but a sky.
    const Image empty =
        run(pathGraph({traced}, {"sky.intensity=2"}), trianglesScene({}), {traced}, 2, camera)[0];
    for (size_t i = 0; i < empty.values.size(); ++i) ASSERT_EQ(empty.values[i], 2.0f); // alpha: two paths
}

// A panel over a floor, and a light that stands for it: the same whether the light is asked or the panel
// found, and in a mirror the panel is seen either way.
TEST_F(Paths, TheLightOfAPanelCountsOnce) {
    Scene scene;
    addMesh(scene, parallelogram({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}), lambert(glm::vec3(0.6f)));
    addMesh(scene, parallelogram({-0.5f, 1.5f, -0.5f}, {1, 0, 0}, {0, 0, 1}),
            lambert(glm::vec3(0), glm::vec3(3)));
    Light light;
    light.kind = LightKind::Rectangle;
    light.intensity = 3;
    light.halfSize = {0.5f, 0.5f};
    addLightTo(scene, light, {0, 1.5f, 0}, downwards);
    finishScene(scene);
    const CameraState camera = lookingAt({0, 1, 3}, {0, 0, 0});
    for (const bool mirror : {false, true}) {
        if (mirror) scene.materials[0] = surfaceOf(glm::vec3(0.6f), 1, 0);
        const std::vector<std::string> found = {"path.area_lights=false", "direct.area_lights=false"};
        const Image sampled =
            run(pathGraph({traced}, {"path.samples=16", "path.bounces=1"}), scene, {traced}, 8, camera)[0];
        std::vector<std::string> settings = {"path.samples=16", "path.bounces=1"};
        settings.insert(settings.end(), found.begin(), found.end());
        const Image other = run(pathGraph({traced}, settings), scene, {traced}, 8, camera)[0];
        EXPECT_GT(meanColour(sampled), 0.02);
        EXPECT_NEAR(meanColour(other) / meanColour(sampled), 1, 0.01) << mirror;
    }
}

TEST_F(Paths, BeginAnewWhenTheCameraMoves) {
    const Graph graph = pathGraph({traced}, {"path.samples=2"});
    Renderer made = renderer(graph, room(), {}, small);
    made.setFreeCamera(inRoom());
    for (int i = 0; i < 3; ++i) made.frame();
    EXPECT_EQ(made.read(traced).at(5, 5, 3), 6.0f);
    made.setFreeCamera(inside());
    made.frame();
    const Image moved = made.read(traced);
    EXPECT_EQ(moved.at(5, 5, 3), 2.0f);
    const Image fresh = run(graph, room(), {traced}, 1, inside())[0];
    EXPECT_NEAR(meanColour(fresh), meanColour(moved), 0.1 * meanColour(moved));
}

// A tracer that tells positions only: one bounce, lit by what knows the light of positions, as
// IndirectDiffuse has it; the rest is said to be missing.
TEST_F(Paths, ThroughATracerWithoutSurfacesEndAtTheirFirstHit) {
    Scene scene = sceneOf(cube(), lambert(glm::vec3(0.6f)));
    Light lamp;
    lamp.kind = LightKind::Point;
    addLightTo(scene, lamp, {0.3f, 0.2f, 0}, {1, 0, 0, 0});
    finishScene(scene);
    const PortRef gathered{"indirect", "result"};
    RenderOptions options;
    options.checkFinite = true;
    Renderer made =
        renderer(pathGraph({bounced, gathered}, {"path.tracer=roma.tracer", "path.radiance=rsm.radiance",
                                                 "path.bounces=3", "path.samples=8"}),
                 scene, options, small);
    made.setFreeCamera(inside());
    double other = 0;
    for (int i = 0; i < 8; ++i) {
        made.frame();
        other += meanColour(made.read(gathered)) / 8;
    }
    EXPECT_GT(other, 0.02);
    EXPECT_NEAR(meanColour(made.read(bounced)), 0.6 * other, 0.01 * other);
    bool said = false;
    for (const LeftOut& left : made.plan().leftOut)
        said = said || left.what.find("bounces after the first") != std::string::npos;
    EXPECT_TRUE(said);
}

TEST_F(Paths, ThroughAnABufferAreNearTheBvhs) {
    const Extent size{96, 54, 1};
    const std::vector<std::string> settings = {"path.bounces=2", "path.samples=8"};
    const Image exact = run(pathGraph({bounced}, settings), room(), {bounced}, 8, inRoom(), size)[0];
    std::vector<std::string> by = settings;
    by.emplace_back("path.tracer=abuffer.tracer");
    const Image made = run(pathGraph({bounced}, by), room(), {bounced}, 8, inRoom(), size)[0];
    EXPECT_GT(meanColour(made) / meanColour(exact), 0.97);
    EXPECT_LT(meanColour(made) / meanColour(exact), 1.05);
}

// A picture of which a half is sky and plain: noise lives where balls stand.
TEST_F(Paths, AdaptiveSamplingReachesTheErrorOfAFixedRateInFewerPaths) {
    Scene scene;
    addMesh(scene, parallelogram({-2, -0.6f, -2}, {0, 0, 4}, {4, 0, 0}), lambert({0.8f, 0.7f, 0.6f}));
    addMesh(scene, moved(ball(0.4f, 8), {-0.6f, -0.1f, 0}), surfaceOf(glm::vec3(0.9f), 1, 0.3f));
    addMesh(scene, moved(ball(0.4f, 8), {0.6f, -0.1f, 0}), lambert(glm::vec3(0.4f), {1, 0.5f, 0.2f}));
    finishScene(scene);
    const CameraState camera = lookingAt({0, 0.4f, 3.5f}, {0, 0.2f, 0});
    const auto image = [&](const std::vector<std::string>& settings, int frames) {
        std::vector<std::string> all = {"sky.kind=gradient", "sky.intensity=1"};
        all.insert(all.end(), settings.begin(), settings.end());
        return run(pathGraph({traced}, all), scene, {traced}, frames, camera)[0];
    };
    RenderOptions other;
    other.seed = 9;
    Renderer longest =
        renderer(pathGraph({traced}, {"path.samples=32", "sky.kind=gradient", "sky.intensity=1"}), scene,
                 other, small);
    longest.setFreeCamera(camera);
    for (int i = 0; i < 48; ++i) longest.frame();
    const Image expected = longest.read(traced);
    const Image mask(small.width, small.height, 1, 1.0f);
    const auto paths = [](const Image& of) {
        double sum = 0;
        for (size_t i = 3; i < of.values.size(); i += 4) sum += double{of.values[i]};
        return sum / static_cast<double>(of.pixelCount());
    };
    const Image adaptive = image({"path.adaptive=true", "path.share=0.25", "path.warm_up=16"}, 160);
    const double spent = paths(adaptive);
    EXPECT_LT(spent, 70);
    const Image fixed = image({}, static_cast<int>(std::ceil(spent)));
    const double ratio = colourError(adaptive, expected, mask) / colourError(fixed, expected, mask);
    RecordProperty("error_ratio", std::to_string(ratio));
    EXPECT_LT(ratio, 0.9);
    EXPECT_NEAR(meanColour(adaptive) / meanColour(expected), 1, 0.02);
}

} // namespace
} // namespace kestrel::test
