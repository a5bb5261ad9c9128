// Every shipped graph still gives the picture that was looked at and kept. After a change that is meant to
// change pictures, run this test with KESTREL_UPDATE_GOLDEN=1, look at tests/golden/, and commit what is
// right.
#include "image/io.h"
#include "shipped_fixture.h"
#include "support/folders.h"
#include <cstdlib>

namespace kestrel::test {
namespace {

struct Golden : ShippedTest, testing::WithParamInterface<std::string> {};

// Small and short: the reference passes with few rays, which is all that a picture of the same seed needs.
Graph shortened(const std::string& name) {
    Graph graph = shippedGraph(name);
    for (const GraphPass& pass : Graph(graph).passes) {
        const PassType* type = shipped().find(pass.type);
        if (type != nullptr && type->property("samples") != nullptr && pass.type.starts_with("Reference"))
            applySetting(graph, shipped(), pass.name + ".samples=4");
    }
    return graph;
}

// 8-bit values: what does not fit into them (positions, light above 1) is clamped on both sides alike.
Image asStored(const Image& image) {
    return decodeImage(encodeImage(image, ImageFormat::Png, Encoding::Linear), "rendered");
}

TEST_P(Golden, ThePictureIsTheOneThatWasKept) {
    const Graph graph = shortened(GetParam());
    for (const GraphPass& pass : graph.passes)
        if (shipped().find(pass.type) == nullptr) GTEST_SKIP() << "this build has no " << pass.type;
    const bool asked = graph.sceneSource.find('?') != std::string::npos;
    Renderer made =
        renderer(graph, loadScene(graph.sceneSource + (asked ? "&" : "?") + "detail=0.1"), {}, {128, 72, 1});
    for (int i = 0; i < 2; ++i) made.frame();
    for (const GraphOutput& output : graph.outputs) {
        if (made.desc(output.port).kind != ResourceKind::Texture2D) continue;
        const std::filesystem::path file =
            test::sourceFolder() / "tests/golden" / (GetParam() + "." + output.port.text() + ".png");
        const Image now = asStored(made.read(output.port));
        if (std::getenv("KESTREL_UPDATE_GOLDEN") != nullptr) {
            writeImage(file, now, Encoding::Linear);
            continue;
        }
        ASSERT_TRUE(std::filesystem::exists(file)) << file << " is missing: see the head of this test";
        const Image kept = readImage(file);
        ASSERT_EQ(now.sizeText(), kept.sizeText());
        ASSERT_EQ(now.channels, kept.channels);
        // Another driver rounds otherwise: everywhere by half a code value (rms), and where an edge or a ray
        // falls on the other side by anything, but in few pixels.
        double squares = 0, far = 0;
        for (size_t i = 0; i < now.values.size(); ++i) {
            const double d = std::abs(double{now.values[i]} - double{kept.values[i]});
            squares += std::min(d, 0.02) * std::min(d, 0.02);
            far += d > 0.02 ? 1 : 0;
        }
        const auto count = static_cast<double>(now.values.size());
        EXPECT_LE(std::sqrt(squares / count), 0.004) << output.port.text();
        EXPECT_LE(far / count, 0.01) << output.port.text();
    }
}

std::string testName(const testing::TestParamInfo<std::string>& info) { return info.param; }

INSTANTIATE_TEST_SUITE_P(Graphs, Golden, testing::ValuesIn(shippedGraphNames()), testName);

} // namespace
} // namespace kestrel::test
