// How the window looks, and that all of it can be done by keys. After a change that is meant to be seen, run
// this test with KESTREL_UPDATE_GOLDEN=1, look at tests/golden/editor_*.png, and commit what is right.
#include "edit/properties.h"
#include "editor_window_fixture.h"
#include <set>

namespace kestrel::edit {
namespace {

using namespace test;
using testing::Contains;
using testing::Not;

class EditorLook : public EditorWindow {
protected:
    void TearDown() override {
        EditorWindow::TearDown();
        *theme_ = Theme();
    }
    // The status line tells times, which no picture keeps.
    static Image withoutStatus(Image image, int rows) {
        image.height -= rows;
        image.values.resize(image.pixelCount() * static_cast<size_t>(image.channels));
        return image;
    }
    void expectAsKept(const std::string& name) {
        person_->moveTo({-50, -50});
        person_->wait(3);
        const Image seen =
            withoutStatus(window_->screenshot(), static_cast<int>(ImGui::GetFontSize() * 1.5f) + 8);
        const std::filesystem::path file = sourceFolder() / "tests/golden" / ("editor_" + name + ".png");
        if (std::getenv("KESTREL_UPDATE_GOLDEN") != nullptr) return writeImage(file, seen, Encoding::Linear);
        ASSERT_TRUE(std::filesystem::exists(file)) << file << " is missing: see the head of this test";
        const Image kept = readImage(file);
        ASSERT_EQ(kept.sizeText(), seen.sizeText());
        // Another FreeType or driver smooths letters otherwise; what moved or is another colour is more than
        // that.
        size_t far = 0;
        for (size_t i = 0; i < seen.values.size(); ++i)
            far += std::abs(seen.values[i] - kept.values[i]) > 0.15f ? 1 : 0;
        const bool alike = static_cast<double>(far) <= 0.01 * static_cast<double>(seen.values.size());
        EXPECT_TRUE(alike) << far << " of " << seen.values.size() << " values are others than in " << file;
        if (!alike)
            writeImage(folder_.path().parent_path() / ("editor_" + name + ".png"), seen, Encoding::Linear);
    }
    void select(const char* pass) {
        person_->press("Ctrl+F");
        choose(pass);
        person_->wait(2);
    }
};

TEST_F(EditorLook, Dark) {
    select("ao");
    expectAsKept("dark");
}

// A frame draws what it changes: nothing at rest, little where the pointer moves, and never a picture that is
// another than one drawn whole.
TEST_F(EditorLook, OnlyWhatChangesIsDrawn) {
    const auto whole = [&] {
        const Image seen = window_->screenshot();
        window_->drawAgain();
        return window_->screenshot() == seen;
    };
    const auto drawn = [&](const std::function<void()>& done) {
        const std::uint64_t before = window_->drawnPixels();
        done();
        return window_->drawnPixels() - before;
    };
    person_->moveTo({-50, -50});
    person_->rest();
    person_->wait(3);
    EXPECT_EQ(drawn([&] { person_->wait(5); }), 0u);
    EXPECT_TRUE(whole());
    const Image before = window_->screenshot();
    const auto all = static_cast<std::uint64_t>(before.width) * static_cast<std::uint64_t>(before.height);
    // A pass that is chosen: its outline, its wires, its properties.
    person_->click(person_->box("ao"));
    person_->wait(3);
    EXPECT_TRUE(whole());
    EXPECT_NE(window_->screenshot(), before);
    // The pointer comes to a slider, which lights up.
    person_->moveTo({-50, -50});
    person_->wait(3);
    const glm::dvec2 slider = editor_->properties().middles.at("distance");
    const std::uint64_t hovered = drawn([&] { person_->moveTo(slider); });
    EXPECT_GT(hovered, 0u);
    EXPECT_LT(hovered, all / 20);
    EXPECT_TRUE(whole());
    // The picture becomes another: no more than its panel and the line of the state are drawn.
    session_->setOwnCamera(*session_->movableCamera());
    const std::uint64_t seen = drawn([&] { person_->frame(); });
    EXPECT_GT(seen, 0u);
    EXPECT_LT(seen, all / 2);
    EXPECT_TRUE(whole());
    // A list that opens over all of it, and closes.
    person_->press("F1");
    EXPECT_TRUE(whole());
    person_->press("Esc");
    person_->wait(3);
    EXPECT_TRUE(whole());
    // Another size is drawn whole.
    EXPECT_GE(drawn([&] { resizeTo({900, 600, 1}); }), std::uint64_t{900} * 600);
    EXPECT_TRUE(whole());
}

TEST_F(EditorLook, Light) {
    select("ao");
    person_->press("F8");
    EXPECT_FALSE(theme_->dark);
    expectAsKept("light");
    person_->press("F8");
}

TEST_F(EditorLook, TwiceAsLarge) {
    const float before = ImGui::GetFontSize();
    theme_->scale = 2 / 1.25f;
    person_->press("Ctrl+=");
    select("ao");
    EXPECT_NEAR(ImGui::GetFontSize(), 2 * before, 1);
    expectAsKept("twice_as_large");
    for (int i = 0; i < 3; ++i) person_->press("Ctrl+-");
    EXPECT_NEAR(theme_->scale, 2 / (1.25f * 1.25f * 1.25f), 1e-4f);
    theme_->scale = 1.25f;
    person_->press("Ctrl+-");
}

// No key twice, and every action by its key or by name in the palette; the page of shortcuts has them all.
TEST_F(EditorLook, EveryActionHasAKeyOrAName) {
    std::set<std::string> keys, names;
    size_t without = 0;
    for (const Action& action : editor_->actions().all()) {
        EXPECT_TRUE(names.insert(action.menu + action.name).second) << action.name;
        if (action.key.key == 0) {
            ++without;
            continue;
        }
        EXPECT_EQ(chordOf(chordText(action.key)), action.key) << action.name;
        EXPECT_TRUE(keys.insert(chordText(action.key)).second) << chordText(action.key) << " is there twice";
    }
    EXPECT_LE(without, names.size() / 10);
    // By name: what has no key, and one that has.
    person_->press("Ctrl+P");
    EXPECT_TRUE(editor_->palette().isOpen());
    choose("Write the camera into");
    EXPECT_TRUE(session_->document.graph().sceneSetup.camera.has_value());
    EXPECT_EQ(session_->document.undoName(), "Camera into the graph");
    person_->press("Ctrl+P");
    choose("Undo");
    EXPECT_FALSE(session_->document.modified());
    person_->press("F1");
    person_->wait(2);
    look("shortcuts");
    person_->press("F1");
}

// A day without a mouse: passes, wires, properties, the picture.
TEST_F(EditorLook, AllOfItByKeysAlone) {
    select("gbuffer");
    person_->press("Right");
    EXPECT_EQ(editor_->canvas.selection, Names{"ao"});
    // The first property takes the keyboard; typing sets it.
    person_->press("Enter");
    person_->wait(3);
    person_->type("7");
    person_->press("Enter");
    EXPECT_EQ(
        std::get<std::int64_t>(propertyValue(*session_->document.graph().find("ao"),
                                             *allPasses().find("RayAmbientOcclusion")->property("rays"))),
        7);
    person_->press("Esc");
    person_->wait(3);
    // Wires.
    select("ao");
    person_->press("Shift+K");
    choose("roma.tracer -> ao.tracer");
    EXPECT_THAT(edges(), Not(Contains("roma.tracer -> ao.tracer")));
    person_->press("K");
    choose("bvh.tracer -> ao.tracer");
    EXPECT_THAT(edges(), Contains("bvh.tracer -> ao.tracer"));
    // Places.
    person_->press("Ctrl+Shift+Down");
    ASSERT_TRUE(session_->document.graph().find("ao")->position.has_value());
    // Which port is an output, which is seen and how.
    person_->press("O");
    choose("visibility");
    EXPECT_EQ(session_->document.graph().outputs.size(), 2u);
    person_->press("V");
    choose("visibility");
    EXPECT_EQ(editor_->viewport.a, (PortRef{"ao", "visibility"}));
    person_->press("D");
    EXPECT_EQ(editor_->viewport.development.mode, Development::Mode::Display);
    person_->press("Tab");
    person_->press("Tab");
    EXPECT_EQ(editor_->viewport.layout, Viewport::Layout::Slider);
    const float slider = editor_->viewport.slider;
    person_->press("]");
    EXPECT_GT(editor_->viewport.slider, slider);
    person_->press("I");
    person_->type("3 4");
    person_->press("Enter");
    EXPECT_EQ(editor_->viewport.pixel(), (std::pair{3, 4}));
    const double zoom = editor_->canvas.view.zoom;
    person_->press("=");
    EXPECT_GT(editor_->canvas.view.zoom, zoom);
}

} // namespace
} // namespace kestrel::edit
