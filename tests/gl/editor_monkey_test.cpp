// Somebody who does anything at all, for a long time: nothing crashes, no GL error, and undo leads back to
// the first byte.
#include "edit/properties.h"
#include "editor_window_fixture.h"
#include <fstream>
#include <random>
#include <set>

namespace kestrel::edit {
namespace {

using namespace test;

class EditorMonkey : public EditorWindow {
protected:
    void SetUp() override {
        if (window_ == nullptr) GTEST_SKIP() << "no display, and no Xvfb to make one";
        EditorWindow::SetUp();
        resizeTo({760, 460, 1}); // the driver draws it on the processor
        session_->setSize({32, 18, 1});
        session_->setScene("builtin:blob?detail=0.02");
        editor_->stopAfter = 1;
        person_->rest();
    }
    size_t pick(size_t count) { return static_cast<size_t>(random_()) % std::max<size_t>(count, 1); }
    template<class T>
    const T& of(const std::vector<T>& items) {
        return items[pick(items.size())];
    }
    // Somewhere on the canvas: most often on what is there.
    glm::dvec2 place() {
        const auto& boxes = editor_->canvas.boxes();
        const ImVec2 size = ImGui::GetIO().DisplaySize;
        if (boxes.empty() || pick(5) == 0)
            return {20.0 + double(pick(static_cast<size_t>(size.x / 2))),
                    60.0 + double(pick(static_cast<size_t>(size.y - 120)))};
        const Box& box = of(boxes);
        if (pick(2) == 0 && !box.ports.empty()) return person_->screen(of(box.ports).at);
        return person_->screen(box.low + (box.high - box.low) * glm::dvec2(double(pick(100)) / 100, 0.2));
    }
    [[nodiscard]] static bool onScreen(glm::dvec2 at) {
        const ImVec2 size = ImGui::GetIO().DisplaySize;
        return at.x > 8 && at.y > 40 && at.x < double(size.x) - 10 && at.y < double(size.y) - 30;
    }
    std::string letters() {
        static const char* const words[] = {"a",  "ro",   "bvh",          "x1",  "blur",
                                            "12", "snap", "builtin:blob", "ao.", "Tone"};
        return words[pick(std::size(words))];
    }
    void closeWhatIsOpen() {
        for (int i = 0; i < 3 && (editor_->palette().isOpen() || editor_->asks()); ++i) person_->press("Esc");
    }
    // Keys of everything but what opens another document, ends the program, or writes files for long.
    void pressAny() {
        static const std::set<std::string> never{"New",
                                                 "Open...",
                                                 "Quit",
                                                 "Everything by name...",
                                                 "Frame sequence...",
                                                 "Save as...",
                                                 "Screenshot...",
                                                 "Write stats.json...",
                                                 "Larger text",
                                                 "Smaller text",
                                                 "Dark or light"};
        std::vector<std::string> keys;
        for (const Action& action : editor_->actions().all())
            if (action.key.key != 0 && !never.contains(action.name)) keys.push_back(chordText(action.key));
        person_->press(of(keys));
        if (!editor_->palette().isOpen() && !editor_->asks()) return;
        if (pick(3) > 0) person_->type(letters());
        person_->press(pick(3) > 0 ? "Enter" : "Esc");
        closeWhatIsOpen();
    }
    void mouse() {
        const glm::dvec2 from = place(), to = place();
        if (!onScreen(from) || !onScreen(to)) return person_->press("F");
        person_->ctrl = pick(5) == 0;
        person_->shift = pick(5) == 0;
        person_->alt = pick(6) == 0;
        switch (pick(6)) {
        case 0:
            person_->click(from, static_cast<int>(pick(3)));
            break;
        case 1:
            person_->doubleClick(from);
            break;
        case 2:
            person_->wheel(from, pick(2) == 0 ? 1.0f : -1.0f);
            break;
        default:
            person_->drag(from, to, pick(5) == 0 ? static_cast<int>(1 + pick(2)) : 0);
        }
        person_->ctrl = person_->shift = person_->alt = false;
        closeWhatIsOpen();
    }
    void properties() {
        const auto& middles = editor_->properties().middles;
        if (middles.empty() || editor_->canvas.selection.size() != 1) return pressAny();
        // Small drags: the largest values of every property are for other tests.
        auto chosen = middles.begin();
        std::advance(chosen, static_cast<std::ptrdiff_t>(pick(middles.size())));
        const glm::dvec2 at = chosen->second;
        if (onScreen(at) && at.x > 0.55 * double(ImGui::GetIO().DisplaySize.x))
            person_->drag(at, at + glm::dvec2(double(pick(9)) - 4, 0));
    }
    void viewport() {
        const glm::dvec2 middle(editor_->viewport.middle().x, editor_->viewport.middle().y);
        const glm::dvec2 to = middle + glm::dvec2(double(pick(80)) - 40, double(pick(60)) - 30);
        if (pick(2) == 0)
            person_->drag(middle, to, static_cast<int>(pick(3)));
        else
            person_->wheel(to, pick(2) == 0 ? 1.0f : -1.0f);
    }
    void play(int actions) {
        for (int i = 0; i < actions; ++i) {
            SCOPED_TRACE("action " + std::to_string(i));
            switch (pick(8)) {
            case 0:
            case 1:
            case 2:
                pressAny();
                break;
            case 3:
                properties();
                break;
            case 4:
                viewport();
                break;
            default:
                mouse();
            }
            ASSERT_EQ(gl::Context::severeErrors(), 0u);
            ASSERT_FALSE(editor_->done());
            if (i % 50 == 0) {
                // What was drawn by and by is what is drawn at once.
                const Image seen = window_->screenshot();
                window_->drawAgain();
                ASSERT_EQ(window_->screenshot(), seen);
                ASSERT_EQ(saveGraph(parseGraph(session_->document.text(), "again")),
                          session_->document.text());
            }
            // A graph that grows without end tells nothing more.
            if (session_->document.graph().passes.size() > 40)
                for (int back = 0; back < 40; ++back) person_->press("Ctrl+Z");
        }
        // Much of what it did it took back itself.
        EXPECT_GT(session_->document.revision(), static_cast<std::uint64_t>(actions) / 20);
        EXPECT_GT(session_->document.history().size(), 0u);
        EXPECT_GT(session_->frames(), static_cast<std::uint64_t>(actions) / 20);
        while (session_->document.undo()) {
        }
        EXPECT_EQ(session_->document.text(), first_);
        person_->rest();
        EXPECT_TRUE(session_->problems().empty()) << session_->problems().front().message;
    }
    std::mt19937 random_{13};
};

TEST_F(EditorMonkey, SomeActionsAreUndoneToTheByte) { play(150); }

TEST_F(EditorMonkey, TenThousandActionsAreUndoneToTheByte) { play(10'000); }

class EditorEndurance : public EditorMonkey {
protected:
    static double residentMegabytes() {
        std::ifstream file("/proc/self/statm");
        double all = 0, resident = 0;
        file >> all >> resident;
        return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
    }
    void edit(int i) {
        const std::string refused = session_->apply("Set", [&](Graph& graph) {
            setProperty(graph, allPasses(), "ao", i % 2 == 0 ? "rays" : "distance",
                        i % 2 == 0 ? Value(std::int64_t{1 + i / 2 % 4}) : Value(0.5 + i / 2 % 7));
        });
        EXPECT_EQ(refused, "");
        person_->wait(1);
    }
    void swap(int i) {
        session_->apply("Swap", [&](Graph& graph) {
            applySetting(graph, allPasses(), i % 2 == 0 ? "ao.tracer=bvh.tracer" : "ao.tracer=roma.tracer");
        });
        person_->wait(2);
    }
    void resize(int i) {
        window_->resize(
            {900u + 40u * static_cast<unsigned>(i % 5), 600u + 20u * static_cast<unsigned>(i % 5), 1});
        session_->setSize(
            {32u + 16u * static_cast<unsigned>(i % 3), 18u + 9u * static_cast<unsigned>(i % 3), 1});
        person_->wait(2);
    }
    // Edits, with the swaps and resizes spread among them.
    void day(int edits, int swaps, int resizes) {
        for (int i = 0; i < edits; ++i) {
            edit(i);
            if (i % (edits / swaps) == 0) swap(i / (edits / swaps));
            if (i % (edits / resizes) == 0) resize(i / (edits / resizes));
        }
        ASSERT_EQ(gl::Context::severeErrors(), 0u);
        ASSERT_TRUE(session_->problems().empty()) << session_->problems().front().message;
    }
};

// What the first day needed is enough for the next ones.
TEST_F(EditorEndurance, SomeEditsSwapsAndResizesDoNotGrow) {
    day(200, 20, 10);
    const double before = residentMegabytes();
    day(200, 20, 10);
    EXPECT_LT(residentMegabytes() - before, 4);
}

TEST_F(EditorEndurance, TenThousandEditsSwapsAndResizesDoNotGrow) {
    day(1'000, 20, 10);
    const double before = residentMegabytes();
    day(10'000, 200, 50);
    const double after = residentMegabytes();
    RecordProperty("megabytes_before", std::to_string(before));
    RecordProperty("megabytes_after", std::to_string(after));
    std::printf("resident: %.1f MiB after 1,000 edits, %.1f MiB after 11,000\n", before, after);
    EXPECT_LT(after - before, 8);
}

} // namespace
} // namespace kestrel::edit
