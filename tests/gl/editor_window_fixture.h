// The editor's window under a display, with a graph of the test's own in it.
#pragma once
#include "core/files.h"
#include "editor_driver.h"
#include "image/io.h"
#include "plugin/loader.h"
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kestrel::test {

using namespace edit;

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
            unsetenv("DISPLAY");
        }
    }
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

private:
    pid_t server_ = -1;
};

inline Registry& allPasses() {
    static Registry registry = [] {
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
        resizeTo({1280, 760, 1}); // a test before may have changed it
        editor_->canvas.frameAll(*session_);
        person_->wait(2);
    }
    void resizeTo(Extent size) {
        window_->resize(size);
        for (int i = 0; i < 200 && window_->context().framebufferExtent() != size; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            person_->wait(1);
        }
        ASSERT_EQ(window_->context().framebufferExtent(), size);
        person_->wait(2);
    }
    void TearDown() override {
        editor_.reset();
        session_.reset();
        EXPECT_EQ(gl::Context::severeErrors(), 0u);
    }

    // A copy of a shipped graph in a folder of the test's own, open in the editor.
    void start(const std::string& graph, const Registry& registry = allPasses()) {
        person_.reset();
        editor_.reset();
        session_.reset();
        file_ = folder_.path() / graph;
        writeFile(file_, readText(shareFolder() / "graphs" / graph));
        first_ = readText(file_);
        SessionOptions options;
        // Pictures for people are large.
        if (std::getenv("KESTREL_SCREENSHOTS") != nullptr)
            options.size = {640, 360, 1};
        else
            options.size = {96, 54, 1};
        session_ = std::make_unique<Session>(registry, window_->context().capabilities(),
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

    static inline std::unique_ptr<Display> display_;
    static inline std::unique_ptr<Theme> theme_;
    static inline std::unique_ptr<Window> window_;
    TemporaryFolder folder_;
    std::filesystem::path file_;
    std::string first_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<Editor> editor_;
    std::unique_ptr<Person> person_;
};

} // namespace kestrel::test
