// What facts of a scene leave out of the shipped passes: the README's table, and that it says what passes
// declare.
#include "core/files.h"
#include "graph/fact_effects.h"
#include "plugin/loader.h"
#include "scene/fact_list.h"
#include "support/folders.h"
#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

struct ShippedFacts : testing::Test {
    static void SetUpTestSuite() {
        loadPlugins(registry(), pluginFolders());
        for (const char* folder : {"graphs", "graphs/sweeps/graphs"})
            for (const auto& entry : std::filesystem::directory_iterator(shareFolder() / folder))
                if (entry.path().extension() == ".json" && entry.path().stem() != "schema")
                    graphs().push_back(loadGraph(entry.path()));
        std::ranges::sort(graphs(), {}, &Graph::file);
        std::erase_if(graphs(), [](const Graph& graph) { return !validate(graph, registry()).empty(); });
        effects() = factEffects(registry(), graphs());
    }
    static bool whole() { return registry().find("ReferenceAmbientOcclusion") != nullptr; }
    static Registry& registry() {
        static Registry all;
        return all;
    }
    static std::vector<Graph>& graphs() {
        static std::vector<Graph> all;
        return all;
    }
    static std::vector<FactEffect>& effects() {
        static std::vector<FactEffect> all;
        return all;
    }
    static const FactEffect* find(std::string_view fact, std::string_view pass) {
        for (const FactEffect& effect : effects())
            if (effect.fact == fact && effect.pass == pass) return &effect;
        return nullptr;
    }
};

TEST_F(ShippedFacts, AreThoseOfTheReadme) {
    if (!whole()) GTEST_SKIP() << "this build lacks passes";
    EXPECT_THAT(readText(test::sourceFolder() / "README.md"), testing::HasSubstr(factsMarkdown(effects())));
}

TEST_F(ShippedFacts, EveryPassStandsInAGraph) {
    if (!whole()) GTEST_SKIP() << "this build lacks passes";
    for (const PassType& type : registry().types()) {
        if (type.name == "Image") continue; // shows a picture of the user's own, and nothing of a scene
        EXPECT_TRUE(std::ranges::any_of(graphs(),
                                        [&](const Graph& graph) {
                                            return std::ranges::find(graph.passes, type.name,
                                                                     &GraphPass::type) != graph.passes.end();
                                        }))
            << type.name << " stands in no graph that comes with Kestrel, so its facts are not asked for";
    }
}

// Words that nothing bears out would be a table that lies.
TEST_F(ShippedFacts, WhatIsSaidToBeLeftOutIsLess) {
    for (const FactEffect& effect : effects())
        EXPECT_TRUE(effect.isLess() || effect.leftOut.empty())
            << effect.pass << " says of a scene with " << effect.fact << " that it leaves out '"
            << effect.leftOut.begin()->first << "', and declares all the same steps, outputs and defines";
}

TEST_F(ShippedFacts, AreWhatPassesDo) {
    const FactEffect* empty = find("no triangle", "GBuffer");
    ASSERT_NE(empty, nullptr);
    EXPECT_TRUE(empty->constants.contains("depth"));
    const FactEffect* emission = find("no emission", "GBuffer");
    ASSERT_NE(emission, nullptr);
    EXPECT_EQ(emission->constants, std::set<std::string>{"emission"});
    const FactEffect* opaque = find("no masked or blended material", "OccupancyMap");
    ASSERT_NE(opaque, nullptr);
    EXPECT_TRUE(opaque->defines.contains("MATERIAL_MASKED"));
    EXPECT_EQ(opaque->leftOut.begin()->first, "alpha test");
    const FactEffect* still = find("geometry at rest", "OccupancyMap");
    ASSERT_NE(still, nullptr);
    EXPECT_TRUE(still->once);
    EXPECT_EQ(find("no emission", "OccupancyMap"), nullptr);
}

} // namespace
} // namespace kestrel
