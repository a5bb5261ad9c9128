// Stress cases as data, how pictures are compared, results as text.
#include "core/files.h"
#include "graph/plan.h"
#include "measure/stress/stress_distance.h"
#include "measure/stress/stress_limits.h"
#include "measure/stress/stress_results.h"
#include "support/folders.h"
#include "support/temporary_folder.h"
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

namespace kestrel {
namespace {

using testing::HasSubstr;

class Lengths final : public Pass {
public:
    float radius = 0.5f, share = 0.5f;
    int guard = 0;
    [[nodiscard]] Declaration declare(const World&, const Inputs&, const Demand&) const override {
        return {};
    }
};

Registry lengths() {
    Registry registry;
    registry.add(Describe<Lengths>("Lengths", "Has lengths")
                     .number("radius", &Lengths::radius, 1e-3, 1e3, "scene units", "A length")
                     .number("share", &Lengths::share, 0, 1, "", "No length")
                     .number("guard", &Lengths::guard, 0, 64, "pixels", "Whole"));
    return registry;
}

TEST(StressCases, AreManyEachOfItsKindByItsName) {
    std::set<std::string> names;
    for (const StressCase& one : stressCases()) {
        EXPECT_TRUE(names.insert(one.name).second) << one.name;
        EXPECT_EQ(one.name.substr(0, one.name.find('/')), stressKindName(one.kind));
        EXPECT_FALSE(one.does.empty() || one.does.ends_with('.')) << one.name;
        EXPECT_EQ(one.expects == StressExpects::EnergyHeld, one.reflectance > 0) << one.name;
    }
    EXPECT_GE(names.size(), 60u);
    EXPECT_EQ(chooseStressCases("").size(), names.size());
    EXPECT_EQ(chooseStressCases("scale").size(), 6u);
    EXPECT_EQ(chooseStressCases("numbers/plain").size(), 1u);
    EXPECT_THROW(static_cast<void>(chooseStressCases("scael")), InputError);
}

TEST(StressGraph, ScalesLengthsAndNothingElse) {
    const Registry registry = lengths();
    const Graph graph = parseGraph(
        R"({ "kestrel": 1, "passes": { "a": { "type": "Lengths", "properties": { "radius": 0.25 } }, "b": { "type": "Lengths" } } })",
        "g.json");
    const auto radius = [&](const Graph& of, const char* pass) {
        const auto passes = makePasses(of, registry);
        return static_cast<const Lengths&>(*passes.at(pass)).radius;
    };
    const Graph larger = stressGraph(graph, registry, 100, {});
    EXPECT_EQ(radius(larger, "a"), 25);
    EXPECT_EQ(radius(larger, "b"), 50) << "its default counts";
    EXPECT_EQ(radius(stressGraph(graph, registry, 1e6, {}), "a"), 1000) << "the end of its range";
    const std::vector<StressProperty> changes = {{.name = "guard", .unit = "pixels", .value = 1e3},
                                                 {.unit = "scene units", .to = StressProperty::To::Least}};
    const Graph changed = stressGraph(graph, registry, 1, changes);
    EXPECT_EQ(radius(changed, "a"), 1e-3f);
    EXPECT_EQ(static_cast<const Lengths&>(*makePasses(changed, registry).at("a")).guard, 64);
    EXPECT_EQ(static_cast<const Lengths&>(*makePasses(changed, registry).at("a")).share, 0.5f);
    EXPECT_TRUE(validate(changed, registry).empty());
}

class Bounces final : public Pass {
public:
    int bounces = 2;
    [[nodiscard]] Declaration declare(const World&, const Inputs&, const Demand&) const override {
        return {};
    }
};

TEST(StressEnergy, IsThatOfAsManyBouncesAsTheGraphFollows) {
    Registry registry = lengths();
    registry.add(Describe<Bounces>("Bounces", "Follows")
                     .number("bounces", &Bounces::bounces, 1, 8, "rays", "How many"));
    const auto light = [&](const char* passes) {
        return closedRoomLight(
            parseGraph(fmt::format(R"({{ "kestrel": 1, "passes": {{ {} }} }})", passes), "g.json"), registry,
            0.5);
    };
    EXPECT_EQ(light(R"("a": { "type": "Lengths" })"), 1.5);
    EXPECT_EQ(light(R"("a": { "type": "Bounces" })"), 1.75);
    EXPECT_EQ(
        light(R"("a": { "type": "Bounces" }, "b": { "type": "Bounces", "properties": { "bounces": 3 } })"),
        1.875);
}

TEST(StressDistance, SeesWhatIsOffEverywhereAndWhatIsFarOffSomewhere) {
    const Image plain(20, 10, 1, 0.5f);
    EXPECT_EQ(stressDistance(plain, plain).mean, 0);
    EXPECT_EQ(stressRatio(stressDistance(plain, plain), {}), 0);
    const Image brighter(20, 10, 1, 0.55f);
    EXPECT_NEAR(stressDistance(plain, brighter).mean, 0.1, 1e-6);
    EXPECT_NEAR(stressRatio(stressDistance(plain, brighter), {}), 0.1 / 0.005, 1e-3);
    Image spot = plain;
    spot.at(3, 7) = 0;
    const StressDistance one = stressDistance(plain, spot);
    EXPECT_EQ(one.x, 3);
    EXPECT_EQ(one.y, 7);
    EXPECT_NEAR(stressRatio(one, {}), 1, 1e-6) << "one pixel in two hundred";
    EXPECT_NEAR(stressRatio(one, {.mean = 0.1, .rms = 0.1}), one.rms / 0.125, 1e-6);
    Image bad = plain;
    bad.at(1, 2) = NAN;
    EXPECT_TRUE(std::isinf(stressDistance(plain, bad).mean));
    EXPECT_TRUE(std::isinf(stressDistance(plain, Image(10, 10, 1)).mean));
    Image half(4, 1, 1);
    half.values = {1, 2, 3, 4};
    EXPECT_EQ(mirrored(half).values, (std::vector<float>{4, 3, 2, 1}));
}

StressResult exampleResult() {
    StressResult result;
    result.name = "scale/1e+06";
    result.outcome = StressOutcome::Missed;
    result.ms = 12.5;
    result.checks = {{.port = "a.x", .expects = "finite"},
                     {.port = "a.y",
                      .expects = "same",
                      .held = false,
                      .missed = INFINITY,
                      .x = 3,
                      .y = 4,
                      .what = "<far>",
                      .picture = "pictures/p.png"},
                     {.port = "a.z", .expects = "same", .missed = 1.5, .limit = "a reason"}};
    result.command = "kestrel stress g.json --only scale/1e+06";
    return result;
}

TEST(StressResults, ComeBackFromTheirFile) {
    const test::TemporaryFolder folder;
    const std::vector<StressResult> results = {exampleResult(),
                                               {.name = "frame/1x1",
                                                .outcome = StressOutcome::Hung,
                                                .why = "slow",
                                                .where = "pass 'a', step 'b'",
                                                .ms = 1}};
    const StressRunInfo info{.graph = "g.json", .scene = "s", .size = "8x8", .hash = "1"};
    writeFile(folder / "r.json", stressJson(info, results));
    EXPECT_EQ(readStressResults(folder / "r.json", info), results);
    StressRunInfo other = info;
    other.hash = "2";
    EXPECT_THROW(static_cast<void>(readStressResults(folder / "r.json", other)), InputError);
    writeFile(folder / "n.json", std::string_view("{}"));
    EXPECT_THROW(static_cast<void>(readStressResults(folder / "n.json", info)), InputError);
    EXPECT_EQ(stressText(results[0]),
              "scale/1e+06: missed: <far>\n    kestrel stress g.json --only scale/1e+06\n");
    EXPECT_THAT(stressText(results[1]), HasSubstr("frame/1x1: hung: slow, in pass 'a', step 'b'\n"));
    EXPECT_EQ(stressText({.name = "frame/1x1"}), "");
    const std::string page = stressPage(info, results);
    EXPECT_THAT(page, HasSubstr("<td class=\"missed\" title=\"same: &lt;far&gt;\">×</td>"));
    EXPECT_THAT(page, HasSubstr("<td class=\"limit\" title=\"same 1.50 of what is allowed: a reason\">"));
    EXPECT_THAT(page, HasSubstr("src=\"pictures/p.png\""));
    EXPECT_THAT(page, HasSubstr("id=\"frame/1x1\""));
}

TEST(StressLimits, AreThoseOfTheReadme) {
    EXPECT_THAT(readText(test::sourceFolder() / "README.md"), HasSubstr(stressLimitsMarkdown()));
    for (const StressLimit& limit : stressLimits()) {
        EXPECT_FALSE(limit.pass.empty() && limit.graph.empty()) << limit.reason;
        EXPECT_NO_THROW(static_cast<void>(chooseStressCases(limit.cases))) << limit.cases;
    }
}

TEST(StressLimits, NeverExcuseWhatIsNotFinite) {
    Graph graph;
    for (const StressLimit& limit : stressLimits()) {
        graph.passes.resize(1);
        graph.passes[0].type = limit.pass;
        graph.file = limit.graph + ".json";
        StressResult result;
        result.name = limit.cases.find('/') == std::string::npos ? limit.cases + "/x" : limit.cases;
        const std::string port = limit.port.empty() ? "p.x" : limit.port;
        result.checks = {{.port = port, .expects = "finite", .held = false, .missed = 1},
                         {.port = port, .expects = "same", .held = false, .missed = limit.times}};
        applyStressLimits(result, graph);
        EXPECT_FALSE(result.checks[0].held);
        EXPECT_TRUE(result.checks[1].held);
        EXPECT_FALSE(result.checks[1].limit.empty());
        result.checks[1] = {.port = port, .expects = "same", .held = false, .missed = 1.01 * limit.times};
        graph.passes[0].type = "Other";
        graph.file = "other.json";
        applyStressLimits(result, graph);
        EXPECT_FALSE(result.checks[1].held);
    }
}

} // namespace
} // namespace kestrel
