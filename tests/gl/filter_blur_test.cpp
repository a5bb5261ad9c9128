// The bilateral blur: what it smooths and where it stops.
#include "depth_source.h"
#include <cmath>

namespace kestrel::test {
namespace {

struct Blur : DepthTest {
    static constexpr Extent size{32, 16, 1};
    // Blurs DepthSource::second by DepthSource::depth.
    static Image blurred(const std::vector<std::string>& settings) {
        Graph graph = parseGraph(R"({"kestrel": 1, "passes": {"signal": {"type": "DepthSource"},
            "depth": {"type": "DepthSource"}, "blur": {"type": "BilateralBlur"}},
            "edges": [["signal.second_depth", "blur.signal"], ["depth.view_depth", "blur.view_depth"]],
            "outputs": ["blur.result"]})",
                                 "test.json");
        for (const std::string& setting : settings) applySetting(graph, registry(), setting);
        GivenRenderer made(graph, size);
        made.frame();
        return made.read({"blur", "result"});
    }
};

TEST_F(Blur, AConstantStaysToTheBit) {
    DepthSource::second = [](int, int) { return 0.3f; };
    DepthSource::depth = [](int x, int y) { return static_cast<float>(1 + x % 3 + y % 5); };
    const float kept = 0.3f;
    for (const float value : blurred({}).values) ASSERT_EQ(value, kept);
}

// Tilted so much that neighbours differ by 2 %, which without the slope counts as an edge.
TEST_F(Blur, ATiltedPlaneIsBlurredAsAFacingOneIs) {
    DepthSource::second = [](int x, int) { return x % 2 == 0 ? 1.0f : 0.0f; };
    DepthSource::depth = [](int, int) { return 2.0f; };
    const Image facing = blurred({});
    EXPECT_NEAR(facing.at(16, 8), 0.5, 0.03);
    DepthSource::depth = [](int x, int) { return 2 + 0.04f * static_cast<float>(x - 16); };
    EXPECT_LE(difference(facing, blurred({})).largest, 2e-3);
    EXPECT_GT(blurred({"blur.slope=false"}).at(16, 8), 0.95);
}

// In perspective it is one over the depth that a plane changes evenly: what its slope leaves is of second
// order.
TEST_F(Blur, APlaneInPerspectiveIsBlurredAsAFacingOneIs) {
    DepthSource::second = [](int x, int y) { return (x + y) % 2 == 0 ? 1.0f : 0.0f; };
    DepthSource::depth = [](int, int) { return 2.0f; };
    const Image facing = blurred({});
    // Neighbours differ by 1 % along x and by half of that along y: at the fourth the weight is less by a
    // twelfth.
    DepthSource::depth = [](int x, int y) {
        return 2 / (1 + 0.01f * static_cast<float>(16 - x) + 0.005f * static_cast<float>(8 - y));
    };
    EXPECT_LE(difference(facing, blurred({})).largest, 0.01);
    EXPECT_GT(difference(facing, blurred({"blur.slope=false"})).largest, 0.2);
}

TEST_F(Blur, AnEdgeOfDepthStopsItAndNothingStaysAsItIs) {
    DepthSource::second = [](int x, int) { return x < 16 ? 1.0f : 0.0f; };
    DepthSource::depth = [](int x, int) { return x < 16 ? 1.0f : 1.5f; };
    const Image stopped = blurred({});
    EXPECT_NEAR(stopped.at(15, 8), 1, 1e-5);
    EXPECT_NEAR(stopped.at(16, 8), 0, 1e-5);
    DepthSource::depth = [](int x, int) { return x < 16 ? 1.0f : 0.0f; };
    EXPECT_EQ(blurred({}).at(16, 8), 0);
    EXPECT_EQ(blurred({}).at(15, 8), 1);
}

// With the depth of a guard band around it the slope at the border is that of the middle.
TEST_F(Blur, ADepthWithAGuardBandIsReadInItsMiddle) {
    DepthSource::second = [](int x, int y) { return (x + y) % 2 == 0 ? 1.0f : 0.0f; };
    DepthSource::depth = [](int x, int y) {
        return x % 8 < 4 ? 1 + 0.01f * static_cast<float>(y) : 3 + 0.02f * static_cast<float>(x);
    };
    const Image without = blurred({}), with = blurred({"depth.guard=8"});
    EXPECT_LE(difference(crop(without, 6, 6, 20, 4), crop(with, 6, 6, 20, 4)).largest, 1e-6);
    EXPECT_LE(difference(without, with).rms, 0.01);
}

} // namespace
} // namespace kestrel::test
