#include "edit/clipboard.h"
#include "edit/document.h"
#include "edit/fits.h"
#include "edit/layout.h"
#include "edit/properties.h"
#include "editor_fixture.h"
#include <random>

namespace kestrel::edit {
namespace {

using namespace test;
using testing::ElementsAre;

TEST(EditorDocument, EveryStepIsUndoneToTheByte) {
    Document document(editedGraph());
    const Registry registry = editorRegistry();
    EXPECT_FALSE(document.modified());
    EXPECT_EQ(document.text(), editorGraph);
    EXPECT_FALSE(document.undo());

    EXPECT_TRUE(document.apply("Rename ao", [](Graph& graph) { renamePass(graph, "ao", "occlusion"); }));
    EXPECT_TRUE(
        document.apply("Remove map", [&](Graph& graph) { removePasses(graph, registry, {"map"}, false); }));
    const std::string last = document.text();
    EXPECT_TRUE(document.modified());
    EXPECT_EQ(document.undoName(), "Remove map");
    EXPECT_TRUE(document.undo());
    EXPECT_EQ(document.redoName(), "Remove map");
    EXPECT_TRUE(document.undo());
    EXPECT_EQ(document.text(), editorGraph);
    EXPECT_EQ(document.graph().file, "g.json");
    EXPECT_FALSE(document.modified());
    EXPECT_TRUE(document.redo());
    EXPECT_TRUE(document.redo());
    EXPECT_FALSE(document.redo());
    EXPECT_EQ(document.text(), last);
    // A new step forgets what was undone.
    document.undo();
    document.apply("Mute", [](Graph& graph) { setMuted(graph, {"blur"}, true); });
    EXPECT_EQ(document.redoName(), "");
    EXPECT_THAT(document.history(), ElementsAre("Rename ao", "Mute"));
}

TEST(EditorDocument, AGestureIsOneStepAndNoneIfItComesBack) {
    Document document(editedGraph());
    const auto rays = [&](int count, std::uint64_t gesture) {
        return document.apply(
            "Set ao.rays",
            [&](Graph& graph) { graph.find("ao")->properties[0].second = std::int64_t{count}; }, gesture);
    };
    for (int count = 5; count < 40; ++count) EXPECT_TRUE(rays(count, 7));
    EXPECT_FALSE(rays(39, 7)); // changes nothing
    EXPECT_TRUE(rays(10, 8));
    EXPECT_TRUE(rays(11, 0));
    EXPECT_TRUE(rays(12, 0));
    EXPECT_EQ(document.history().size(), 4u);
    document.undo();
    document.undo();
    document.undo();
    EXPECT_EQ(std::get<std::int64_t>(document.graph().find("ao")->properties[0].second), 39);
    document.undo();
    EXPECT_EQ(document.text(), editorGraph);
    rays(9, 9);
    rays(4, 9);
    EXPECT_EQ(document.text(), editorGraph);
    EXPECT_TRUE(document.history().empty());
    EXPECT_FALSE(document.modified());
}

TEST(EditorDocument, ACommandThatThrowsChangesNothing) {
    Document document(editedGraph());
    const std::uint64_t revision = document.revision();
    EXPECT_THROW(document.apply("Rename",
                                [](Graph& graph) {
                                    renamePass(graph, "ao", "occlusion");
                                    renamePass(graph, "occlusion", "blur");
                                }),
                 InputError);
    EXPECT_EQ(document.text(), editorGraph);
    EXPECT_EQ(document.revision(), revision);
    EXPECT_TRUE(document.history().empty());
}

TEST(EditorDocument, AFileThatChangedIsAStepAndSavingIsNone) {
    Document document(editedGraph());
    Graph other = editedGraph();
    other.name = "Other";
    EXPECT_TRUE(document.replace("Reload", other));
    document.markSaved("h.json");
    EXPECT_FALSE(document.modified());
    EXPECT_EQ(document.graph().file, "h.json");
    EXPECT_TRUE(document.undo());
    EXPECT_TRUE(document.modified());
    EXPECT_EQ(document.graph().file, "h.json");
}

// Thousands of commands picked at random, with nonsense among them: what is refused changes nothing, every
// state can be saved and read, and undoing all gives the first text to the byte.
TEST(EditorDocument, AMonkeyIsUndoneToTheByte) {
    const Registry registry = editorRegistry();
    Document document(editedGraph());
    std::mt19937 random(20);
    const auto pick = [&](size_t count) {
        return static_cast<size_t>(random()) % std::max<size_t>(count, 1);
    };
    std::vector<std::string> texts;
    const auto passName = [&]() -> std::string {
        const auto& passes = document.graph().passes;
        return passes.empty() || pick(20) == 0 ? "nobody" : passes[pick(passes.size())].name;
    };
    const auto portOf = [&](PortDirection direction) -> PortRef {
        const std::string pass = passName();
        const GraphPass* found = document.graph().find(pass);
        const auto names = found != nullptr ? registry.find(found->type)->portNames(direction)
                                            : std::vector<std::string>{"none"};
        return {pass, names.empty() ? "none" : names[pick(names.size())]};
    };
    const auto some = [&] {
        Names names;
        for (size_t i = 0; i < 1 + pick(3); ++i) names.insert(passName());
        return names;
    };
    size_t refused = 0;
    for (int action = 0; action < 4'000; ++action) {
        const size_t kind = document.graph().passes.size() > 60 ? 0 : pick(20);
        const auto change = [&](Graph& graph) {
            const std::string type = registry.names()[pick(registry.names().size())];
            const PortRef from = portOf(PortDirection::Output), to = portOf(PortDirection::Input);
            const glm::dvec2 at(static_cast<double>(pick(900)), static_cast<double>(pick(900)));
            switch (kind) {
            case 0:
                return removePasses(graph, registry, some(), pick(2) == 0);
            case 1:
                return static_cast<void>(addPass(graph, registry, type, at));
            case 2:
                return connect(graph, registry, from, to);
            case 3:
                return disconnect(graph, {to});
            case 4:
                return renamePass(graph, passName(), pick(3) == 0 ? "No" : freshName(graph, passName()));
            case 5:
                return static_cast<void>(duplicatePasses(graph, some(), pick(2) == 0, {20, 20}));
            case 6:
                return setMuted(graph, some(), pick(2) == 0);
            case 7:
                return movePasses(graph, some(), at);
            case 8:
                return moveEdgeEnd(graph, registry, to, portOf(PortDirection::Input), pick(2) == 0);
            case 9:
                return insertOnEdge(graph, registry, to, passName());
            case 10:
                return setOutput(graph, registry, from, pick(2) == 0);
            case 11:
                return addFrame(graph, "F", some());
            case 12:
                return static_cast<void>(pasteText(graph, registry, copyText(graph, some(), true), at));
            case 13:
                return static_cast<void>(swapType(graph, registry, passName(), type));
            case 14:
                return static_cast<void>(useInstead(graph, registry, passName(), passName()));
            case 15:
                return arrange(graph, some(), {});
            case 16:
                return setProperty(graph, registry, passName(), pick(2) == 0 ? "rays" : "radius",
                                   static_cast<double>(pick(30)));
            case 17:
                return followVariable(graph, registry, passName(), "radius",
                                      pick(2) == 0 ? "reach" : "other");
            case 18:
                return setBends(graph, to, {at});
            default:
                return pick(2) == 0 ? removeVariable(graph, "other") : removeNote(graph, pick(3));
            }
        };
        const std::string before = document.text();
        try {
            if (document.apply("Monkey", change)) texts.push_back(before);
        } catch (const InputError&) {
            ++refused;
            ASSERT_EQ(document.text(), before);
        }
        ASSERT_EQ(saveGraph(parseGraph(document.text(), "again")), document.text());
        if (pick(10) == 0 && document.undo()) {
            ASSERT_EQ(document.text(), texts.back());
            texts.pop_back();
        }
    }
    EXPECT_GT(refused, 400u);
    EXPECT_GT(texts.size(), 500u);
    while (document.undo()) {
        ASSERT_FALSE(texts.empty());
        ASSERT_EQ(document.text(), texts.back());
        texts.pop_back();
    }
    EXPECT_EQ(document.text(), editorGraph);
}

} // namespace
} // namespace kestrel::edit
