// Every shipped graph in pairs with stress cases, on small scenes: each case meets a graph, each graph meets
// each kind of case, and no graph all cases. `kestrel stress GRAPH` runs them all.
#include "measure/stress/stress_run.h"
#include "shipped_fixture.h"
#include <algorithm>
#include <set>

namespace kestrel::test {
namespace {

// So that all pairs take seconds.
std::string lightScene(const std::string& source) {
    return source.starts_with("builtin:")
               ? source.substr(0, source.find('?')) + (source == "builtin:cornell" ? "" : "?detail=0.02")
               : source;
}

// The cases that graph `index` of `count` meets: those in its turn, so that neighbours of a kind meet other
// graphs.
std::vector<size_t> casesOf(size_t index, size_t count) {
    std::vector<size_t> chosen;
    for (size_t i = index; i < stressCases().size(); i += count) chosen.push_back(i);
    return chosen;
}

TEST(StressPairs, EveryCaseMeetsAGraphAndEveryGraphCasesOfSeveralKinds) {
    const size_t graphs = shippedGraphNames().size();
    std::set<size_t> met;
    for (size_t i = 0; i < graphs; ++i) {
        std::set<StressKind> kinds;
        for (const size_t one : casesOf(i, graphs)) {
            met.insert(one);
            kinds.insert(stressCases()[one].kind);
        }
        EXPECT_GE(kinds.size(), 3u);
    }
    EXPECT_EQ(met.size(), stressCases().size());
}

struct StressPairs : ShippedTest, ::testing::WithParamInterface<std::string> {};

TEST_P(StressPairs, Hold) {
    const std::vector<std::string> names = shippedGraphNames();
    const auto index = static_cast<size_t>(std::ranges::find(names, GetParam()) - names.begin());
    const Graph graph = lightened(shippedGraph(GetParam()), 64, 4);
    for (const GraphPass& pass : graph.passes)
        if (shipped().find(pass.type) == nullptr) GTEST_SKIP() << "this build has no " << pass.type;
    StressRunner runner(graph, loadScene(lightScene(graph.sceneSource)), shipped(), context().capabilities(),
                        {.size = {32, 18, 1}});
    for (const size_t one : casesOf(index, names.size())) {
        const StressCase& which = stressCases()[one];
        const StressResult result = runner.run(which);
        EXPECT_FALSE(isBad(result.outcome)) << GetParam() << ": " << stressText(result);
    }
}

// Paths are counted in the alpha of a colour, anew after a cut: the colour recovers, the count is another.
TEST_F(ShippedTest, StressComparesTheChannelsThatAPortStates) {
    const Graph graph = lightened(shippedGraph("path_trace"), 64, 4);
    StressRunner runner(graph, loadScene(lightScene(graph.sceneSource)), shipped(), context().capabilities(),
                        {.size = {32, 18, 1}});
    const auto cut = std::ranges::find(stressCases(), "time/cut", &StressCase::name);
    ASSERT_NE(cut, stressCases().end());
    const StressResult result = runner.run(*cut);
    EXPECT_FALSE(isBad(result.outcome)) << stressText(result);
}

INSTANTIATE_TEST_SUITE_P(Graphs, StressPairs, ::testing::ValuesIn(shippedGraphNames()),
                         [](const auto& of) { return of.param; });

} // namespace
} // namespace kestrel::test
