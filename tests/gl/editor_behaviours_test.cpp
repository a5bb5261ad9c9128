// The twelve behaviours of people who wire all day (issue and README name them), each in the window with its
// own test.
#include "editor_window_fixture.h"
#include "measure/run_stats.h"

namespace kestrel::edit {
namespace {

using namespace test;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

using EditorBehaviours = EditorWindow;

// (1) Copy puts text on the clipboard, paste takes it from anywhere; inputs are kept on request.
TEST_F(EditorBehaviours, Nr01CopyIsTextAndPastesFromAnywhere) {
    person_->press("Ctrl+F");
    choose("roma");
    person_->press("Ctrl+C");
    EXPECT_THAT(std::string(ImGui::GetClipboardText()), HasSubstr("\"roma\": { \"type\": \"Roma\""));
    person_->press("Ctrl+V");
    EXPECT_NE(session_->document.graph().find("roma_2"), nullptr);
    EXPECT_THAT(edges(), Not(Contains("bom.occupancy -> roma_2.occupancy")));
    person_->press("Ctrl+F");
    choose("roma");
    person_->press("Ctrl+Alt+C");
    person_->press("Ctrl+V");
    EXPECT_THAT(edges(), Contains("bom.occupancy -> roma_3.occupancy"));
    ImGui::SetClipboardText(R"({"kestrel": 1, "passes": {"mailed": {"type": "Accumulate"}}})");
    person_->press("Ctrl+V");
    EXPECT_NE(session_->document.graph().find("mailed"), nullptr);
    ImGui::SetClipboardText("Dear all");
    const std::string before = session_->document.text();
    person_->press("Ctrl+V");
    EXPECT_EQ(session_->document.text(), before);
    EXPECT_FALSE(editor_->messages().empty());
}

// (2) A pass that is dropped on a wire goes into it; it is deleted with reconnection; a stroke cuts wires.
TEST_F(EditorBehaviours, Nr02InsertOnAWireReconnectAndCut) {
    person_->press("A");
    choose("BilateralBlur");
    EXPECT_EQ(editor_->canvas.selection, Names{"bilateral_blur"});
    const size_t steps = session_->document.history().size();
    person_->drag(person_->box("bilateral_blur"),
                  (person_->port("ao", "visibility") + person_->port("mean", "signal")) * 0.5);
    EXPECT_THAT(edges(), Contains("ao.visibility -> bilateral_blur.signal"));
    EXPECT_THAT(edges(), Contains("bilateral_blur.result -> mean.signal"));
    EXPECT_EQ(session_->document.history().size(), steps + 1); // one gesture
    person_->press("Shift+Del");
    EXPECT_THAT(edges(), Contains("ao.visibility -> mean.signal"));
    const glm::dvec2 middle = (person_->port("ao", "visibility") + person_->port("mean", "signal")) * 0.5;
    person_->alt = true;
    person_->drag(middle - glm::dvec2(0, 12), middle + glm::dvec2(0, 12));
    person_->alt = false;
    EXPECT_THAT(edges(), Not(Contains("ao.visibility -> mean.signal")));
}

// (3) A wire pulled from an output or an input into the empty offers what fits; on a body it takes the one
// port.
TEST_F(EditorBehaviours, Nr03AWireIntoTheEmptyOffersWhatFits) {
    const glm::dvec2 empty = person_->box("mean") + glm::dvec2(60, 260);
    person_->drag(person_->port("mean", "result"), empty);
    EXPECT_TRUE(editor_->palette().isOpen());
    choose("ToneMap");
    EXPECT_THAT(edges(), Contains(HasSubstr("mean.result -> tone_map.")));
    person_->press("Ctrl+Z");
    // An input that nothing feeds: from the right to the left.
    const glm::dvec2 middle = (person_->port("roma", "tracer") + person_->port("ao", "tracer")) * 0.5;
    person_->alt = true;
    person_->drag(middle - glm::dvec2(0, 12), middle + glm::dvec2(0, 12));
    person_->alt = false;
    ASSERT_THAT(edges(), Not(Contains("roma.tracer -> ao.tracer")));
    person_->drag(person_->port("ao", "tracer"), empty);
    EXPECT_TRUE(editor_->palette().isOpen());
    choose("ScreenTrace");
    EXPECT_THAT(edges(), Contains("screen_trace.tracer -> ao.tracer"));
    person_->drag(person_->port("bvh", "tracer"), person_->box("ao"));
    EXPECT_THAT(edges(), Contains("bvh.tracer -> ao.tracer"));
}

// (4) Either end of a wire is moved; with Ctrl it is copied; in the empty it is gone.
TEST_F(EditorBehaviours, Nr04EitherEndOfAWireIsMovedOrCopied) {
    person_->press("Ctrl+F");
    choose("ao");
    person_->press("Ctrl+D");
    ASSERT_NE(session_->document.graph().find("ao_2"), nullptr);
    session_->apply("Apart", [&](Graph& graph) {
        keepPlaces(graph, session_->places);
        movePasses(graph, {"ao_2"}, {0, 260});
        disconnect(graph, {{"ao_2", "tracer"}});
    });
    editor_->canvas.frameAll(*session_);
    person_->wait(2);
    // The end in the input, copied, then moved into the empty.
    person_->ctrl = true;
    person_->drag(person_->port("ao", "tracer"), person_->port("ao_2", "tracer"));
    person_->ctrl = false;
    EXPECT_THAT(edges(), Contains("roma.tracer -> ao.tracer"));
    EXPECT_THAT(edges(), Contains("roma.tracer -> ao_2.tracer"));
    person_->drag(person_->port("ao_2", "tracer"), person_->box("mean") + glm::dvec2(60, 300));
    EXPECT_THAT(edges(), Not(Contains("roma.tracer -> ao_2.tracer")));
    // The end at the output: taken up by the wire near it.
    const std::vector<glm::dvec2> curve =
        curveOf({{"roma", "tracer"}, {"ao", "tracer"}, {}}, editor_->canvas.boxes());
    person_->drag(person_->screen(curve[3]), person_->port("bvh", "tracer"));
    EXPECT_THAT(edges(), Contains("bvh.tracer -> ao.tracer"));
    EXPECT_THAT(edges(), Not(Contains("roma.tracer -> ao.tracer")));
}

// (5) A muted pass passes its input through, is struck out, saved, and said in the stats.
TEST_F(EditorBehaviours, Nr05AMutedPassHandsItsInputOn) {
    person_->press("Ctrl+F");
    choose("mean");
    person_->press("M");
    person_->rest();
    EXPECT_TRUE(session_->problems().empty());
    std::string whyNot;
    const Image through = session_->read({"mean", "result"}, whyNot),
                before = session_->read({"ao", "visibility"}, whyNot);
    EXPECT_EQ(through, before);
    look("muted");
    person_->press("Ctrl+S");
    EXPECT_THAT(readText(file_), HasSubstr(R"("mean": { "type": "Accumulate", "muted": true })"));
    const std::string stats =
        statsJson(gatherStats(*session_->renderer(), session_->profile(), session_->driver()));
    EXPECT_THAT(stats, HasSubstr("muted"));
}

// (6) One key shows any port; previews are pinned; a port is seen before and after a pass that changes it.
TEST_F(EditorBehaviours, Nr06AnyPortIsShownByOneKeyAndPinned) {
    person_->click(person_->port("gbuffer", "normal"));
    person_->press("V");
    person_->rest();
    EXPECT_EQ(editor_->viewport.a, (PortRef{"gbuffer", "normal"}));
    EXPECT_FALSE(editor_->viewport.image().empty());
    person_->press("P");
    person_->rest();
    EXPECT_EQ(editor_->viewport.pinned, (std::vector<PortRef>{{"gbuffer", "normal"}}));
    look("pinned");
    person_->click(person_->port("ao", "visibility"));
    person_->press("V");
    person_->click(person_->port("mean", "signal")); // what goes in: the same
    person_->press("V");
    person_->rest();
    std::string whyNot;
    EXPECT_EQ(session_->read({"mean", "signal"}, whyNot), session_->read({"ao", "visibility"}, whyNot))
        << whyNot;
    EXPECT_NE(session_->read({"mean", "result"}, whyNot), session_->read({"ao", "visibility"}, whyNot));
}

// (7) The view is panned from anywhere, also over boxes; nothing of the document moves.
TEST_F(EditorBehaviours, Nr07PanEverywhere) {
    const std::uint64_t revision = session_->document.revision();
    for (const int button : {1, 2})
        for (const glm::dvec2 at : {person_->box("ao"), person_->port("ao", "tracer"),
                                    person_->box("mean") + glm::dvec2(-60, 260)}) {
            const glm::dvec2 origin = editor_->canvas.view.origin;
            person_->drag(at, at + glm::dvec2(40, 30), button);
            EXPECT_NE(editor_->canvas.view.origin, origin) << button;
            person_->drag(at + glm::dvec2(40, 30), at, button);
            EXPECT_NEAR(glm::length(editor_->canvas.view.origin - origin), 0, 1e-6);
        }
    const double zoom = editor_->canvas.view.zoom;
    person_->wheel(person_->box("ao"), 1);
    EXPECT_GT(editor_->canvas.view.zoom, zoom);
    EXPECT_EQ(session_->document.revision(), revision);
}

// (8) Search by name, type, port, property value, "reads X", "writes X".
TEST_F(EditorBehaviours, Nr08SearchByAllThatOneRemembers) {
    for (const auto& [typed, pass] : {std::pair<const char*, const char*>{"mea", "mean"},
                                      {"OccupancyM", "bom"},
                                      {"resolution=128", "bom"},
                                      {"reads ao", "mean"},
                                      {"writes roma", "bom"},
                                      {"snap=true", "ao"}}) {
        editor_->canvas.selection.clear();
        person_->press("Ctrl+F");
        choose(typed);
        EXPECT_EQ(editor_->canvas.selection, Names{pass}) << typed;
    }
}

// (9) A drag of a slider is one step of undo, and steps have names.
TEST_F(EditorBehaviours, Nr09ASliderDragIsOneNamedStep) {
    person_->press("Ctrl+F");
    choose("ao");
    person_->wait(2);
    ASSERT_TRUE(editor_->properties().middles.contains("rays"));
    const glm::dvec2 at = editor_->properties().middles.at("rays");
    const std::uint64_t revision = session_->document.revision();
    person_->drag(at, at + glm::dvec2(60, 0));
    EXPECT_GT(session_->document.revision(), revision + 1); // several values on the way, each rendered
    ASSERT_EQ(session_->document.history().size(), 1u);
    EXPECT_EQ(session_->document.undoName(), "Set ao.rays");
    person_->press("Ctrl+Z");
    EXPECT_EQ(session_->document.text(), first_);
    EXPECT_EQ(session_->document.redoName(), "Set ao.rays");
}

// (10) Layout moves only what it is asked to.
TEST_F(EditorBehaviours, Nr10LayoutLeavesWhatAPersonPlaced) {
    person_->drag(person_->box("mean"), person_->box("mean") + glm::dvec2(35, 120));
    const auto placed = session_->document.graph().find("mean")->position;
    ASSERT_TRUE(placed.has_value());
    person_->press("A");
    choose("ToneMap");
    person_->press("Ctrl+F");
    choose("roma");
    person_->press("L");
    EXPECT_EQ(session_->document.graph().find("mean")->position, placed);
    person_->press("Ctrl+A");
    person_->press("L");
    EXPECT_NE(session_->document.graph().find("mean")->position, placed); // asked for
}

// (11) At rest nothing is rendered, and the loop sleeps; what is not saved is kept by another thread.
TEST_F(EditorBehaviours, Nr11AtRestNothingIsDrawn) {
    EXPECT_FALSE(editor_->busy());
    const std::uint64_t frames = session_->frames();
    person_->wait(10);
    EXPECT_EQ(session_->frames(), frames);
    person_->press("Ctrl+F");
    choose("mean");
    person_->press("M");
    const Autosave autosave(folder_.path() / "state" / "autosave");
    EXPECT_FALSE(autosave.recover(file_).has_value());
    person_->wait(6 * 60); // frames of a sixtieth of a second: the interval is 5 s
    for (int i = 0; i < 100 && !autosave.recover(file_); ++i) person_->wait(1);
    ASSERT_TRUE(autosave.recover(file_).has_value());
    EXPECT_TRUE(autosave.recover(file_)->find("mean")->muted);
}

// (12) Questions before work is lost, and when the file changed on the disk.
TEST_F(EditorBehaviours, Nr12AsksBeforeWorkIsLost) {
    const auto changeOnDisk = [&](const std::string& comment) {
        Graph other = loadGraph(file_);
        other.comment = comment;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        writeFile(file_, saveGraph(other));
    };
    // Nothing to lose: it is taken.
    changeOnDisk("Changed by another program");
    for (int i = 0; i < 100 && session_->document.graph().comment.empty(); ++i) person_->wait(1);
    EXPECT_EQ(session_->document.graph().comment, "Changed by another program");
    EXPECT_FALSE(session_->document.modified());
    person_->press("Ctrl+F");
    choose("mean");
    person_->press("M");
    // Something to lose: it is asked.
    changeOnDisk("And again");
    person_->wait(60);
    look("question");
    EXPECT_EQ(session_->document.graph().comment, "Changed by another program");
    person_->type("y");
    EXPECT_EQ(session_->document.graph().comment, "And again");
    person_->press("Ctrl+Z");
    EXPECT_TRUE(session_->document.graph().find("mean")->muted); // mine is back
    person_->press("Ctrl+Q");
    EXPECT_FALSE(editor_->done());
    person_->type("n");
    EXPECT_FALSE(editor_->done());
    person_->press("Ctrl+N");
    person_->type("n");
    EXPECT_EQ(session_->document.graph().file, file_);
    person_->press("Ctrl+Q");
    person_->type("y");
    EXPECT_TRUE(editor_->done());
}

// A module has no picture: the viewport says so, and nothing is wrong with the graph.
TEST_F(EditorBehaviours, AModuleThatIsLookedAtIsNoProblem) {
    editor_->viewport.showPort({"roma", "tracer"});
    person_->rest();
    EXPECT_TRUE(session_->problems().empty());
    std::string why;
    EXPECT_TRUE(session_->read({"roma", "tracer"}, why).empty());
    EXPECT_THAT(why, testing::HasSubstr("roma.tracer is a shader module: it has no content"));
}

} // namespace
} // namespace kestrel::edit
