// Files of the editor: what survives a crash, what changed on the disk, what was open lately.
#include "core/files.h"
#include "edit/files.h"
#include "editor_fixture.h"
#include "support/temporary_folder.h"
#include <chrono>
#include <csignal>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace kestrel::edit {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

class EditorFiles : public testing::Test {
protected:
    TemporaryFolder folder;
    std::filesystem::path file = folder.path() / "graph.json";
    std::filesystem::path state = folder.path() / "state";
    void SetUp() override { writeFile(file, editorGraph); }
    [[nodiscard]] Document opened() const { return Document(loadGraph(file)); }
    static void mute(Document& document) {
        document.apply("Mute", [](Graph& graph) { setMuted(graph, {"blur"}, true); });
    }
    // Until another thread has written.
    static void settle(Autosave& autosave, const Document& document) {
        for (int i = 0; i < 500 && !autosave.recover(document.graph().file); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
};

TEST_F(EditorFiles, WhatIsNotSavedIsKeptBesideAndGoneOnceSaved) {
    Document document = opened();
    Autosave autosave(state);
    EXPECT_EQ(autosave.save(document), "");
    EXPECT_FALSE(std::filesystem::exists(autosave.copyOf(file))); // nothing to keep
    mute(document);
    EXPECT_EQ(autosave.save(document), "");
    settle(autosave, document);
    const auto kept = autosave.recover(file);
    ASSERT_TRUE(kept.has_value());
    EXPECT_EQ(saveGraph(*kept), document.text());
    EXPECT_EQ(kept->file, file);
    EXPECT_EQ(readText(file), editorGraph); // the file itself is the person's to write
    // Once it is what the file holds there is nothing to recover.
    writeFile(file, document.text());
    EXPECT_FALSE(autosave.recover(file).has_value());
    writeFile(file, editorGraph);
    autosave.drop(file);
    EXPECT_FALSE(autosave.recover(file).has_value());
}

// The process dies without a word, in the midst of it; another one finds what was kept.
TEST_F(EditorFiles, ACrashLosesLittle) {
    const pid_t child = fork();
    if (child == 0) {
        Document document = opened();
        Autosave autosave(state);
        mute(document);
        autosave.save(document);
        settle(autosave, document);
        kill(getpid(), SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    const auto kept = Autosave(state).recover(file);
    ASSERT_TRUE(kept.has_value());
    EXPECT_TRUE(kept->find("blur")->muted);
}

TEST_F(EditorFiles, AGraphWithoutAFileIsKeptToo) {
    Document document{Graph()};
    const Registry registry = editorRegistry();
    document.apply("Add", [&](Graph& graph) { addPass(graph, registry, "GBuffer", {}); });
    Autosave autosave(state);
    autosave.save(document);
    settle(autosave, document);
    const auto kept = Autosave(state).recover("");
    ASSERT_TRUE(kept.has_value());
    EXPECT_EQ(saveGraph(*kept), document.text());
    EXPECT_TRUE(kept->file.empty());
}

TEST_F(EditorFiles, HalfACopyAndACopyOfAnotherFileAreNone) {
    Document document = opened();
    mute(document);
    const Autosave autosave(state);
    writeFile(autosave.copyOf(file), document.text().substr(0, 100));
    EXPECT_FALSE(autosave.recover(file).has_value());
    writeFile(autosave.copyOf(file), document.text());
    EXPECT_TRUE(autosave.recover(file).has_value());
    EXPECT_FALSE(autosave.recover(folder.path() / "other" / "graph.json").has_value());
}

TEST_F(EditorFiles, WhatCannotBeKeptIsTold) {
    writeFile(state, "a file where the folder ought to be");
    Document document = opened();
    mute(document);
    Autosave autosave(state);
    EXPECT_EQ(autosave.save(document), "");
    std::string told;
    for (int i = 0; i < 500 && told.empty(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        told = autosave.save(document);
    }
    EXPECT_THAT(told, HasSubstr("state"));
}

TEST_F(EditorFiles, AFileThatChangedIsNoticedOnceAndATouchIsNone) {
    Watched watched;
    EXPECT_FALSE(watched.changed());
    watched.read(file);
    EXPECT_FALSE(watched.changed());
    const auto later = [&](int seconds) {
        std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) +
                                                   std::chrono::seconds(seconds));
    };
    later(1);
    EXPECT_FALSE(watched.changed());
    writeFile(file, "{}");
    later(5);
    EXPECT_TRUE(watched.changed());
    EXPECT_FALSE(watched.changed());
    std::filesystem::remove(file);
    EXPECT_FALSE(watched.changed());
}

TEST_F(EditorFiles, TheLastOpenedComesFirst) {
    Recent recent(state / "recent.txt");
    recent.add("/a/one.json");
    recent.add("/a/two.json");
    recent.add("/a/./one.json");
    EXPECT_THAT(recent.graphs(), ElementsAre("/a/one.json", "/a/two.json"));
    EXPECT_THAT(Recent(state / "recent.txt").graphs(), ElementsAre("/a/one.json", "/a/two.json"));
    for (int i = 0; i < 30; ++i) recent.add("/b/" + std::to_string(i) + ".json");
    EXPECT_EQ(recent.graphs().size(), Recent::most);
}

} // namespace
} // namespace kestrel::edit
