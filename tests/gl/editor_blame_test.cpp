// (B) From a wrong pixel to the pass that made it: ten faults, each put into a wire of a shipped graph as a
// pass that spoils a square of what goes through it.
#include "blame.h"
#include "editor_window_fixture.h"
#include "execute/commands.h"
#include <limits>

namespace kestrel::edit {
namespace {

using namespace test;

struct Spoiled final : Pass {
    enum class Kind { Nan, Infinite, Negative, Black };
    static PassType type() {
        return Describe<Spoiled>("Spoiled", "Hands a texture on but for a square in it")
            .input("source", PortKind::Texture, "What is right")
            .output("result", PortKind::Texture, "What is wrong in places")
            .choice("kind", &Spoiled::kind, {"nan", "infinite", "negative", "black"}, "How")
            .number("from", &Spoiled::from, 0, 1000, "frames", "In which frame it begins");
    }
    [[nodiscard]] Declaration declare(const World&, const Inputs& inputs, const Demand&) const override {
        Declaration declaration;
        declaration.outputs.push_back({.port = "result", .desc = inputs["source"].desc});
        declaration.steps.push_back({.name = "spoil",
                                     .uses = {{.port = "source", .access = Access::Host},
                                              {.port = "result", .access = Access::Copy, .write = true}}});
        declaration.depends = Causes::Properties | Causes::Frame;
        return declaration;
    }
    void execute(const Step&, Commands& commands) override {
        Image image = commands.downloadImage("source");
        const float infinity = std::numeric_limits<float>::infinity();
        const float values[] = {std::numeric_limits<float>::quiet_NaN(), infinity, -4, 0};
        if (commands.frame().index >= static_cast<std::uint32_t>(from))
            for (int y = middle.y - 4; y <= middle.y + 4; ++y)
                for (int x = middle.x - 4; x <= middle.x + 4; ++x)
                    for (int c = 0; c < std::min(image.channels, 3); ++c)
                        image.at(x, y, c) = values[static_cast<size_t>(kind)];
        commands.uploadImage("result", image);
    }
    Kind kind = Kind::Nan;
    int from = 0;
    static inline glm::ivec2 middle{0};
};

const Registry& withSpoiled() {
    static const Registry registry = [] {
        Registry made = allPasses();
        made.add(Spoiled::type());
        return made;
    }();
    return registry;
}

struct Seed {
    const char* graph;
    PortRef input; // whose wire is spoiled
    const char* kind;
    int from; // frame
    PortRef seen;
    int guard = 0; // pixels around the frame of what is spoiled
};
void PrintTo(const Seed& seed, std::ostream* out) {
    *out << seed.graph << " " << seed.input.text() << " " << seed.kind;
}

class EditorBlame : public EditorWindow, public testing::WithParamInterface<Seed> {};

TEST_P(EditorBlame, AClickNamesThePassThatMadeIt) {
    if (window_ == nullptr) GTEST_SKIP();
    const Seed& seed = GetParam();
    start(std::string(seed.graph) + ".json", withSpoiled());
    editor_->viewport.showPort(seed.seen);
    person_->rest();
    // A pixel that is right, the nearest to the middle of the picture.
    std::string why;
    const Image before = session_->read(seed.seen, why);
    ASSERT_FALSE(before.empty()) << why;
    const glm::ivec2 centre(before.width / 2, before.height / 2);
    glm::ivec2 pixel = centre;
    int nearest = std::numeric_limits<int>::max();
    for (int y = 8; y < before.height - 8; ++y)
        for (int x = 8; x < before.width - 8; ++x) {
            const glm::ivec2 way = glm::ivec2(x, y) - centre;
            if (faultAt(before, x, y) != Fault::None || way.x * way.x + way.y * way.y >= nearest) continue;
            nearest = way.x * way.x + way.y * way.y;
            pixel = {x, y};
        }
    ASSERT_LT(nearest, std::numeric_limits<int>::max());
    Spoiled::middle = pixel + seed.guard;

    ASSERT_EQ(session_->apply("Spoil",
                              [&](Graph& graph) {
                                  const std::string name = addPass(graph, withSpoiled(), "Spoiled", {});
                                  applySetting(graph, withSpoiled(), name + ".kind=" + seed.kind);
                                  applySetting(graph, withSpoiled(),
                                               name + ".from=" + std::to_string(seed.from));
                                  insertOnEdge(graph, withSpoiled(), seed.input, name);
                              }),
              "");
    session_->restart();
    person_->rest();
    ASSERT_TRUE(session_->problems().empty()) << session_->problems().front().message;
    const Image wrong = session_->read(seed.seen, why);
    const auto values = [&](const Image& image) {
        const auto first = image.values.begin() + static_cast<std::ptrdiff_t>(image.index(pixel.x, pixel.y));
        return std::vector<float>(first, first + image.channels);
    };
    EXPECT_NE(values(wrong), values(before)) << "nothing is seen of it";
    editor_->viewport.setPixel(pixel.x, pixel.y);
    person_->press("B");
    EXPECT_EQ(editor_->canvas.selection, Names{"spoiled"}) << editor_->messages().back();
    ASSERT_TRUE(editor_->canvas.picked.has_value());
    EXPECT_EQ(editor_->canvas.picked->text(), "spoiled.result");
    person_->rest();
    // What was seen is seen again.
    EXPECT_EQ(faultAt(session_->read(seed.seen, why), pixel.x, pixel.y), faultAt(wrong, pixel.x, pixel.y));
}

INSTANTIATE_TEST_SUITE_P(
    Seeded, EditorBlame,
    testing::Values(Seed{"ray_ao", {"mean", "signal"}, "nan", 0, {"mean", "result"}},
                    Seed{"direct_light", {"direct", "albedo"}, "infinite", 0, {"tone", "image"}},
                    Seed{"soft_shadow", {"mean", "signal"}, "negative", 0, {"mean", "result"}},
                    Seed{"indirect", {"composite", "albedo"}, "black", 0, {"tone", "image"}},
                    Seed{"glossy", {"composite", "direct"}, "nan", 2, {"tone", "image"}},
                    Seed{"denoised_ao", {"denoise", "signal"}, "infinite", 0, {"denoise", "result"}},
                    Seed{"antialiased_ao", {"aa", "colour"}, "black", 0, {"aa", "result"}},
                    Seed{"transparency", {"transparent", "picture"}, "nan", 0, {"tone", "image"}},
                    Seed{"svao", {"blur", "signal"}, "negative", 0, {"blur", "result"}},
                    Seed{"horizon_ao", {"horizons", "view_depth"}, "nan", 0, {"blur", "result"}, 64}),
    [](const auto& each) { return std::string(each.param.graph); });

// An accumulated picture keeps what came up in one frame: that frame is gone back to.
TEST_F(EditorWindow, BlameGoesBackToTheFrameInWhichItCameUp) {
    start("ray_ao.json", withSpoiled());
    EXPECT_EQ(blame(*session_, {"mean", "result"}, 48, 20), std::nullopt);
    Spoiled::middle = {48, 20};
    session_->apply("Spoil", [&](Graph& graph) {
        const std::string name = addPass(graph, withSpoiled(), "Spoiled", {});
        insertOnEdge(graph, withSpoiled(), {"mean", "signal"}, name);
        applySetting(graph, withSpoiled(), name + ".from=3");
    });
    editor_->stopAfter = 6;
    session_->restart();
    person_->rest();
    const auto found = blame(*session_, {"mean", "result"}, 48, 20);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->port.text(), "spoiled.result");
    EXPECT_EQ(session_->renderer()->last().index, 3u);
}

} // namespace
} // namespace kestrel::edit
