// ErrorMeasure: its heat map stays between measurements, and is gone with what it was measured of.
#include "shipped_fixture.h"
#include <algorithm>

namespace kestrel::test {
namespace {

struct ErrorMeasured : ShippedTest {};

TEST_F(ErrorMeasured, TheHeatMapStaysUntilTheNextMeasurement) {
    Graph graph = shippedGraph("compare_ao", {"error.interval=4"});
    for (const GraphPass& pass : graph.passes)
        if (shipped().find(pass.type) == nullptr) GTEST_SKIP() << "this build has no " << pass.type;
    applySetting(graph, shipped(), "reference.samples=2");
    Renderer made = renderer(graph, loadScene("builtin:blob?detail=0.02"), {}, {32, 18, 1});
    // Frames in which it is there, from one change to the next.
    const auto expect = [&](int frames) {
        Image last;
        for (int frame = 1; frame <= frames; ++frame) {
            made.frame();
            const Image map = made.read({"error", "heat_map"});
            const bool black =
                std::ranges::none_of(map.values, [](float value) { return value > 0 && value < 1; });
            EXPECT_EQ(black, frame < 4) << frame;
            if (frame > 4 && frame % 4 != 0) {
                EXPECT_EQ(map, last) << frame;
            }
            last = map;
        }
    };
    expect(11);
    CameraState camera = cameraAt(made.scene(), made.scene().camera, 0);
    camera.verticalFov *= 0.9f;
    made.setFreeCamera(camera);
    expect(7);
}

} // namespace
} // namespace kestrel::test
