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
            "map": {"type": "StochasticDepthRay", "properties": {"collection": "k_buffer", "layers_per_texel": 8,
                "max_count": 0, "divisor": 1, "jitter": false}},
            "horizons": {"type": "HorizonAmbientOcclusion", "properties": {"slices": 16, "steps": 32}}},
            "edges": [["gbuffer.view_depth", "horizons.view_depth"], ["gbuffer.normal", "horizons.normal"],
                ["gbuffer.depth", "rays.depth"], ["gbuffer.normal", "rays.normal"], ["bvh.tracer", "rays.tracer"],
                ["gbuffer.view_depth", "map.view_depth"], ["bvh.hits", "map.hits"], ["map.layers", "horizons.layers"]],
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

const std::vector<std::string> byLayers = {"horizons.method=bitmask", "horizons.thickness_from=layers"};

TEST_F(Horizons, OpenPlanesAreOpen) {
    for (const char* method : {"gtao", "bitmask"})
        for (const float degrees : {0.0f, 30.0f, 70.0f}) {
            const glm::mat3 turn(glm::rotate(glm::mat4(1), glm::radians(degrees), glm::vec3(0.3f, 1, 0)));
            const auto images = seen(square(turn), lookingAt({0, 0, 2.5f}, {0, 0, 0}),
                                     {fmt::format("horizons.method={}", method)});
            EXPECT_GT(meanWhere(images[0], images[2]), 0.999) << method << " " << degrees;
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

// The same planes through a map that is coarser than the picture and jittered: a texel's place lies up to
// three pixels beside the sample that reads it, which must not raise a plane over itself.
TEST_F(Horizons, WithLayersOpenPlanesAreOpenWhereverTexelsLie) {
    for (const float degrees : {0.0f, 30.0f, 70.0f}) {
        const glm::mat3 turn(glm::rotate(glm::mat4(1), glm::radians(degrees), glm::vec3(0.3f, 1, 0)));
        // A second plane behind, so that there are layers; it is farther than the radius.
        std::vector<glm::vec3> behind = square(turn);
        for (glm::vec3& corner : behind) corner -= turn[2];
        const auto planes = joined(square(turn), behind);
        for (const char* divisor : {"map.divisor=1", "map.divisor=4"}) {
            std::vector<std::string> settings = byLayers;
            settings.insert(settings.end(), {divisor, "map.jitter=true"});
            const auto images = seen(planes, lookingAt({0, 0, 2.5f}, {0, 0, 0}), settings);
            EXPECT_GT(meanWhere(images[0], images[2]), 0.999) << degrees << " " << divisor;
        }
    }
}

TEST_F(Horizons, WithLayersLightPassesBehindWhatIsThin) {
    const auto scene = joined(parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}),
                              parallelogram({-1, -0.05f, 0.25f}, {2, 0, 0}, {0, 0.1f, 0}));
    const auto images = seen(scene, lookingAt({0, 0, 3}, {0, 0, 0}), byLayers);
    EXPECT_LE(difference(images[0], images[1]).rms, 0.06);
}

// A strip near the wall is hidden by one that is too far in front to occlude: only layers tell of it.
TEST_F(Horizons, WithLayersWhatIsHiddenOccludes) {
    // Behind the wall as much as before it, so that its middle is the scene's.
    std::vector<glm::vec3> scene = parallelogram({-2, -1, 0}, {4, 0, 0}, {0, 2, 0});
    for (const auto& more : {parallelogram({-2, -0.17f, 0.25f}, {4, 0, 0}, {0, 0.34f, 0}),
                             parallelogram({-2, -0.1f, 1.5f}, {4, 0, 0}, {0, 0.2f, 0}),
                             parallelogram({-2, -0.1f, -1.5f}, {4, 0, 0}, {0, 0.2f, 0})})
        scene = joined(scene, more);
    const CameraState camera = lookingAt({0, 0, 3}, {0, 0, 0});
    // Of the wall beside the front strip, which hides |y| < 0.2 of it.
    const auto beside = [](const std::vector<Image>& images) {
        Image mask = images[2];
        for (float& value : mask.values) value = 0;
        for (int y = 0; y < mask.height; ++y)
            for (int x = 0; x < mask.width; ++x) {
                const double up = (mask.height / 2.0 - y - 0.5) / mask.height * 2 * std::tan(0.4) * 3;
                mask.at(x, y) = std::abs(up) > 0.21 && std::abs(up) < 0.32 ? 1.0f : 0.0f;
            }
        return std::pair(meanWhere(images[0], mask), meanWhere(images[1], mask));
    };
    const auto [told, truth] = beside(seen(scene, camera, byLayers));
    const auto [blind, same] =
        beside(seen(scene, camera, {"horizons.method=bitmask", "horizons.thickness=0.1"}));
    EXPECT_EQ(truth, same);
    EXPECT_LT(truth, 0.92);
    EXPECT_GT(blind, 0.99);
    // The strip is thinner than the map's surfaces are taken for: darker, but not by as much as what was
    // missed.
    EXPECT_LT(told, truth + 0.02);
    EXPECT_LT(truth - told, 0.7 * (blind - truth));
}

// What is thick is not filled; what the camera sees of its sides has to tell.
TEST_F(Horizons, WithLayersACornerIsAsRaysHaveIt) {
    const auto corner = joined(parallelogram({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}),
                               parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}));
    const auto images = seen(corner, lookingAt({0, 0.4f, 2.2f}, {0, -0.4f, 0}), byLayers);
    EXPECT_LE(difference(images[0], images[1]).rms, 0.05);
}

// Thin things before each other: no constant thickness comes as near to rays as what layers tell.
TEST_F(Horizons, WithLayersTheTowerIsNearerToRays) {
    const Scene scene = loadScene("builtin:tower?detail=0.2");
    const auto error = [&](std::vector<std::string> settings) {
        settings.insert(settings.end(), {"horizons.method=bitmask", "horizons.slices=8", "horizons.steps=16",
                                         "map.collection=reservoir", "map.layers_per_texel=4",
                                         "map.max_count=8", "map.divisor=2"});
        RenderOptions options;
        options.camera = "outside";
        Renderer made = renderer(graph(settings), scene, options, {240, 135, 1});
        made.frame();
        const Image seen = made.read({"horizons", "visibility"}), truth = made.read({"rays", "visibility"}),
                    mask = convertChannels(made.read({"gbuffer", "coverage"}), 1);
        double sum = 0, count = 0;
        for (size_t i = 0; i < mask.values.size(); ++i)
            if (mask.values[i] > 0) {
                sum += std::pow(double{seen.values[i]} - double{truth.values[i]}, 2);
                ++count;
            }
        EXPECT_GT(count, 1000);
        return sum / count;
    };
    double best = 1;
    for (const char* thickness : {"0.05", "0.1", "0.2", "0.4"})
        best = std::min(best, error({fmt::format("horizons.thickness={}", thickness)}));
    const double layers = error({"horizons.thickness_from=layers"});
    RecordProperty("best constant", fmt::format("{}", best));
    RecordProperty("layers", fmt::format("{}", layers));
    EXPECT_LE(layers, 0.75 * best) << layers << " " << best; // measured 0.70
}

// Whoever gives the layers: all of them by rays or by drawing the scene are the same, and the second alone
// lacks the others.
TEST_F(Horizons, LayersComeFromWhoeverGivesThem) {
    const Scene scene = loadScene("builtin:tower?detail=0.2");
    const auto image = [&](const std::vector<std::string>& settings) {
        std::vector<std::string> all = {"horizons.thickness_from=layers",
                                        "sd_map.divisor=1",
                                        "sd_map.collection=k_buffer",
                                        "sd_map.layers_per_texel=8",
                                        "sd_map.max_count=0",
                                        "raster_sd_map.divisor=1",
                                        "raster_sd_map.collection=k_buffer",
                                        "raster_sd_map.layers_per_texel=8"};
        all.insert(all.end(), settings.begin(), settings.end());
        RenderOptions options;
        options.camera = "outside";
        return render(shippedGraph("horizon_ao", all), scene, {"blur", "result"}, 1, options, {160, 90, 1});
    };
    const Image rays = image({}), drawn = image({"horizons.layers=raster_sd_map.layers"}),
                second = image({"horizons.layers=second_depth.layers"}),
                none = image({"horizons.thickness_from=constant", "horizons.thickness=0.1"});
    // Rays and rasterizer fall to different sides of edges.
    EXPECT_LE(difference(rays, drawn).rms, 0.01);
    EXPECT_GT(difference(rays, second).rms, 0.01);
    EXPECT_GT(difference(rays, none).rms, difference(rays, second).rms);
}

// Without depths behind the first surface the layers' form is that of a constant thickness of half the way to
// the sample: with one step a side the same for all pixels of a diagonal of the pattern.
TEST_F(Horizons, AnEmptyMapLeavesTheThicknessOfTheFirstSurface) {
    const auto corner = joined(parallelogram({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}),
                               parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}));
    const auto image = [&](std::vector<std::string> settings) {
        settings.insert(settings.end(), {"horizons.steps=1", "horizons.radius=0.4"});
        Graph made = graph(settings);
        made.outputs.push_back({{"map", "depths"}, {}});
        Renderer renders = renderer(made, trianglesScene(corner), {}, {96, 64, 1});
        renders.setFreeCamera(lookingAt({0, 0.4f, 2.2f}, {0, -0.4f, 0}));
        renders.frame();
        for (const int layers : {0, 1})
            for (const float depth : renders.read({"map", "depths"}, layers).values)
                EXPECT_EQ(depth, 3.0e38f);
        return renders.read({"horizons", "visibility"});
    };
    const Image layers = image(byLayers);
    double largest = 0;
    for (int diagonal = 0; diagonal < 4; ++diagonal) {
        const double thickness = 0.5 * 0.4 * (diagonal + 0.5) / 4;
        const Image constant =
            image({"horizons.method=bitmask", fmt::format("horizons.thickness={}", thickness)});
        int different = 0;
        for (int y = 0; y < layers.height; ++y)
            for (int x = 0; x < layers.width; ++x) {
                const int up = layers.height - 1 - y;
                const double by = std::abs(double{layers.at(x, y)} - double{constant.at(x, y)});
                if (((up - x) & 3) == diagonal)
                    different += by > 1e-3 ? 1 : 0;
                else
                    largest = std::max(largest, by);
            }
        // Where a sector's edge falls to the other side by rounding.
        EXPECT_LE(different, 16) << diagonal;
    }
    EXPECT_GT(largest, 0.05);
}

// Two fins stand on a wall with the eye in their planes: they cover no pixel, and rays through the middle
// pass along them. What is farther off than the radius is open, up to the picture's border.
TEST_F(Horizons, WithLayersEdgeOnSurfacesAreFiniteAndLeaveNoBorder) {
    auto fins = parallelogram({-6, -4, -3}, {12, 0, 0}, {0, 8, 0});
    fins = joined(fins, parallelogram({0, -0.6f, -3}, {0, 0, 1}, {0, 1.2f, 0}));
    fins = joined(fins, parallelogram({-0.6f, 0, -3}, {1.2f, 0, 0}, {0, 0, 1}));
    for (const char* divisor : {"map.divisor=1", "map.divisor=4"})
        for (const char* jitter : {"map.jitter=false", "map.jitter=true"}) {
            std::vector<std::string> settings = byLayers;
            settings.insert(settings.end(), {divisor, jitter, "horizons.radius=0.25"});
            RenderOptions options;
            options.checkFinite = true;
            const Extent size{97, 65, 1}; // the middle of a pixel lies on the axis
            Renderer made = renderer(graph(settings), trianglesScene(fins), options, size);
            // Half way from the wall to the fins' ends lies the scene's middle.
            made.setFreeCamera(lookingAt({0, 0, 2.5f}, {0, 0, 0}));
            made.frame();
            const Image image = made.read({"horizons", "visibility"});
            const double perPixel = 2 * std::tan(0.4) / size.height;
            int open = 0;
            for (int y = 0; y < image.height; ++y)
                for (int x = 0; x < image.width; ++x) {
                    const double right = std::abs(x + 0.5 - size.width / 2.0) * perPixel,
                                 up = std::abs(y + 0.5 - size.height / 2.0) * perPixel;
                    const float value = image.at(x, y);
                    ASSERT_TRUE(value >= 0 && value <= 1);
                    // From the fins' ends, which reach to 0.6 at a depth of 2, and the wall at 3.
                    if (std::max(right, up) < 0.3 + 0.13 + 4 * perPixel) continue;
                    EXPECT_GT(value, 0.98f) << x << " " << y << " " << divisor << " " << jitter;
                    ++open;
                }
            EXPECT_GT(open, 300);
        }
}

// A pixel at the border is as in a frame that is wider by whole tiles of the pattern.
TEST_F(Horizons, WithLayersABorderPixelIsAsInALargerFrame) {
    const Scene scene = loadScene("builtin:tower?detail=0.2");
    const int more = 32, border = 8;
    const Extent small{112, 64, 1}, large{small.width + 2 * more, small.height + 2 * more, 1};
    const auto image = [&](const Extent& size) {
        Graph made = shippedGraph(
            "horizon_ao", {"horizons.thickness_from=layers", "horizons.radius=0.5", "horizons.exponent=1"});
        made.outputs = {{{"horizons", "visibility"}, {}}};
        RenderOptions options;
        options.size = size;
        Renderer renders(made, shipped(), scene, context().capabilities(), options);
        CameraState state = cameraAt(scene, cameraIndex(scene, "above"), 0);
        const auto heights = static_cast<float>(size.height) / static_cast<float>(small.height);
        state.verticalFov = 2 * std::atan(std::tan(state.verticalFov / 2) * heights);
        renders.setFreeCamera(state);
        renders.frame();
        return renders.read({"horizons", "visibility"});
    };
    const Image alone = image(small), around = image(large);
    int pixels = 0, far = 0, occluded = 0;
    for (int y = 0; y < alone.height; ++y)
        for (int x = 0; x < alone.width; ++x) {
            if (std::min({x, y, alone.width - 1 - x, alone.height - 1 - y}) >= border) continue;
            ++pixels;
            occluded += alone.at(x, y) < 0.9f ? 1 : 0;
            far += std::abs(alone.at(x, y) - around.at(x + more, y + more)) > 0.02f ? 1 : 0;
        }
    RecordProperty("far", fmt::format("{} of {}", far, pixels));
    EXPECT_LE(far, pixels / 100);
    EXPECT_GT(occluded, pixels / 40);
}

TEST_F(Horizons, LayersMustBeConnected) {
    std::vector<std::string> settings = byLayers;
    settings.emplace_back("horizons.layers=");
    try {
        renderer(graph(settings), trianglesScene(square()));
        FAIL();
    } catch (const InputError& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("`thickness_from` layers needs it connected"), std::string::npos) << message;
    }
}

} // namespace
} // namespace kestrel::test
