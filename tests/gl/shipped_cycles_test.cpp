// Kestrel's references against the figures of a second tracer: tests/golden/cycles.json, which
// tests/external/cycles.py wrote. Its rows say what was rendered.
#include "scene/builtin.h"
#include "scene/setup.h"
#include "shipped_fixture.h"
#include "support/folders.h"
#include <nlohmann/json.hpp>

namespace kestrel::test {
namespace {

using Json = nlohmann::json;

// What cycles.py makes of a scene: without its own lights and emission, so that what shines is what the row
// adds.
Scene sceneOf(const Json& row) {
    SceneSetup setup;
    setup.camera = parseCamera(row["camera"].dump(), "cycles.json");
    for (const Json& light : row.value("lights", Json::array()))
        setup.lights.push_back(parseLight(light.dump(), "cycles.json"));
    const std::string source = row["scene"];
    if (!isBuiltin(source)) return loadScene(source, sourceFolder() / "tests" / "golden", {}, setup);
    Scene scene = builtinScene(source);
    scene.lights.clear();
    for (Node& node : scene.nodes) node.light = -1;
    for (Material& material : scene.materials) material.emission = glm::vec3(0);
    setUpScene(scene, setup, {});
    return scene;
}

struct SecondTracer : ShippedTest {};

TEST_F(SecondTracer, AgreesWithEveryReference) {
    if (shipped().find("ReferenceIndirectDiffuse") == nullptr) GTEST_SKIP() << "Embree is not built in";
    const Json stored = Json::parse(readText(sourceFolder() / "tests" / "golden" / "cycles.json"));
    constexpr int block = 10;
    const Extent size{160, 90, 1};
    EXPECT_GE(stored["rows"].size(), 13u);
    for (const Json& row : stored["rows"]) {
        std::vector<std::string> settings;
        for (std::string setting : row.value("set", Json::array())) {
            if (const size_t at = setting.find("SAMPLES"); at != std::string::npos)
                setting.replace(at, 7, "64");
            settings.push_back(setting);
        }
        Graph graph =
            shippedGraph(std::filesystem::path(row["graph"].get<std::string>()).stem().string(), settings);
        const PortRef port = *parsePortRef(row["port"].get<std::string>());
        const PortRef mask = *parsePortRef(row.value("mask", "gbuffer.coverage"));
        const int maskChannel = row.contains("mask") ? 1 : 0; // of the material: what is metallic
        graph.outputs = {{port, {}}, {mask, {}}};
        Renderer made = renderer(graph, sceneOf(row), {}, size);
        made.frame();
        const Image light = made.read(port), where = made.read(mask);

        double ours = 0, theirs = 0, square = 0;
        int count = 0;
        const Json& blocks = row["blocks"];
        ASSERT_EQ(blocks.size(), 16u * 9u);
        for (int i = 0; i < 16 * 9; ++i) {
            if (blocks[static_cast<size_t>(i)].is_null()) continue;
            for (int k = 0; k < 3; ++k) {
                double sum = 0, pixels = 0;
                for (int y = i / 16 * block; y < (i / 16 + 1) * block; ++y)
                    for (int x = i % 16 * block; x < (i % 16 + 1) * block; ++x) {
                        if (!(where.at(x, y, maskChannel) > 0)) continue;
                        sum += double{light.at(x, y, std::min(k, light.channels - 1))};
                        pixels += 1;
                    }
                ASSERT_GE(pixels, block * block / 2);
                const double truth = blocks[static_cast<size_t>(i)][static_cast<size_t>(k)];
                ours += sum / pixels;
                theirs += truth;
                square += std::pow(sum / pixels - truth, 2);
                ++count;
            }
        }
        ASSERT_GT(count, 3 * 20);
        ASSERT_GT(theirs, 0);
        const std::string name = row["name"].get<std::string>() + ", " + row["scene"].get<std::string>();
        // With 64 samples in place of 512 noise leaves up to 0.005 and 0.025.
        EXPECT_NEAR(ours / theirs, 1, 0.01) << name;
        EXPECT_LT(std::sqrt(square * count) / theirs, 0.03) << name;
        RecordProperty(name, fmt::format("{:.4f} {:.4f}", ours / theirs, std::sqrt(square * count) / theirs));
    }
}

} // namespace
} // namespace kestrel::test
