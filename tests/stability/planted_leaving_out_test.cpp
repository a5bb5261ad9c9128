// A pass that claims not to need what it reads is found by its name.
#include "leaving_out.h"
#include "shipped_fixture.h"
#include "support/folders.h"
#include <gmock/gmock.h>

namespace kestrel::test {
namespace {

struct PlantedLeavingOut : ShippedTest {
    static const Registry& registry() {
        static const Registry planted = [] {
            Registry made;
            std::vector<std::filesystem::path> folders = pluginFolders();
            folders.push_back(buildFolder() / "test_plugins" / "planted");
            for (const PluginResult& failure : loadPlugins(made, folders)) ADD_FAILURE() << failure.message;
            return made;
        }();
        return planted;
    }
    // The wrong pass stands in the middle: what is seen is made of its picture by a pass that is right.
    static LeavingOut found(const char* type, const char* scene) {
        const Graph graph = parseGraph(fmt::format(R"({{ "kestrel": 1,
                "passes": {{ "gbuffer": {{ "type": "GBuffer" }}, "middle": {{ "type": "{}" }},
                             "mean": {{ "type": "Accumulate" }} }},
                "edges": [["gbuffer.view_depth", "middle.view_depth"], ["middle.result", "mean.signal"]],
                "outputs": ["mean.result"] }})",
                                                   type),
                                       "planted.json");
        return leavingOut(graph, registry(), loadScene(scene), context().capabilities(), {32, 18, 1});
    }
};

TEST_F(PlantedLeavingOut, IsFoundByName) {
    const LeavingOut wrong = found("ClaimsNoNeed", "builtin:blob?detail=0.02");
    ASSERT_EQ(wrong.mistakes.size(), 1u);
    EXPECT_THAT(wrong.mistakes.front(), testing::HasSubstr("leaving out changes 'mean.result'"));
    EXPECT_THAT(
        wrong.mistakes.front(),
        testing::HasSubstr("pass 'middle' (ClaimsNoNeed), port 'result', is the first that is not the same"));
}

TEST_F(PlantedLeavingOut, WhatIsRightIsNot) {
    EXPECT_TRUE(found("FixedEpsilon", "builtin:blob?detail=0.02").mistakes.empty());
    // Where it keeps its word: something is blended.
    EXPECT_TRUE(found("ClaimsNoNeed", "builtin:cornell?blended=0.5").mistakes.empty());
}

} // namespace
} // namespace kestrel::test
