// Camera, time and captures: what the window shows is what its command line makes.
#include "apart.h"
#include "core/json.h"
#include "edit/camera.h"
#include "edit/properties.h"
#include "editor_window_fixture.h"
#include "execute/commands.h"
#include <set>

namespace kestrel::edit {
namespace {

using namespace test;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class EditorCapture : public EditorWindow {
protected:
    // Runs a command line that the editor gave in the test's folder, as a shell does.
    void run(const std::string& line) const {
        const std::string shell = "cd '" + folder_.path().string() + "' && PATH='" +
                                  (buildFolder() / "bin").string() + "':$PATH && " + line + " >log.txt 2>&1";
        EXPECT_EQ(std::system(shell.c_str()), 0) << line << "\n" << readText(folder_.path() / "log.txt");
    }
    [[nodiscard]] std::string clipboard() const { return ImGui::GetClipboardText(); }
    [[nodiscard]] glm::dvec2 picture() const {
        return {editor_->viewport.middle().x, editor_->viewport.middle().y};
    }
    [[nodiscard]] CameraState seenFrom() const {
        return stateOf(*session_->movableCamera(), session_->renderer()->scene());
    }
    // The picture of the command line on the clipboard, and the window's own.
    void expectTheSame(const PortRef& port) {
        person_->press("Ctrl+Shift+C");
        const std::string line = clipboard();
        ASSERT_THAT(line, HasSubstr("kestrel render ")) << editor_->messages().back();
        run(line);
        std::string why;
        const Image seen = session_->read(port, why);
        ASSERT_FALSE(seen.empty()) << why;
        EXPECT_EQ(readImage(folder_.path() / (port.text() + ".exr")), seen) << line;
    }
};

// Turned by the mouse, flown by keys: the command line on the clipboard makes the same picture, to the bit.
TEST_F(EditorCapture, TheCommandLineMakesTheSamePicture) {
    expectTheSame({"mean", "result"});
    const CameraState before = seenFrom();
    person_->drag(picture(), picture() + glm::dvec2(60, 25));
    ASSERT_TRUE(session_->ownCamera().has_value());
    EXPECT_NE(seenFrom().view, before.view);
    person_->wheel(picture(), 2);
    person_->hold('W', picture(), 1, 10);
    person_->rest();
    look("flown");
    EXPECT_THAT(session_->commandLine({"mean", "result"}, "x.exr"),
                AllOf(HasSubstr("--camera 'eye="), HasSubstr("--size 96x54")));
    expectTheSame({"mean", "result"});
    // What is not saved has no command line.
    person_->press("Ctrl+F");
    choose("mean");
    person_->press("M");
    ImGui::SetClipboardText("");
    person_->press("Ctrl+Shift+C");
    EXPECT_EQ(clipboard(), "");
    person_->press("Ctrl+S");
    expectTheSame({"mean", "result"});
}

TEST_F(EditorCapture, TheCameraFliesTurnsAndGoesBack) {
    const AddedCamera first = *session_->movableCamera();
    const glm::dvec3 forward = glm::normalize(*first.target - *first.eye);
    // Letters are the camera's while the right button is held over the picture: nothing is added by A.
    const size_t passes = session_->document.graph().passes.size();
    for (const auto& [key, way] : {std::pair<char, glm::dvec3>{'W', forward},
                                   {'A', glm::cross(glm::dvec3(0, 1, 0), forward)},
                                   {'E', {0, 1, 0}}}) {
        const glm::dvec3 eye = *session_->movableCamera()->eye;
        person_->hold(key, picture(), 1, 12);
        EXPECT_GT(glm::dot(*session_->movableCamera()->eye - eye, way), 0) << key;
    }
    EXPECT_FALSE(editor_->palette().isOpen());
    EXPECT_EQ(session_->document.graph().passes.size(), passes);
    EXPECT_EQ(session_->cameraName(), "own");
    person_->press("Ctrl+Alt+V");
    EXPECT_THAT(clipboard(), HasSubstr("--camera 'eye="));
    person_->press("Shift+C");
    EXPECT_FALSE(session_->ownCamera().has_value());
    EXPECT_EQ(*session_->movableCamera()->eye, *first.eye);
    // By keys alone, and a camera of the scene by its name.
    person_->press("Alt+Left");
    EXPECT_NE(*session_->movableCamera()->eye, *first.eye);
    person_->press("C");
    const Scene& scene = session_->renderer()->scene();
    const std::string last = scene.cameras.back().name;
    choose(last);
    EXPECT_EQ(session_->cameraName(), last);
    person_->rest();
    expectTheSame({"mean", "result"});
    EXPECT_FALSE(session_->document.modified()); // looking is no edit
}

// A scene that moves: the time stands until it is let run, goes by fixed steps, and is in the command line.
TEST_F(EditorCapture, TheTimeLineStepsRunsAndIsCaptured) {
    session_->apply("Scene", [](Graph& graph) { graph.sceneSource = "builtin:skinned?detail=0.1"; });
    person_->rest();
    ASSERT_TRUE(session_->problems().empty()) << session_->problems().front().message;
    ASSERT_GT(session_->duration(), 0);
    EXPECT_FALSE(session_->timeRuns());
    EXPECT_EQ(session_->time(), 0);
    session_->setTimeStep(0.05);
    person_->press(".");
    person_->press(".");
    person_->rest();
    EXPECT_NEAR(session_->time(), 0.1, 1e-9);
    person_->press(",");
    person_->rest();
    EXPECT_NEAR(session_->time(), 0.05, 1e-9);
    person_->press(",");
    person_->press(",");
    person_->rest();
    EXPECT_NEAR(session_->time(), session_->duration() - 0.05, 1e-9); // before the beginning is the end
    session_->setTime(0.2);
    person_->press("Ctrl+S");
    person_->rest();
    look("time_line");
    expectTheSame({"mean", "result"});
    EXPECT_THAT(clipboard(), AllOf(HasSubstr("--time 0.2"), HasSubstr("--still")));
    person_->press("Space");
    EXPECT_TRUE(session_->timeRuns());
    EXPECT_TRUE(editor_->busy());
    person_->wait(10);
    EXPECT_GT(session_->time(), 0.4);
    person_->press("Space");
    person_->rest();
    const double stood = session_->time();
    person_->wait(5);
    EXPECT_EQ(session_->time(), stood);

    // A sequence has the same frames as without a window.
    person_->press("Shift+F12");
    person_->press("Ctrl+A");
    const std::filesystem::path files = folder_.path() / "made_%02d.exr";
    person_->type(files.string() + " 4");
    person_->press("Enter");
    const std::string told = editor_->messages().back();
    ASSERT_THAT(told, HasSubstr("kestrel render"));
    person_->wait(8);
    EXPECT_EQ(editor_->messages().back(), "wrote 4 frames");
    std::set<std::vector<float>> different;
    std::vector<Image> made;
    for (int i = 0; i < 4; ++i) {
        const std::filesystem::path file = folder_.path() / ("made_0" + std::to_string(i) + ".exr");
        made.push_back(readImage(file));
        different.insert(made.back().values);
        std::filesystem::remove(file);
    }
    EXPECT_EQ(different.size(), 4u);
    run(told.substr(told.find("kestrel render")));
    for (size_t i = 0; i < 4; ++i)
        EXPECT_EQ(readImage(folder_.path() / ("made_0" + std::to_string(i) + ".exr")), made[i]) << i;
}

TEST_F(EditorCapture, AScreenshotIsThePortAsTheCommandLineWritesIt) {
    for (const char* ending : {".png", ".exr", ".hdr"}) {
        const std::filesystem::path file = folder_.path() / (std::string("shot") + ending);
        person_->press("F12");
        person_->press("Ctrl+A");
        person_->type(file.string());
        person_->press("Enter");
        person_->wait(2);
        ASSERT_TRUE(std::filesystem::exists(file)) << editor_->messages().back();
        std::filesystem::path other = folder_.path() / (std::string("other") + ending);
        run(session_->commandLine(editor_->viewport.a, other));
        EXPECT_EQ(readBytes(other), readBytes(file)) << ending;
    }
    person_->press("F12");
    person_->press("Ctrl+A");
    person_->type("/nowhere/at/all.tiff");
    person_->press("Enter");
    EXPECT_THAT(editor_->messages().back(), HasSubstr(".tiff"));
}

TEST_F(EditorCapture, TheStatsAreThoseOfRender) {
    const std::filesystem::path file = folder_.path() / "stats.json", other = folder_.path() / "other.json";
    person_->press("Ctrl+Shift+E");
    person_->press("Ctrl+A");
    person_->type(file.string());
    person_->press("Enter");
    person_->wait(2);
    run("kestrel render " + file_.string() + " --size 96x54 --stats " + other.string());
    const auto keys = [](const std::filesystem::path& path) {
        const Json json = Json::parse(readText(path), path.string());
        std::vector<std::string> names;
        for (const auto& member : json.members) names.push_back(member.key);
        return names;
    };
    EXPECT_EQ(keys(file), keys(other));
}

// A picture that is dropped on the canvas feeds its pass; the reference may be a file.
TEST_F(EditorCapture, ADroppedPictureIsAPassAndAFileIsAReference) {
    person_->press("F12");
    person_->press("Ctrl+A");
    person_->type((folder_.path() / "truth.exr").string());
    person_->press("Enter");
    person_->wait(2);
    editor_->open(folder_.path() / "truth.exr");
    ASSERT_NE(session_->document.graph().find("image"), nullptr);
    EXPECT_THAT(session_->document.text(),
                HasSubstr(R"("image": { "type": "Image", "properties": { "file": "truth.exr" })"));
    person_->press("V"); // the one port, picked by the drop
    person_->rest();
    EXPECT_EQ(editor_->viewport.a, (PortRef{"image", "image"}));
    EXPECT_EQ(editor_->viewport.image(), readImage(folder_.path() / "truth.exr"));
    look("dropped");
    // Another program writes it anew; takes it away, and brings it back.
    const Image shot = readImage(folder_.path() / "truth.exr"), other(5, 3, 1);
    const auto lookedAt = [&] {
        person_->wait(40); // twice a second
        person_->rest();
        return session_->problems().empty();
    };
    writeImage(folder_.path() / "truth.exr", other, Encoding::Linear);
    EXPECT_TRUE(lookedAt());
    EXPECT_EQ(editor_->viewport.image(), other);
    std::filesystem::remove(folder_.path() / "truth.exr");
    EXPECT_FALSE(lookedAt());
    writeImage(folder_.path() / "truth.exr", shot, Encoding::Linear);
    EXPECT_TRUE(lookedAt());
    EXPECT_EQ(editor_->viewport.image(), shot);
    // A file that is missing where it is named, and comes.
    session_->apply("Set", [](Graph& graph) {
        setProperty(graph, allPasses(), "image", "file", std::string("late.exr"));
    });
    EXPECT_FALSE(lookedAt());
    writeImage(folder_.path() / "late.exr", other, Encoding::Linear);
    EXPECT_TRUE(lookedAt());
    EXPECT_EQ(editor_->viewport.image(), other);
    session_->document.undo();
    EXPECT_TRUE(lookedAt());
    editor_->viewport.showPort({"mean", "result"});
    person_->rest();
    session_->restart(); // as many frames as the file is of
    person_->rest();
    person_->press("Ctrl+H");
    person_->type((folder_.path() / "truth.exr").string());
    person_->press("Enter");
    person_->rest();
    EXPECT_TRUE(editor_->viewport.holds());
    EXPECT_THAT(editor_->viewport.error(), HasSubstr("MSE 0 "));
    person_->press("Ctrl+F");
    choose("mean");
    person_->press("M");
    person_->rest();
    EXPECT_THAT(editor_->viewport.error(), AllOf(HasSubstr("MSE"), Not(HasSubstr("MSE 0 "))));
}

// A plugin that is built anew while the editor is open.
TEST_F(EditorCapture, ARebuiltPluginIsTakenOver) {
    Registry registry = allPasses();
    const std::filesystem::path plugins = folder_.path() / "plugins", library = plugins / "good.so";
    const auto build = [&](const char* name) {
        std::filesystem::create_directories(plugins);
        std::filesystem::remove(library);
        std::filesystem::copy_file(buildFolder() / "test_plugins" / name / (std::string(name) + ".so"),
                                   library);
    };
    build("good");
    ASSERT_EQ(loadPlugin(library, registry).message, "");
    start("ray_ao.json", registry);
    Plugins watched(registry, {plugins});
    editor_->plugins = &watched;
    session_->apply("Add", [&](Graph& graph) {
        addPass(graph, registry, "Good", {});
        setOutput(graph, registry, {"good", "result"}, true);
    });
    editor_->viewport.showPort({"good", "result"});
    person_->rest();
    std::string why;
    EXPECT_EQ(session_->read({"good", "result"}, why).at(0, 0), 1) << why;
    const auto followed = [&](const std::string& text) {
        for (int i = 0; i < 300 && (editor_->messages().empty() ||
                                    editor_->messages().back().find(text) == std::string::npos);
             ++i)
            person_->wait(1);
        person_->rest();
        return testing::Value(editor_->messages(), Contains(HasSubstr(text)));
    };
    build("rebuilt");
    EXPECT_TRUE(followed("good.so was built anew: Good"));
    EXPECT_EQ(session_->read({"good", "result"}, why).at(0, 0), 2) << why;
    // One that is none leaves what is there.
    build("other_stamp");
    EXPECT_TRUE(followed("it was built for another Kestrel"));
    EXPECT_EQ(session_->read({"good", "result"}, why).at(0, 0), 2) << why;
    EXPECT_TRUE(session_->problems().empty());
}

// A pass that counts on finding what it wrote last time, and does not say so: memory that it shares is to
// blame.
struct Careless final : Pass {
    [[nodiscard]] Declaration declare(const World& world, const Inputs&, const Demand&) const override {
        Declaration declaration;
        declaration.outputs.push_back({.port = "count", .desc = Desc::texture2D(Format::R32F, world.size)});
        declaration.steps.push_back({.name = "count",
                                     .uses = {{.port = "count", .access = Access::Host},
                                              {.port = "count", .access = Access::Copy, .write = true}}});
        declaration.depends = Causes::Frame;
        return declaration;
    }
    void execute(const Step&, Commands& commands) override {
        Image image = commands.downloadImage("count");
        const bool fresh = commands.frame().index == 0;
        for (float& value : image.values) value = fresh ? 1 : value + 1;
        commands.uploadImage("count", image);
    }
};

TEST_F(EditorCapture, MemoryOfItsOwnTellsWhetherSharingIsToBlame) {
    Registry registry = allPasses();
    registry.add(Describe<Careless>("Careless", "Counts frames in what it made")
                     .output("count", PortKind::Texture, "Count"));
    start("ray_ao.json", registry);
    // The count is read, then its memory serves a chain of blurs and comes back with something else.
    session_->apply("Chain", [&](Graph& graph) {
        addPass(graph, registry, "Careless", {});
        std::string from = "careless.count";
        for (int i = 0; i < 4; ++i) {
            const std::string blur = addPass(graph, registry, "BilateralBlur", {});
            applySetting(graph, registry, blur + ".signal=" + from);
            applySetting(graph, registry, blur + ".view_depth=gbuffer.view_depth");
            from = blur + ".result";
        }
        setOutput(graph, registry, *parsePortRef(from), true);
    });
    const PortRef last{"bilateral_blur_4", "result"};
    editor_->viewport.showPort(last);
    person_->rest();
    ASSERT_TRUE(session_->problems().empty()) << session_->problems().front().message;
    const std::string blamed = toggleApart(*session_, {"careless", "count"}, last);
    EXPECT_THAT(blamed, HasSubstr("so that sharing is to blame"));
    EXPECT_EQ(session_->apart.size(), 1u);
    EXPECT_THAT(toggleApart(*session_, {"careless", "count"}, last), HasSubstr("shares its memory again"));
    EXPECT_TRUE(session_->apart.empty());
    EXPECT_THAT(toggleApart(*session_, {"bilateral_blur_2", "result"}, {"mean", "result"}),
                HasSubstr("mean.result is the same to the bit, so that sharing is not to blame"));
}

} // namespace
} // namespace kestrel::edit
