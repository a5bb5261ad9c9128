#include "graph_mock.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using namespace test;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

Registry plainRegistry() {
    Registry registry;
    registry.add(mockType("Source", {out("a"), out("b")}, simple({}, {"a", "b"})));
    registry.add(mockType("Filter", {in("x"), opt("y"), out("r")}, simple({"x", "y"}, {"r"})));
    return registry;
}

TEST(Compile, LeavesOutWhatNobodyReadsAndSaysWhy) {
    const Plan plan = compileText(R"({"kestrel": 1, "passes": {
        "late": {"type": "Filter"}, "s": {"type": "Source"}, "rival": {"type": "Filter"},
        "rival2": {"type": "Filter"}},
        "edges": [["s.a", "late.x"], ["s.b", "rival.x"], ["rival.r", "rival2.x"]],
        "outputs": ["late.r"]})",
                                  plainRegistry());
    EXPECT_THAT(passNames(plan), ElementsAre("s", "late"));
    EXPECT_THAT(leftOutTexts(plan),
                ElementsAre("s.b: nobody reads it", "rival: only 'rival2' would read it, which is left out",
                            "rival2: nobody reads 'rival2.r'"));
    ASSERT_EQ(plan.outputs.size(), 1u);
    EXPECT_EQ(plan.resources[static_cast<size_t>(plan.outputs[0].resource)].port.text(), "late.r");
    EXPECT_EQ(resourceAt(plan, "s.b"), nullptr);
    ASSERT_EQ(plan.steps.size(), 2u);
    EXPECT_EQ(plan.steps[1].bindings[0].name, "x");
    EXPECT_EQ(plan.steps[1].bindings[0].resource, plan.passes[0].ports.at("a"));
    EXPECT_EQ(plan.passes[1].ports.at("x"), plan.passes[0].ports.at("a"));
    EXPECT_THAT(plan.passes[1].inputs, ElementsAre(0));
    EXPECT_EQ(plan.programs.size(), 1u); // all mocks have one shader
    EXPECT_EQ(plan.steps[1].barrier, Barrier::TextureFetch);
}

TEST(Compile, KeepAllLeavesNothingOut) {
    CompileOptions options;
    options.keepAll = true;
    const Plan plan = compileText(R"({"kestrel": 1, "passes": {
        "s": {"type": "Source"}, "late": {"type": "Filter"}, "rival": {"type": "Filter"}},
        "edges": [["s.a", "late.x"], ["s.b", "rival.x"]], "outputs": ["late.r"]})",
                                  plainRegistry(), options);
    EXPECT_THAT(passNames(plan), ElementsAre("s", "late", "rival"));
    EXPECT_TRUE(plan.leftOut.empty());
}

} // namespace
} // namespace kestrel
