#include "graph_mock.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Registry plainRegistry() {
    Registry registry;
    registry.add(mockType("Source", {out("a"), out("b")}, simple({}, {"a", "b"})));
    registry.add(mockType("Static", {out("a")}, simple({}, {"a"}, Causes::None)));
    registry.add(mockType("Filter", {in("x"), opt("y"), out("r")}, simple({"x", "y"}, {"r"}, Causes::None)));
    return registry;
}

// "name:Type" passes and "a.x>b.y" edges as a graph file.
std::string graphText(const std::vector<std::pair<std::string, std::string>>& passes,
                      const std::vector<std::pair<std::string, std::string>>& edges,
                      const std::vector<std::string>& outputs) {
    std::string text = "{\"kestrel\": 1, \"passes\": {";
    for (size_t i = 0; i < passes.size(); ++i)
        text += (i > 0 ? ",\n\"" : "\n\"") + passes[i].first + "\": {\"type\": \"" + passes[i].second + "\"}";
    text += "}, \"edges\": [";
    for (size_t i = 0; i < edges.size(); ++i)
        text += (i > 0 ? ",\n[\"" : "\n[\"") + edges[i].first + "\", \"" + edges[i].second + "\"]";
    text += "], \"outputs\": [";
    for (size_t i = 0; i < outputs.size(); ++i) text += (i > 0 ? ", \"" : "\"") + outputs[i] + "\"";
    return text + "]}";
}

TEST(Compile, LeavesOutWhatNobodyReadsAndSaysWhy) {
    const Plan plan = compileText(
        graphText({{"late", "Filter"}, {"s", "Source"}, {"rival", "Filter"}, {"rival2", "Filter"}},
                  {{"s.a", "late.x"}, {"s.b", "rival.x"}, {"rival.r", "rival2.x"}}, {"late.r"}),
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

TEST(Compile, ASettingMovesWhatIsLeftOut) {
    const Registry registry = plainRegistry();
    Graph graph = parseGraph(
        graphText({{"s", "Source"}, {"t", "Source"}, {"f", "Filter"}}, {{"s.a", "f.x"}}, {"f.r"}), "g");
    const PassSet passes = makePasses(graph, registry);
    EXPECT_THAT(passNames(compile(graph, registry, passes, {})), ElementsAre("s", "f"));
    applySetting(graph, registry, "f.x=t.a");
    const Plan plan = compile(graph, registry, passes, {});
    EXPECT_THAT(passNames(plan), ElementsAre("t", "f"));
    EXPECT_THAT(leftOutTexts(plan), ElementsAre("s: nobody reads 's.a' or 's.b'", "t.b: nobody reads it"));
}

TEST(Compile, KeepAllLeavesNothingOut) {
    CompileOptions options;
    options.keepAll = true;
    const Plan plan = compileText(graphText({{"s", "Source"}, {"late", "Filter"}, {"rival", "Filter"}},
                                            {{"s.a", "late.x"}, {"s.b", "rival.x"}}, {"late.r"}),
                                  plainRegistry(), options);
    EXPECT_THAT(passNames(plan), ElementsAre("s", "late", "rival"));
    EXPECT_THAT(plan.leftOut, IsEmpty());
}

TEST(Compile, PreviewsKeepWhatTheyShow) {
    Registry registry = plainRegistry();
    registry.add(mockType("Inner", {out("r"), internal("scratch")},
                          [](const World&, const Inputs&, const Demand& demand) {
                              Declaration d;
                              d.outputs = {output("r"), output("scratch")};
                              d.steps = {step("s", {writes("scratch"), writes("r")})};
                              if (demand.reads("scratch"))
                                  d.steps.push_back(step("show", {writes("scratch")}));
                              return d;
                          }));
    const std::string text =
        graphText({{"s", "Source"}, {"i", "Inner"}, {"f", "Filter"}}, {{"s.a", "f.x"}}, {"i.r"});
    EXPECT_THAT(passNames(compileText(text, registry)), ElementsAre("i"));
    CompileOptions options;
    options.previews = {{"f", "x"}, {"i", "scratch"}};
    const Plan plan = compileText(text, registry, options);
    EXPECT_THAT(passNames(plan), ElementsAre("s", "i"));
    ASSERT_EQ(plan.outputs.size(), 3u);
    EXPECT_EQ(plan.resources[static_cast<size_t>(plan.outputs[1].resource)].port.text(), "s.a");
    EXPECT_TRUE(plan.outputs[1].preview);
    EXPECT_EQ(plan.passes[1].stepCount, 2);
    options.previews = {{"f", "z"}, {"g", "x"}, {"f", "y"}};
    EXPECT_EQ(
        messageOf([&] { compileText(text, registry, options); }),
        "pass 'f' (Filter) has no port 'z' (did you mean 'x'?)\nthere is no pass 'g' (in 'g.x') (did you "
        "mean 's'?)\nthe input 'f.y' is not connected");
}

// ---- constants and `same`

Registry constantRegistry() {
    Registry registry = plainRegistry();
    registry.add(mockType("Constant", {out("a")}, [](const World&, const Inputs&, const Demand&) {
        Declaration d;
        d.outputs = {output("a")};
        d.outputs[0].constant = glm::vec4(0.5f);
        return d;
    }));
    // A constant in is a constant out; else it multiplies.
    registry.add(mockType("Twice", {in("x"), out("r")}, [](const World&, const Inputs& in, const Demand&) {
        Declaration d;
        d.outputs = {output("r", in["x"].desc)};
        if (in["x"].constant)
            d.outputs[0].constant = *in["x"].constant * 2.0f;
        else
            d.steps = {step("s", {reads("x"), writes("r")})};
        return d;
    }));
    // The same as `x` where there is no `mask`.
    registry.add(
        mockType("Mask", {in("x"), opt("mask"), out("r")}, [](const World&, const Inputs& in, const Demand&) {
            Declaration d;
            d.outputs = {output("r")};
            if (!in.connected("mask"))
                d.outputs[0].same = "x";
            else
                d.steps = {step("s", {reads("x"), reads("mask"), writes("r")})};
            return d;
        }));
    return registry;
}

TEST(Compile, ConstantsRunThroughChainsAndBranchesGo) {
    const std::string text =
        graphText({{"c", "Constant"}, {"t1", "Twice"}, {"m", "Mask"}, {"t2", "Twice"}, {"f", "Filter"}},
                  {{"c.a", "t1.x"}, {"t1.r", "m.x"}, {"m.r", "t2.x"}, {"t2.r", "f.x"}}, {"f.r"});
    const Plan plan = compileText(text, constantRegistry());
    EXPECT_THAT(passNames(plan), ElementsAre("f"));
    const PlanResource* constant = resourceAt(plan, "t2.r"); // `f` does not know constants: it reads an image
    ASSERT_NE(constant, nullptr);
    EXPECT_EQ(*constant->constant, glm::vec4(2.0f));
    EXPECT_FALSE(constant->transient);
    EXPECT_EQ(plan.resources.size(), 2u); // nobody binds the other constants
    EXPECT_THAT(plan.passes[0].inputs, IsEmpty());
    EXPECT_THAT(leftOutTexts(plan), testing::Contains("t2.r: it is 2, 2, 2, 2 everywhere"));

    CompileOptions keep;
    keep.keepAll = true;
    const Plan kept = compileText(text, constantRegistry(), keep);
    EXPECT_THAT(passNames(kept), ElementsAre("t1", "t2", "f")); // now they compute it
    EXPECT_TRUE(resourceAt(kept, "c.a")->constant);
}

TEST(Compile, AnInputThatIsPassedOnNeedsNoPass) {
    const Plan plan =
        compileText(graphText({{"s", "Source"}, {"m1", "Mask"}, {"m2", "Mask"}, {"f", "Filter"}},
                              {{"s.a", "m1.x"}, {"m1.r", "m2.x"}, {"m2.r", "f.x"}}, {"f.r", "m2.r"}),
                    constantRegistry());
    EXPECT_THAT(passNames(plan), ElementsAre("s", "f"));
    EXPECT_EQ(plan.passes[1].ports.at("x"), plan.passes[0].ports.at("a"));
    EXPECT_EQ(plan.outputs[1].resource, plan.passes[0].ports.at("a"));
    EXPECT_FALSE(resourceAt(plan, "s.a")->transient); // an output of the graph
    EXPECT_THAT(plan.passes[1].inputs, ElementsAre(0));
    EXPECT_THAT(leftOutTexts(plan),
                ElementsAre("s.b: nobody reads it", "m1.r: it is the same as the input 'x'",
                            "m2.r: it is the same as the input 'x'"));
}

TEST(Compile, AMutedPassHandsItsInputOnAndSaysSo) {
    Registry registry = plainRegistry();
    registry.add(mockType("Choosy",
                          {in("depth", PortKind::Buffer), in("image"), opt("tracer", PortKind::Tracer),
                           out("r"), out("layers", PortKind::Layers)},
                          simple({"depth", "image"}, {"r"})));
    registry.add(
        mockType("Depths", {out("b", PortKind::Buffer)}, [](const World&, const Inputs&, const Demand&) {
            Declaration d;
            d.outputs.push_back(output("b", Desc::buffer(16)));
            d.steps.push_back(step("only", {writes("b", Access::Storage)}));
            return d;
        }));
    const std::string text = R"({"kestrel": 1, "passes": {"s": {"type": "Source"}, "d": {"type": "Depths"},
        "c": {"type": "Choosy", "muted": true}, "f": {"type": "Filter"}},
        "edges": [["s.a", "c.image"], ["d.b", "c.depth"], ["c.r", "f.x"]], "outputs": ["f.r", "c.r"]})";
    const Plan plan = compileText(text, registry);
    EXPECT_THAT(passNames(plan), ElementsAre("s", "f")); // what only the muted pass reads is left out too
    EXPECT_EQ(plan.outputs[1].port.text(), "c.r");
    EXPECT_EQ(plan.outputs[1].resource, plan.passes[0].ports.at("a"));
    EXPECT_THAT(leftOutTexts(plan), testing::IsSupersetOf({"c.r: it is the same as the input 'image'",
                                                           "c: its work: it is muted"}));
    // Nothing of its kind is connected: the output that is asked for cannot be made.
    EXPECT_EQ(
        messageOf([&] {
            compileText(R"({"kestrel": 1, "passes": {"s": {"type": "Source", "muted": true}},
"outputs": ["s.a"]})",
                        registry);
        }),
        "g.json:2:13: the output 's.a' cannot be made: the pass is muted, and no texture that feeds it can "
        "stand for "
        "'a'");
}

TEST(Compile, DeclaringAgainDropsWhatIsReadForNobody) {
    Registry registry = plainRegistry();
    // Reads `x` only for output `p`, and only the far input where the near one is not constant.
    registry.add(mockType("Pick", {in("x"), in("y"), out("p"), out("q")},
                          [](const World&, const Inputs&, const Demand& demand) {
                              Declaration d;
                              if (demand.reads("p")) {
                                  d.outputs.push_back(output("p"));
                                  d.steps.push_back(step("p", {reads("x"), writes("p")}));
                              }
                              if (demand.reads("q")) {
                                  d.outputs.push_back(output("q"));
                                  d.steps.push_back(step("q", {reads("y"), writes("q")}));
                              }
                              d.leftOut = {{"alpha test", "no material is masked"}};
                              return d;
                          }));
    const Plan plan = compileText(graphText({{"s", "Source"}, {"t", "Source"}, {"pick", "Pick"}},
                                            {{"s.a", "pick.x"}, {"t.a", "pick.y"}}, {"pick.q"}),
                                  registry);
    EXPECT_THAT(passNames(plan), ElementsAre("t", "pick"));
    EXPECT_THAT(leftOutTexts(plan),
                ElementsAre("s: 'pick.x' does not need it here", "t.b: nobody reads it",
                            "pick.p: nobody reads it", "pick: alpha test: no material is masked"));
}

TEST(Compile, WhatAProducerCannotMakeTakesItsReadersAlong) {
    Registry registry = plainRegistry();
    registry.add(mockType("Still", {out("motion"), out("depth")},
                          [](const World& world, const Inputs&, const Demand&) {
                              Declaration d;
                              d.outputs = {output("depth")};
                              d.steps = {step("s", {writes("depth")})};
                              if (world.facts.geometryMoves) {
                                  d.outputs.push_back(output("motion"));
                                  d.steps[0].uses.push_back(writes("motion"));
                              } else {
                                  d.leftOut = {{"motion", "nothing moves"}};
                              }
                              return d;
                          }));
    const std::vector<std::pair<std::string, std::string>> passes = {
        {"g", "Still"}, {"f", "Filter"}, {"both", "Filter"}};
    const Plan plan = compileText(
        graphText(passes, {{"g.motion", "f.x"}, {"g.depth", "both.x"}, {"f.r", "both.y"}}, {"both.r"}),
        registry);
    EXPECT_THAT(passNames(plan), ElementsAre("g", "both"));
    EXPECT_EQ(plan.steps[1].bindings.size(), 2u); // y is absent
    EXPECT_THAT(leftOutTexts(plan),
                testing::Contains("f: its input 'x' needs 'g.motion', which is not made here"));
    EXPECT_EQ(
        messageOf([&] {
            compileText(graphText(passes, {{"g.motion", "f.x"}, {"g.depth", "both.x"}}, {"g.motion", "f.r"}),
                        registry);
        }),
        "g.json:6:37: the output 'g.motion' cannot be made: nothing moves\n"
        "g.json:6:49: the output 'f.r' cannot be made: its input 'x' needs 'g.motion', which is not made "
        "here");
}

// ---- in-place updates and history

Registry updateRegistry() {
    Registry registry = plainRegistry();
    registry.add(mockType("Update", {in("image"), opt("other"), out("result")},
                          [](const World&, const Inputs& in, const Demand&) {
                              Declaration d;
                              d.depends = Causes::Frame;
                              Output result = output("result");
                              result.updates = "image";
                              d.outputs = {result};
                              d.steps = {step("s", {writes("result")})};
                              if (in.connected("other")) d.steps[0].uses.push_back(reads("other"));
                              return d;
                          }));
    registry.add(mockType("History", {in("x"), out("r")}, [](const World&, const Inputs&, const Demand&) {
        Declaration d;
        d.always = true;
        d.outputs = {output("r")};
        Use previous = reads("r");
        previous.previous = true;
        d.steps = {step("s", {reads("x"), previous, writes("r")})};
        return d;
    }));
    return registry;
}

TEST(Compile, AnUpdateInPlaceComesAfterTheOtherReaders) {
    // `u` stands before the other reader in the document, and could run before it.
    const Plan plan =
        compileText(graphText({{"s", "Source"}, {"u", "Update"}, {"f", "Filter"}, {"g", "Filter"}},
                              {{"s.a", "u.image"}, {"s.a", "f.x"}, {"u.result", "g.x"}}, {"f.r", "g.r"}),
                    updateRegistry());
    EXPECT_THAT(passNames(plan), ElementsAre("s", "f", "u", "g"));
    EXPECT_EQ(passAt(plan, "u")->ports.at("result"), passAt(plan, "s")->ports.at("a"));
    for (const PlanStep& step : plan.steps) EXPECT_THAT(step.copies, IsEmpty());
    const PlanResource* resource = resourceAt(plan, "s.a");
    EXPECT_TRUE(resource->transient);
    EXPECT_EQ(resource->firstStep, 0);
    EXPECT_EQ(resource->lastStep, 3);
}

TEST(Compile, AnUpdateCopiesWhereSomebodyStillNeedsTheOldContent) {
    const auto copies = [](const Plan& plan) {
        std::vector<std::string> texts;
        for (const PlanStep& step : plan.steps)
            for (const auto& [from, to] : step.copies)
                texts.push_back(plan.resources[static_cast<size_t>(from)].port.text() + ">" +
                                plan.resources[static_cast<size_t>(to)].port.text());
        return texts;
    };
    const Registry registry = updateRegistry();
    // The other reader needs the update's result too.
    EXPECT_THAT(
        copies(compileText(graphText({{"s", "Source"}, {"u", "Update"}, {"f", "Filter"}},
                                     {{"s.a", "u.image"}, {"s.a", "f.x"}, {"u.result", "f.y"}}, {"f.r"}),
                           registry)),
        ElementsAre("s.a>u.result"));
    // The old content is shown.
    EXPECT_THAT(copies(compileText(
                    graphText({{"s", "Source"}, {"u", "Update"}}, {{"s.a", "u.image"}}, {"s.a", "u.result"}),
                    registry)),
                ElementsAre("s.a>u.result"));
    // The producer runs less often than the update: the second update would update an updated image.
    EXPECT_THAT(
        copies(compileText(graphText({{"s", "Static"}, {"u", "Update"}}, {{"s.a", "u.image"}}, {"u.result"}),
                           registry)),
        ElementsAre("s.a>u.result"));
    // It is read in the next frame.
    EXPECT_THAT(copies(compileText(graphText({{"s", "Source"}, {"h", "History"}, {"u", "Update"}},
                                             {{"s.a", "h.x"}, {"h.r", "u.image"}}, {"u.result"}),
                                   registry)),
                ElementsAre("h.r>u.result"));
    // Two updates of one image: the first one copies.
    EXPECT_THAT(
        copies(compileText(graphText({{"s", "Source"}, {"u", "Update"}, {"v", "Update"}},
                                     {{"s.a", "u.image"}, {"s.a", "v.image"}}, {"u.result", "v.result"}),
                           registry)),
        ElementsAre("s.a>v.result"));
    // A chain of updates needs none.
    EXPECT_THAT(copies(compileText(graphText({{"s", "Source"}, {"u", "Update"}, {"v", "Update"}},
                                             {{"s.a", "u.image"}, {"u.result", "v.image"}}, {"v.result"}),
                                   registry)),
                IsEmpty());
}

TEST(Compile, AHistoryHasTwoObjectsAndIsNeverShared) {
    const Plan plan = compileText(graphText({{"s", "Source"}, {"h", "History"}, {"f", "Filter"}},
                                            {{"s.a", "h.x"}, {"h.r", "f.x"}}, {"f.r"}),
                                  updateRegistry());
    const PlanResource* history = resourceAt(plan, "h.r");
    EXPECT_TRUE(history->history);
    EXPECT_FALSE(history->transient);
    ASSERT_EQ(plan.objects.size(), 4u);
    EXPECT_EQ(plan.objects[static_cast<size_t>(history->object) + 1].label, "h.r (last frame)");
    EXPECT_EQ(plan.memory.persistent, 3u * 16 * 16 * 8); // the history twice, and the output
    EXPECT_EQ(plan.memory.transient, 1u * 16 * 16 * 8);
    std::vector<std::string> names;
    for (const PlanBinding& binding : plan.steps[1].bindings) names.push_back(binding.name);
    EXPECT_THAT(names, ElementsAre("x", "previous_r", "r"));
    EXPECT_TRUE(plan.passes[1].always);
}

// ---- causes

TEST(Compile, FactsSayWhichCausesCanComeUp) {
    std::map<std::string, Causes> seen;
    Registry registry = plainRegistry();
    registry.add(
        mockType("Build", {out("a")}, simple({}, {"a"}, Causes::Geometry | Causes::Camera | Causes::Size)));
    registry.add(
        mockType("Look", {in("x"), out("r")}, [&seen](const World&, const Inputs& in, const Demand& demand) {
            seen["x"] = in["x"].causes;
            return simple({"x"}, {"r"}, Causes::None)({}, in, demand);
        }));
    const std::string text = graphText({{"b", "Build"}, {"l", "Look"}}, {{"b.a", "l.x"}}, {"l.r"});
    World world;
    Plan plan = compileText(text, registry, {}, world);
    EXPECT_EQ(seen["x"], Causes::Size);
    EXPECT_FALSE(plan.passes[1].everyFrame);
    EXPECT_FALSE(resourceAt(plan, "b.a")->transient);
    EXPECT_EQ(plan.passes[0].depends, Causes::Geometry | Causes::Camera | Causes::Size);
    world.facts.geometryMoves = world.facts.cameraMoves = true;
    plan = compileText(text, registry, {}, world);
    EXPECT_EQ(seen["x"], Causes::Geometry | Causes::Camera | Causes::Size);
    EXPECT_FALSE(plan.passes[1].everyFrame); // an animation may pause
}

TEST(Compile, ExtentOfAViewCountsGuardBandAndDivisor) {
    World world;
    world.size = {101, 51, 1};
    View view;
    EXPECT_EQ(world.extentOf(view), (Extent{101, 51, 1}));
    view.guard = 8;
    view.divisor = 4;
    EXPECT_EQ(world.extentOf(view), (Extent{30, 17, 1})); // (101 + 16) / 4, (51 + 16) / 4, rounded up
}

TEST(Compile, ALongChainTwiceTheSame) {
    std::vector<std::pair<std::string, std::string>> passes = {{"s", "Source"}}, edges;
    for (int i = 0; i < 60; ++i) {
        passes.emplace_back("f" + std::to_string(i), "Filter");
        edges.emplace_back(i == 0 ? "s.a" : "f" + std::to_string(i - 1) + ".r",
                           "f" + std::to_string(i) + ".x");
    }
    const std::string text = graphText(passes, edges, {"f59.r"});
    const Plan plan = compileText(text, plainRegistry());
    EXPECT_EQ(plan.steps.size(), 61u);
    // A chain needs two images by turns, and the output its own.
    EXPECT_EQ(plan.objects.size(), 3u);
    const Plan again = compileText(text, plainRegistry());
    ASSERT_EQ(plan.steps.size(), again.steps.size());
    for (size_t i = 0; i < plan.steps.size(); ++i) {
        EXPECT_EQ(plan.steps[i].barrier, again.steps[i].barrier);
        ASSERT_EQ(plan.steps[i].bindings.size(), again.steps[i].bindings.size());
        for (size_t j = 0; j < plan.steps[i].bindings.size(); ++j)
            EXPECT_EQ(plan.steps[i].bindings[j].resource, again.steps[i].bindings[j].resource);
    }
}

} // namespace
} // namespace kestrel
