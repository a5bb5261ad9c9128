// Image: a picture from a file goes through a graph as it is, as a captured buffer and as a reference.
#include "image/io.h"
#include "shipped_fixture.h"
#include "support/temporary_folder.h"
#include <chrono>
#include <gmock/gmock.h>
#include <limits>

namespace kestrel::test {
namespace {

using testing::HasSubstr;

struct ImageFiles : ShippedTest {
    TemporaryFolder folder;

    // A graph file in the folder whose Image reads `file`.
    [[nodiscard]] Graph graphOf(const std::string& file, const std::string& values = "auto") const {
        const std::filesystem::path path = folder.path() / "graph.json";
        writeFile(path, fmt::format(R"({{
  "kestrel": 1,
  "passes": {{
    "truth": {{ "type": "Image", "properties": {{ "file": "{}", "values": "{}" }} }}
  }},
  "edges": [],
  "outputs": ["truth.image"]
}})",
                                    file, values));
        return loadGraph(path);
    }
    [[nodiscard]] Image read(const std::string& file, const std::string& values = "auto") const {
        return render(graphOf(file, values), trianglesScene(square()), {"truth", "image"});
    }
    [[nodiscard]] std::string mistake(const std::string& file) const {
        try {
            static_cast<void>(read(file));
        } catch (const Error& error) {
            return error.problems().front().text();
        }
        return {};
    }
    // Values that no rounding keeps by chance.
    static Image picture(int width, int height, int channels) {
        Image image(width, height, channels);
        for (size_t i = 0; i < image.values.size(); ++i)
            image.values[i] = std::sin(static_cast<float>(i)) * std::exp2(static_cast<float>(i % 40) - 20);
        return image;
    }
};

TEST_F(ImageFiles, AnExrComesThroughToTheBitInItsOwnSize) {
    Image one = picture(7, 5, 1), four = picture(31, 17, 4);
    one.at(3, 2) = std::numeric_limits<float>::infinity();
    writeImage(folder.path() / "one.exr", one, Encoding::Linear);
    writeImage(folder.path() / "four.exr", four, Encoding::Linear);
    EXPECT_EQ(read("one.exr"), one);
    EXPECT_EQ(read("four.exr"), four);
    // Three channels get an opaque fourth.
    const Image three = picture(9, 4, 3);
    writeImage(folder.path() / "three.exr", three, Encoding::Linear);
    const Image opaque = read("three.exr");
    ASSERT_EQ(opaque.channels, 4);
    EXPECT_EQ(convertChannels(opaque, 3), three);
    EXPECT_EQ(opaque.at(8, 3, 3), 1);
    // Also by its whole path.
    EXPECT_EQ(read((folder.path() / "one.exr").string()), one);
}

// What `render` writes of linear colours is read back as them: code values go both ways by the same curve.
TEST_F(ImageFiles, ColoursOfAPngAreLinearAgain) {
    Image codes(16, 16, 3);
    for (size_t i = 0; i < codes.values.size(); ++i) codes.values[i] = static_cast<float>(i % 256) / 255;
    writeImage(folder.path() / "c.png", codes, Encoding::Linear);
    const Image linear = convertChannels(read("c.png"), 3);
    for (size_t i = 0; i < codes.values.size(); ++i)
        EXPECT_NEAR(linear.values[i], srgbToLinear(codes.values[i]), 1e-6f);
    EXPECT_EQ(convertChannels(read("c.png", "as_they_are"), 3), readImage(folder.path() / "c.png"));
    // A grey picture is data: visibility, depth.
    const Image grey = convertChannels(codes, 1);
    writeImage(folder.path() / "g.png", grey, Encoding::Linear);
    EXPECT_EQ(read("g.png"), readImage(folder.path() / "g.png"));
    // EXR values stay, unless one says that they are codes.
    writeImage(folder.path() / "c.exr", codes, Encoding::Linear);
    EXPECT_EQ(convertChannels(read("c.exr"), 3), codes);
    EXPECT_NEAR(read("c.exr", "from_srgb").at(5, 5, 0), srgbToLinear(codes.at(5, 5, 0)), 1e-6f);
}

TEST_F(ImageFiles, MistakesAreToldAtCheckTimeWithTheirPlace) {
    EXPECT_THAT(mistake("none.exr"), HasSubstr("graph.json:4:"));
    EXPECT_THAT(mistake("none.exr"), HasSubstr("pass 'truth' (Image), 'file': "));
    EXPECT_THAT(mistake("none.exr"), HasSubstr((folder.path() / "none.exr").string()));
    EXPECT_THAT(mistake(""), HasSubstr("names no file"));
    writeFile(folder.path() / "text.png", "no picture");
    EXPECT_THAT(mistake("text.png"), HasSubstr("text.png"));
    const Image wide(20'000, 1, 1);
    writeImage(folder.path() / "wide.exr", wide, Encoding::Linear);
    EXPECT_THAT(mistake("wide.exr"), HasSubstr("20000x1"));
}

// Another program writes the file while it is in use.
TEST_F(ImageFiles, AFileThatIsWrittenAnewIsTakenOver) {
    const std::filesystem::path file = folder.path() / "p.exr";
    auto write = [&, later = 0](const Image& image) mutable {
        writeImage(file, image, Encoding::Linear);
        // The clock of a file system may stand for some milliseconds.
        std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) +
                                                   std::chrono::seconds(++later));
    };
    const Image first = picture(7, 5, 1), second = picture(1, 35, 1), third = picture(9, 4, 4);
    Image same(7, 5, 1);
    write(first);
    Renderer made = renderer(graphOf("p.exr"), trianglesScene(square()));
    const auto now = [&] {
        made.frame();
        return made.read({"truth", "image"});
    };
    EXPECT_EQ(now(), first);
    EXPECT_FALSE(made.reloadIfChanged());
    for (const Image& image : {same, second, third}) {
        write(image);
        EXPECT_TRUE(made.reloadIfChanged());
        EXPECT_EQ(now(), image);
        EXPECT_FALSE(made.reloadIfChanged());
    }
    // Half a file is told once, beside the last picture.
    writeFile(file, "half");
    EXPECT_THROW(made.reloadIfChanged(), InputError);
    EXPECT_EQ(now(), third);
    made.restart();
    EXPECT_EQ(now(), third);
    EXPECT_FALSE(made.reloadIfChanged());
    write(first);
    EXPECT_TRUE(made.reloadIfChanged());
    EXPECT_EQ(now(), first);
    // A graph that was refused for want of its file is none's picture, but its file is looked for.
    EXPECT_THROW(made.setGraph(graphOf("q.exr")), InputError);
    EXPECT_FALSE(made.reloadIfChanged());
    writeImage(folder.path() / "q.exr", same, Encoding::Linear);
    EXPECT_TRUE(made.reloadIfChanged());
    EXPECT_EQ(now(), first);
}

// Another renderer's picture as the reference of ErrorMeasure: the error is that of `compare`; another size
// is refused with both.
TEST_F(ImageFiles, AFileIsAReference) {
    const Graph ao = shippedGraph("ray_ao");
    const Image truth = render(ao, loadScene("builtin:blob?detail=0.02"), {"mean", "result"}, 8);
    writeImage(folder.path() / "truth.exr", truth, Encoding::Linear);
    Graph graph = ao;
    for (const auto& [name, type] :
         {std::pair<std::string, std::string>{"truth", "Image"}, {"error", "ErrorMeasure"}}) {
        GraphPass pass;
        pass.name = name;
        pass.type = type;
        pass.where.file = (folder.path() / "graph.json").string();
        graph.passes.push_back(pass);
    }
    for (const char* setting : {"truth.file=truth.exr", "error.reference=truth.image",
                                "error.test=mean.result", "error.range=high"})
        applySetting(graph, shipped(), setting);
    graph.outputs.push_back({{"error", "heat_map"}, {}});
    Renderer made = renderer(graph, loadScene("builtin:blob?detail=0.02"));
    made.frame();
    EXPECT_GT(made.last().values.at("error").at("mse"), 0);
    for (int i = 1; i < 8; ++i) made.frame();
    EXPECT_EQ(made.last().values.at("error").at("mse"), 0);
    try {
        renderer(graph, loadScene("builtin:blob?detail=0.02"), {}, {64, 36, 1});
        ADD_FAILURE() << "another size was taken";
    } catch (const InputError& error) {
        EXPECT_THAT(error.problems().front().text(), HasSubstr("96x54"));
        EXPECT_THAT(error.problems().front().text(), HasSubstr("64x36"));
    }
}

// A captured G-buffer in the place of the pass that made it: what is computed from it is the same.
TEST_F(ImageFiles, ACapturedBufferTakesThePlaceOfItsPass) {
    const Graph ao = shippedGraph("hbao_interleaved");
    Graph captured = ao;
    Renderer made = renderer(ao, loadScene("builtin:blob?detail=0.02"));
    made.frame();
    std::map<PortRef, std::string> passes;
    for (GraphEdge& edge : captured.edges) {
        if (edge.from.pass != "gbuffer") continue;
        std::string& name = passes[edge.from];
        if (name.empty()) {
            name = "captured_" + edge.from.port;
            GraphPass pass;
            pass.name = name;
            pass.type = "Image";
            pass.properties = {{"file", (folder.path() / (edge.from.port + ".exr")).string()},
                               {"guard", std::int64_t{64}}}; // as the pass has it
            captured.passes.push_back(pass);
        }
        edge.from = {name, "image"};
    }
    ASSERT_FALSE(passes.empty());
    RenderOptions options;
    for (const auto& [port, name] : passes) options.previews.push_back(port);
    Renderer seen = renderer(ao, loadScene("builtin:blob?detail=0.02"), options);
    seen.frame();
    for (const auto& [port, name] : passes)
        writeImage(folder.path() / (port.port + ".exr"), seen.read(port), Encoding::Linear);
    Renderer again = renderer(captured, loadScene("builtin:blob?detail=0.02"));
    again.frame();
    const PortRef output = ao.outputs.front().port;
    EXPECT_EQ(again.read(output), made.read(output));
}

} // namespace
} // namespace kestrel::test
