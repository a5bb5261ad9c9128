#include "editor_window_fixture.h"

namespace kestrel::edit {
namespace {

using namespace test;
using testing::Contains;
using testing::Not;

// The task of the README's tour: the tracer is replaced, both are compared by slider and by error, the file
// is saved.
TEST_F(EditorWindow, ATracerIsReplacedComparedAndSavedByKeyboardAlone) {
    look("tour_1_open");
    const Image before = editor_->viewport.image();
    ASSERT_FALSE(before.empty());
    person_->press("Ctrl+F");
    choose("roma");
    EXPECT_EQ(editor_->canvas.selection, Names{"roma"});
    person_->press("H");
    person_->press("W");
    look("tour_2_swap");
    choose("bvh");
    person_->rest();
    EXPECT_THAT(edges(), Contains("bvh.tracer -> ao.tracer"));
    EXPECT_THAT(edges(), Not(Contains("roma.tracer -> ao.tracer")));
    EXPECT_TRUE(session_->problems().empty());
    EXPECT_NE(editor_->viewport.image(), before);
    EXPECT_EQ(editor_->viewport.layout, Viewport::Layout::Slider);
    look("tour_3_compare");
    person_->press("Ctrl+S");
    EXPECT_EQ(person_->actions(), 8);
    // One line of the file is another.
    const std::string saved = readText(file_);
    std::istringstream old(first_), now(saved);
    size_t differing = 0, lines = 0;
    for (std::string a, b; std::getline(old, a) && std::getline(now, b); ++lines) differing += a != b ? 1 : 0;
    EXPECT_EQ(differing, 1u);
    EXPECT_EQ(lines, static_cast<size_t>(std::count(first_.begin(), first_.end(), '\n')));
    EXPECT_FALSE(session_->document.modified());
    // What is left out is said as in the file's own plan.
    EXPECT_NE(session_->leftOut("roma"), "");
}

// With the mouse: the picture is held, one wire moved, the file saved.
TEST_F(EditorWindow, ATracerIsReplacedComparedAndSavedInThreeActions) {
    person_->press("H");
    person_->drag(person_->port("bvh", "tracer"), person_->port("ao", "tracer"));
    person_->press("Ctrl+S");
    EXPECT_EQ(person_->actions(), 3);
    person_->rest();
    EXPECT_THAT(readText(file_), testing::HasSubstr(R"(["bvh.tracer", "ao.tracer"])"));
    EXPECT_EQ(editor_->viewport.layout, Viewport::Layout::Slider);
    EXPECT_THAT(editor_->viewport.error(), testing::MatchesRegex("MSE .*FLIP .*"));
}

// A graph that was edited in the window runs headless to the same picture, to the bit.
TEST_F(EditorWindow, TheSavedGraphGivesTheSamePicture) {
    person_->drag(person_->port("bvh", "tracer"), person_->port("ao", "tracer"));
    person_->rest();
    EXPECT_THAT(edges(), Contains("bvh.tracer -> ao.tracer"));
    person_->press("Ctrl+S");
    const Graph saved = loadGraph(file_);
    RenderOptions options;
    options.size = session_->size();
    Renderer headless(saved, allPasses(),
                      loadScene(saved.sceneSource, file_.parent_path(), {}, saved.sceneSetup),
                      window_->context().capabilities(), options);
    session_->restart();
    session_->render();
    headless.frame();
    std::string whyNot;
    EXPECT_EQ(session_->read(saved.outputs[0].port, whyNot), headless.read(saved.outputs[0].port));
    EXPECT_EQ(whyNot, "");
}

// What the mouse did to the wires is undone to the byte.
TEST_F(EditorWindow, WiresArePulledMovedCutAndUndone) {
    const glm::dvec2 empty = person_->box("mean") + glm::dvec2(60, 260);
    person_->drag(person_->port("mean", "result"), empty);
    choose("ToneMap");
    person_->drag(person_->port("ao", "tracer"), empty + glm::dvec2(0, 120));
    EXPECT_THAT(edges(), Not(Contains("roma.tracer -> ao.tracer")));
    EXPECT_FALSE(session_->problems().empty());
    look("problem");
    person_->drag(person_->port("bvh", "tracer"), person_->box("ao"));
    EXPECT_TRUE(session_->problems().empty());
    person_->drag(person_->box("ao"), person_->box("ao") + glm::dvec2(40, 30));
    while (session_->document.undo()) {
    }
    EXPECT_EQ(session_->document.text(), first_);
}

} // namespace
} // namespace kestrel::edit
