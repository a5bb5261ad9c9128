#include "core/files.h"
#include "editor_driver.h"
#include "image/io.h"
#include "plugin/loader.h"
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kestrel::edit {
namespace {

using namespace test;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// A display of our own where there is none: Xvfb, for the time of the tests.
class Display {
public:
    Display() {
        if (std::getenv("DISPLAY") != nullptr) return;
        int ends[2];
        if (pipe(ends) != 0) return;
        server_ = fork();
        if (server_ == 0) {
            const int nothing = open("/dev/null", O_WRONLY);
            dup2(nothing, 2);
            execlp("Xvfb", "Xvfb", "-displayfd", std::to_string(ends[1]).c_str(), "-screen", "0",
                   "1600x900x24", "-nolisten", "tcp", static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        std::string number;
        for (char letter = 0; read(ends[0], &letter, 1) == 1 && letter != '\n';) number += letter;
        close(ends[0]);
        if (!number.empty()) setenv("DISPLAY", (":" + number).c_str(), 1);
    }
    ~Display() {
        if (server_ > 0) {
            kill(server_, SIGTERM);
            waitpid(server_, nullptr, 0);
        }
    }
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

private:
    pid_t server_ = -1;
};

const Registry& allPasses() {
    static const Registry registry = [] {
        Registry loaded;
        loadPlugins(loaded, pluginFolders());
        return loaded;
    }();
    return registry;
}

class EditorWindow : public testing::Test {
protected:
    static void SetUpTestSuite() {
        display_ = std::make_unique<Display>();
        if (std::getenv("DISPLAY") == nullptr) return;
        theme_ = std::make_unique<Theme>();
        window_ = std::make_unique<Window>(Extent{1280, 760, 1}, *theme_);
    }
    static void TearDownTestSuite() {
        window_.reset();
        display_.reset();
    }
    void SetUp() override {
        if (window_ == nullptr) GTEST_SKIP() << "no display, and no Xvfb to make one";
        start("ray_ao.json");
    }
    void TearDown() override {
        editor_.reset();
        session_.reset();
        EXPECT_EQ(gl::Context::severeErrors(), 0u);
    }

    // A copy of a shipped graph in a folder of the test's own, open in the editor.
    void start(const std::string& graph) {
        file_ = folder_.path() / graph;
        writeFile(file_, readText(shareFolder() / "graphs" / graph));
        first_ = readText(file_);
        SessionOptions options;
        options.size = {96, 54, 1};
        session_ = std::make_unique<Session>(allPasses(), window_->context().capabilities(),
                                             window_->context().driver(), loadGraph(file_), options);
        editor_ = std::make_unique<Editor>(*session_, *theme_, folder_.path() / "state");
        editor_->stopAfter = 4;
        person_ = std::make_unique<Person>(*window_, *editor_, *session_, *theme_);
        person_->rest();
        editor_->canvas.frameAll(*session_);
        person_->wait(2);
    }
    void choose(const std::string& typed) {
        person_->type(typed);
        person_->press("Enter");
    }
    [[nodiscard]] std::vector<std::string> edges() const {
        std::vector<std::string> texts;
        for (const GraphEdge& edge : session_->document.graph().edges)
            texts.push_back(edge.from.text() + " -> " + edge.to.text());
        return texts;
    }
    // For people: with KESTREL_SCREENSHOTS=FOLDER what the window shows is kept there.
    void look(const std::string& name) const {
        if (const char* folder = std::getenv("KESTREL_SCREENSHOTS")) {
            person_->wait(1);
            writeImage(std::filesystem::path(folder) / (name + ".png"), window_->screenshot(),
                       Encoding::Linear);
        }
    }

    static std::unique_ptr<Display> display_;
    static std::unique_ptr<Theme> theme_;
    static std::unique_ptr<Window> window_;
    TemporaryFolder folder_;
    std::filesystem::path file_;
    std::string first_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<Editor> editor_;
    std::unique_ptr<Person> person_;
};
std::unique_ptr<Display> EditorWindow::display_;
std::unique_ptr<Theme> EditorWindow::theme_;
std::unique_ptr<Window> EditorWindow::window_;

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
    EXPECT_LE(person_->actions(), 9);
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

// A graph that was edited in the window runs headless to the same picture, to the bit.
TEST_F(EditorWindow, TheSavedGraphGivesTheSamePicture) {
    person_->drag(person_->port("bvh", "tracer"), person_->port("ao", "tracer"));
    person_->rest();
    EXPECT_THAT(edges(), Contains("bvh.tracer -> ao.tracer"));
    person_->press("Ctrl+S");
    const Graph saved = loadGraph(file_);
    RenderOptions options;
    options.size = {96, 54, 1};
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

// Behaviours of the mouse: wires that are pulled, moved, dropped in the empty and on boxes; passes dropped on
// wires; strokes that cut; panning; and all of it undone to the byte.
TEST_F(EditorWindow, WiresArePulledMovedCutAndUndone) {
    // (3) Into the empty: the list of what fits.
    const glm::dvec2 empty = person_->box("mean") + glm::dvec2(60, 260);
    person_->drag(person_->port("mean", "result"), empty);
    EXPECT_TRUE(editor_->palette().isOpen());
    choose("ToneMap");
    EXPECT_THAT(edges(), Contains(HasSubstr("mean.result -> tone_map.")));
    // (4) The end that lies in an input moves to another tracer's... and back into the empty it is gone.
    person_->drag(person_->port("ao", "tracer"), empty + glm::dvec2(0, 120));
    EXPECT_THAT(edges(), Not(Contains("roma.tracer -> ao.tracer")));
    EXPECT_FALSE(session_->problems().empty());
    look("problem");
    // (3) On a body the one port that fits.
    person_->drag(person_->port("bvh", "tracer"), person_->box("ao"));
    EXPECT_THAT(edges(), Contains("bvh.tracer -> ao.tracer"));
    EXPECT_TRUE(session_->problems().empty());
    // (2) A stroke cuts.
    const glm::dvec2 from = person_->port("ao", "visibility"), to = person_->port("mean", "signal");
    const glm::dvec2 middle = (from + to) * 0.5;
    person_->alt = true;
    person_->drag(middle - glm::dvec2(0, 12), middle + glm::dvec2(0, 12));
    person_->alt = false;
    EXPECT_THAT(edges(), Not(Contains("ao.visibility -> mean.signal")));
    // (7) Panning, also over boxes, moves the view alone.
    const glm::dvec2 origin = editor_->canvas.view.origin;
    const std::uint64_t revision = session_->document.revision();
    person_->drag(person_->box("ao"), person_->box("ao") + glm::dvec2(40, 30), 1);
    EXPECT_NE(editor_->canvas.view.origin, origin);
    person_->wheel(person_->box("ao"), 1);
    EXPECT_EQ(session_->document.revision(), revision);
    while (session_->document.undo()) {
    }
    EXPECT_EQ(session_->document.text(), first_);
}

TEST_F(EditorWindow, APassThatIsDroppedOnAWireGoesIntoIt) {
    person_->press("A");
    choose("BilateralBlur");
    const std::string blur = *editor_->canvas.selection.begin();
    EXPECT_EQ(blur, "bilateral_blur");
    const size_t steps = session_->document.history().size();
    const glm::dvec2 middle = (person_->port("ao", "visibility") + person_->port("mean", "signal")) * 0.5;
    person_->drag(person_->box(blur), middle);
    EXPECT_THAT(edges(), Contains("ao.visibility -> bilateral_blur.signal"));
    EXPECT_THAT(edges(), Contains("bilateral_blur.result -> mean.signal"));
    EXPECT_EQ(session_->document.history().size(), steps + 1); // (9) one gesture, one step
    // (2) Delete with reconnect.
    person_->press("Shift+Del");
    EXPECT_THAT(edges(), Contains("ao.visibility -> mean.signal"));
}

// (1) The clipboard holds text; (5) a muted pass hands its input on; (6) one key shows any port.
TEST_F(EditorWindow, CopyMuteAndShowByKeys) {
    person_->press("Ctrl+F");
    choose("roma");
    person_->press("Ctrl+C");
    EXPECT_THAT(std::string(ImGui::GetClipboardText()), HasSubstr("\"roma\": { \"type\": \"Roma\""));
    person_->press("Ctrl+V");
    EXPECT_NE(session_->document.graph().find("roma_2"), nullptr);

    person_->press("Ctrl+F");
    choose("mean");
    person_->press("M");
    person_->rest();
    EXPECT_TRUE(session_->document.graph().find("mean")->muted);
    EXPECT_TRUE(session_->problems().empty());
    std::string whyNot;
    const Image through = session_->read({"mean", "result"}, whyNot),
                before = session_->read({"ao", "visibility"}, whyNot);
    EXPECT_EQ(through, before);
    look("muted");

    person_->click(person_->port("gbuffer", "normal"));
    person_->press("V");
    person_->rest();
    EXPECT_EQ(editor_->viewport.a, (PortRef{"gbuffer", "normal"}));
    EXPECT_FALSE(editor_->viewport.image().empty());
    person_->press("P");
    person_->rest();
    look("pinned");
}

// (11) At rest nothing is drawn or rendered; (12) unsaved work is asked for, a file that changed is taken.
TEST_F(EditorWindow, RestsAndAsks) {
    EXPECT_FALSE(editor_->busy());
    const std::uint64_t frames = session_->frames();
    person_->wait(10);
    EXPECT_EQ(session_->frames(), frames);

    Graph other = loadGraph(file_);
    other.comment = "Changed by another program";
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    writeFile(file_, saveGraph(other));
    for (int i = 0; i < 100 && session_->document.graph().comment.empty(); ++i) person_->wait(1);
    EXPECT_EQ(session_->document.graph().comment, other.comment);
    EXPECT_FALSE(session_->document.modified());

    person_->press("Ctrl+F");
    choose("mean");
    person_->press("M");
    person_->press("Ctrl+Q");
    EXPECT_FALSE(editor_->done());
    look("question");
    person_->type("n");
    EXPECT_FALSE(editor_->done());
    person_->press("Ctrl+Q");
    person_->type("y");
    EXPECT_TRUE(editor_->done());
}

} // namespace
} // namespace kestrel::edit
