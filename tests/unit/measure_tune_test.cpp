// What is free in a sweep file, what is kept of tuning, and what is told of it.
#include "core/files.h"
#include "graph/registry.h"
#include "measure/tune/tune_folder.h"
#include "measure/tune/tune_space.h"
#include "support/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Knobs final : public Pass {
public:
    enum class Kind { Round, Square };
    float radius = 0.5f;
    int steps = 4;
    Kind kind = Kind::Round;
    bool jitter = false;
    [[nodiscard]] Declaration declare(const World&, const Inputs&, const Demand&) const override {
        return {};
    }
};

class TuneTest : public testing::Test {
protected:
    TuneTest() {
        registry.add(Describe<Knobs>("Knobs", "Has properties")
                         .output("picture", PortKind::Texture, "A picture")
                         .number("radius", &Knobs::radius, 1e-3, 10, "scene units", "A length")
                         .number("steps", &Knobs::steps, 1, 64, "", "Whole")
                         .choice("kind", &Knobs::kind, {"round", "square"}, "One of two")
                         .flag("jitter", &Knobs::jitter, "Or not"));
        writeFile(root / "g.json", std::string_view(R"({ "kestrel": 1, "passes": { "ao": { "type": "Knobs",
            "properties": { "steps": 8 } } }, "outputs": ["ao.picture"] })"));
    }

    [[nodiscard]] Sweep load(const std::string& free,
                             const std::string& tuning = R"({ "train": ["a"] })") const {
        writeFile(root / "s.json", std::string_view(R"({ "kestrel_sweep": 1, "plot": { "error": "mse" },
 "scenes": [{ "source": "builtin:blob", "name": "a" }, { "source": "builtin:blob", "name": "b" }, { "source": "builtin:blob", "name": "c" }],
 "reference": { "graph": "g.json", "output": "ao.picture" }, "tune": )" +
                                                    tuning + R"(,
 "variants": [{ "name": "x", "graph": "g.json", "output": "ao.picture", "tune": )" +
                                                    free + R"( },
  { "name": "y", "graph": "g.json", "output": "ao.picture" }] })"));
        return loadSweep(root / "s.json");
    }

    // Every message about a file that must be refused.
    [[nodiscard]] std::vector<std::string>
    mistakesOf(const std::string& free, const std::string& tuning = R"({ "train": ["a"] })") const {
        try {
            const Sweep sweep = load(free, tuning);
            checkTuning(sweep, expandSweep(sweep), registry);
        } catch (const InputError& error) {
            std::vector<std::string> texts;
            for (const Problem& problem : error.problems()) texts.push_back(problem.text());
            return texts;
        }
        return {};
    }

    test::TemporaryFolder own;
    const std::filesystem::path& root = own.path();
    Registry registry;
};

TEST_F(TuneTest, RangesAndChoicesBecomeAxesThatBeginWhereTheGraphStands) {
    const Sweep sweep =
        load(R"({ "ao.radius": { "range": [0.1, 5], "logarithmic": true }, "ao.steps": [1, 16],
        "ao.kind": ["round", "square"], "ao.jitter": { "choices": [true] } })");
    EXPECT_THAT(sweep.tuning->train, ElementsAre("a"));
    EXPECT_THAT(sweep.tuning->holdOut, ElementsAre("b", "c")) << "all others";
    const TuneSpace space = tuneSpace(sweep, expandSweep(sweep)[0], registry);
    ASSERT_EQ(space.axes.size(), 4U);
    EXPECT_TRUE(space.axes[0].logarithmic && !space.axes[0].whole);
    EXPECT_TRUE(space.axes[1].whole);
    EXPECT_EQ(space.axes[2].choices, 2);
    EXPECT_EQ(space.axes[3].choices, 2) << "the default is one of them";
    EXPECT_THAT(space.settings(space.start),
                ElementsAre("ao.radius=0.5", "ao.steps=8", "ao.kind=round", "ao.jitter=false"));
    EXPECT_THAT(space.settings({1.25, 3, 1, 1}),
                ElementsAre("ao.radius=1.25", "ao.steps=3", "ao.kind=square", "ao.jitter=true"));
    EXPECT_THAT(mistakesOf(R"({ "ao.radius": [0.1, 5] })"), IsEmpty());
}

TEST_F(TuneTest, WhatCannotBeFreeIsToldAtOnceWithNearNames) {
    const auto form =
        mistakesOf(R"({ "ao": [0, 1], "ao.radius": [2, 1], "ao.steps": [], "ao.kind": ["a", "a"],
        "ao.jitter": { "rnage": [0, 1] } })",
                   R"({ "train": ["A", "b"], "hold_out": ["b", "d"], "stesp": 3, "time": 0 })");
    EXPECT_THAT(form, Contains(HasSubstr("what is free must be \"pass.property\", not 'ao'")));
    EXPECT_THAT(form, Contains(HasSubstr("the range of 'ao.radius' must be [low, high] with low < high")));
    EXPECT_THAT(form, Contains(HasSubstr("'ao.steps' has no choices")));
    EXPECT_THAT(form, Contains(HasSubstr("'ao.kind' has the choice 'a' twice")));
    EXPECT_THAT(form, Contains(HasSubstr("has no key 'rnage' (did you mean 'range'?)")));
    EXPECT_THAT(form, Contains(HasSubstr("the sweep has no scene of the name 'A' (did you mean 'a'?)")));
    EXPECT_THAT(form, Contains(HasSubstr("the scene 'b' is trained on: it cannot be held out")));
    EXPECT_THAT(form, Contains(HasSubstr("'tune' has no key 'stesp' (did you mean 'steps'?)")));
    EXPECT_THAT(form, Contains(HasSubstr("'time' must be a number from 0.01")));

    const auto meaning = mistakesOf(R"({ "oa.radius": [0.1, 1], "ao.raduis": [0.1, 1], "ao.radius": [0.1, 11],
        "ao.steps": [1.5, 8], "ao.kind": ["round", "sqare"], "ao.jitter": [0, 1] })");
    EXPECT_THAT(meaning, Contains(HasSubstr("there is no pass 'oa' (did you mean 'ao'?)")));
    EXPECT_THAT(meaning, Contains(HasSubstr("has no property or input 'raduis' (did you mean 'radius'?)")));
    EXPECT_THAT(meaning, Contains(testing::AllOf(HasSubstr("'radius' of pass 'ao'"), HasSubstr("10"))));
    EXPECT_THAT(meaning, Contains(testing::AllOf(HasSubstr("'steps' of pass 'ao'"), HasSubstr("1.5"))));
    EXPECT_THAT(meaning, Contains(testing::AllOf(HasSubstr("'kind'"), HasSubstr("did you mean 'square'"))));
    EXPECT_THAT(meaning, Contains(HasSubstr("'jitter' of pass 'ao'")));
    for (const std::string& mistake : meaning) EXPECT_THAT(mistake, HasSubstr("s.json:")) << "its place";
    EXPECT_THAT(mistakesOf(R"({ "ao.kind": [1, 2] })"), Contains(HasSubstr("'kind' of pass 'ao'")));
}

TEST_F(TuneTest, OnlyATunedSweepRestsOnWhatIsFree) {
    const SweepMachine machine{"aaaaaa", "cpu", "renderer", "driver", "finish", "0", 2, "2026-01-31"};
    Sweep sweep = load(R"({ "ao.radius": [0.1, 5] })");
    SweepFolder(root / "plain", sweep).begin(false, &machine);
    sweep.tuned = true;
    SweepFolder(root / "tuned", sweep).begin(false, &machine);
    Sweep other = load(R"({ "ao.radius": [0.1, 6] })", R"({ "train": ["a"], "steps": 5 })");
    EXPECT_NO_THROW(SweepFolder(root / "plain", other).begin(true, &machine));
    other.tuned = true;
    try {
        SweepFolder(root / "tuned", other).begin(true, &machine);
        ADD_FAILURE() << "what was found by another search was kept";
    } catch (const InputError& error) {
        std::string all;
        for (const Problem& problem : error.problems()) all += problem.text() + "\n";
        EXPECT_THAT(all, HasSubstr("'steps' of tuning was 10 and is 5"));
        EXPECT_THAT(all, HasSubstr("'tune' of the free properties 'x'"));
    }
}

// A run that is stopped after any measurement goes the same way again, and measures nothing twice.
TEST_F(TuneTest, AStoppedSearchGoesOnFromItsRecords) {
    Sweep sweep = load(R"({ "ao.radius": [0.1, 5], "ao.steps": [1, 64] })");
    const SweepPoint point = expandSweep(sweep)[0];
    const TuneSpace space = tuneSpace(sweep, point, registry);
    struct Stopped {};
    const auto run = [&](const std::string& name, int most, int& measured) {
        const SweepFolder results(root / name, sweep);
        const TuneFolder folder(results, point);
        return searchTuning(space.axes, space.start, {},
                            {[&](const TuneSetting& setting, double) -> std::optional<double> {
                                 const TuneSettings set = space.settings(setting);
                                 if (const auto held = folder.error(sweep.scenes[0], set)) return held->error;
                                 if (measured == most) throw Stopped();
                                 ++measured;
                                 const double error =
                                     0.1 + std::abs(setting[0] - 1.7) + std::abs(setting[1] - 20) / 100;
                                 folder.write(sweep.scenes[0], TuneErrorRecord{set, "m", "", error});
                                 return error;
                             },
                             [&](const TuneSetting& setting) {
                                 const TuneSettings set = space.settings(setting);
                                 if (const auto held = folder.time(set)) return held->ms <= held->defaultMs;
                                 folder.write(TuneTimeRecord{set, "m", 10, setting[1] < 30 ? 9.0 : 11.0});
                                 return setting[1] < 30;
                             }});
    };
    int whole = 0;
    const TuneFound found = run("whole", 1 << 20, whole);
    EXPECT_GT(whole, 30);
    int again = 0;
    for (int stop = 1; stop < whole; stop += 7) EXPECT_THROW(run("stopped", stop, again), Stopped) << stop;
    const TuneFound later = run("stopped", 1 << 20, again);
    EXPECT_EQ(again, whole);
    EXPECT_EQ(later.setting, found.setting);
    EXPECT_EQ(later.path.size(), found.path.size());
    EXPECT_EQ(later.tooSlow, found.tooSlow);
}

TEST_F(TuneTest, WhatWasFoundReadsBackAndIsJudgedBesideTheDefault) {
    const Sweep sweep = load(R"({ "ao.radius": [0.1, 5] })");
    const std::vector<SweepPoint> points = expandSweep(sweep);
    const SweepFolder results(root / "out", sweep);
    EXPECT_EQ(judgedPoints(points, results).size(), 2U) << "nothing is found yet";
    const TuneFolder folder(results, points[0]);
    TuneOutcome outcome{{"ao.radius=0.5"}, {"ao.radius=1.25"}, 0.2, 0.1, 0.9, 31, 2, {}};
    outcome.path.push_back({1, "ao.radius", {"ao.radius=1.25"}, 0.1});
    folder.write(outcome);
    const TuneOutcome read = folder.outcome().value();
    EXPECT_EQ(read.set, outcome.set);
    EXPECT_EQ(read.startError, 0.2);
    EXPECT_EQ(read.timeRatio, 0.9);
    EXPECT_EQ(read.tooSlow, 2);
    EXPECT_EQ(read.path.at(0).along, "ao.radius");
    const std::vector<SweepPoint> judged = judgedPoints(points, results);
    ASSERT_EQ(judged.size(), 3U);
    EXPECT_EQ(judged[1].name, "x, tuned");
    EXPECT_EQ(judged[1].tunedOf, "x");
    EXPECT_EQ(judged[1].settings.back().text, "ao.radius=1.25");
    EXPECT_EQ(judged[1].slug, "x-tuned");
    EXPECT_THAT(renderCommand(sweep, sweep.scenes[0], judged[1]), HasSubstr("--set ao.radius=1.25"));
    writeFile(root / "out" / "parts" / "tuning" / "x" / "outcome.json", std::string_view("{"));
    EXPECT_THROW(static_cast<void>(folder.outcome()), InputError);
}

TEST_F(TuneTest, RanksAreThoseOfEachVariantAtItsDefaultAndTuned) {
    const Sweep sweep = load(R"({ "ao.radius": [0.1, 5] })");
    const std::vector<SweepPoint> points = expandSweep(sweep);
    const SweepFolder results(root / "out", sweep);
    TuneFolder(results, points[0])
        .write(TuneOutcome{{"ao.radius=0.5"}, {"ao.radius=1"}, 0.104, 0.1, 1, 0, 0, {}});
    const auto row = [](const char* scene, const char* point, const char* tunedOf, double mse) {
        SweepRow made;
        made.scene = scene;
        made.point = point;
        made.tunedOf = tunedOf;
        made.picture.errors = SweepErrors{mse, 1, 0, {}};
        return made;
    };
    const TuneReport report =
        tuneReport(sweep, points, results,
                   {row("a", "x", "", 3), row("a", "x, tuned", "x", 1), row("a", "y", "", 2),
                    row("b", "x", "", 3), row("b", "x, tuned", "x", 2.5), row("b", "y", "", 2),
                    row("c", "x", "", 4), row("c", "x, tuned", "x", 1.5), row("c", "y", "", 2)});
    ASSERT_EQ(report.ranks.size(), 3U);
    EXPECT_TRUE(report.ranks[0].trained && report.ranks[0].changed() && !report.ranks[0].heldOut);
    EXPECT_THAT(report.ranks[0].byDefault, ElementsAre("y", "x"));
    EXPECT_THAT(report.ranks[0].byTuned, ElementsAre("x", "y"));
    EXPECT_FALSE(report.ranks[1].changed());
    EXPECT_EQ(report.heldOut(), 2U);
    EXPECT_EQ(report.heldOutChanged(), 1U);
    EXPECT_EQ(report.within(0.05), 1U);
    EXPECT_EQ(report.within(0.03), 0U);
    EXPECT_EQ(report.points.at(0).heldOutDefault, 3.5);
    EXPECT_EQ(report.points.at(0).heldOutTuned, 2);
    SweepResults told;
    told.tuning = report;
    const std::string json = resultsJson(sweep, told);
    EXPECT_THAT(json, HasSubstr("\"held_out_plots_changed\": 1"));
    EXPECT_THAT(resultsMarkdown(json, "results.json"),
                HasSubstr("| x | ao.radius=1 | 0.104 | 0.100 | 3.50 | 2.00 | 1.00 | 0 |"));
}

} // namespace
} // namespace kestrel
