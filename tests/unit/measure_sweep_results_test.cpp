#include "core/files.h"
#include "execute/renderer.h"
#include "measure/sweep_hits.h"
#include "measure/sweep_results.h"
#include "shared/ray.h"
#include "support/temporary_folder.h"
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace kestrel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
constexpr double infinity = std::numeric_limits<double>::infinity();

// A folder with a graph and a sweep of three points on two scenes.
class SweepResultsTest : public testing::Test {
protected:
    void SetUp() override {
        writeFile(root / "g.json", std::string_view(R"({ "kestrel": 1, "passes": {} })"));
        load();
    }

    void load(const std::string& more = "") {
        writeFile(root / "s.json",
                  std::string_view(R"({ "kestrel_sweep": 1, "title": "T", "repeats": 2, )" + more + R"(
            "scenes": ["builtin:blob", "builtin:tower"], "times": { "own": ["generation", "tracing", "-bom"] },
            "reference": { "graph": "g.json", "output": "truth.visibility" },
            "variants": [{ "name": "a", "graph": "g.json", "output": "ao.visibility", "axes": { "p.x": [1, 2] } },
                         { "name": "b, <\"c\">", "graph": "g.json", "output": "ao.visibility" }] })"));
        sweep = loadSweep(root / "s.json");
        points = expandSweep(sweep);
        units = sweepUnits(sweep, points);
    }

    [[nodiscard]] static SweepRepetition repetition(int round, double scale,
                                                    const std::string& machine = "aaaaaa") {
        SweepFrame frame;
        frame.ms = 10 * scale;
        frame.steps = {{"bom", "mark", "generation", 2 * scale},
                       {"roma", "rotate", "generation", 3 * scale},
                       {"ao", "trace", "tracing", 4 * scale}};
        return {round, machine, 20, 21, {frame}};
    }

    [[nodiscard]] static SweepPicture picture(double flip) {
        SweepPicture result;
        result.machine = "aaaaaa";
        result.errors = SweepErrors{flip * flip, 1 - flip, flip, 20.0};
        result.transient = 100;
        result.persistent = 11;
        result.leftOut = {{"bvh", "nobody reads it"}};
        result.reports = {{"truth.rays", 5}};
        result.picture = "pictures/x.png";
        return result;
    }

    // Why the folder "out" is not taken; empty if it is.
    [[nodiscard]] std::string refusal(bool resume, const SweepMachine& by) const {
        try {
            SweepFolder(root / "out", sweep).begin(resume, &by);
        } catch (const InputError& error) {
            std::string all;
            for (const Problem& problem : error.problems()) all += problem.text() + "\n";
            return all;
        }
        return "";
    }

    // Everything of these units measured.
    void measure(const SweepFolder& folder, const Shard& shard, double scale = 1) {
        for (size_t i = 0; i < units.size(); ++i) {
            if (!shard.has(i)) continue;
            folder.write(sweep.scenes[static_cast<size_t>(units[i].scene)],
                         SweepReferenceRecord{0.01, 1, "r.png", {}, 0, 0, ""});
            for (const int p : units[i].points) {
                const SweepPoint& point = points[static_cast<size_t>(p)];
                folder.write(units[i], point, picture(0.1 / (p + 1)));
                for (int round = 0; round < 2; ++round)
                    folder.write(units[i], point, repetition(round, scale * (p + 1 + round)));
            }
        }
    }

    test::TemporaryFolder own;
    const std::filesystem::path& root = own.path();
    Sweep sweep;
    std::vector<SweepPoint> points;
    std::vector<SweepUnit> units;
    SweepMachine machine{"aaaaaa", "cpu", "renderer", "driver", "finish", "0", 2, "2026-01-31"};
};

TEST(Quartiles, AreLinearBetweenSortedValues) {
    EXPECT_EQ(quartilesOf({}), (Quartiles{0, 0, 0}));
    EXPECT_EQ(quartilesOf({7}), (Quartiles{7, 7, 7}));
    EXPECT_EQ(quartilesOf({4, 1, 3, 2}), (Quartiles{1.75, 2.5, 3.25}));
    EXPECT_EQ(quartilesOf({5, 1, 2, 4, 3}), (Quartiles{2, 3, 4}));
}

TEST(ParetoFront, HasWhatNothingBeats) {
    EXPECT_THAT(paretoFront({{1, 5}, {2, 4}, {3, 4}, {2, 6}, {4, 1}}), ElementsAre(0, 1, 4));
    EXPECT_TRUE(paretoFront({}).empty());
}

TEST(ParetoFront, KeepsEqualsAndPassesOverWhatIsNotFinite) {
    EXPECT_THAT(paretoFront({{2, 2}, {NAN, 0}, {1, infinity}, {2, 2}, {2, 3}}), ElementsAre(0, 3));
}

// Against the definition, on many small sets.
TEST(ParetoFront, AgreesWithItsDefinition) {
    for (unsigned seed = 0; seed < 300; ++seed) {
        std::vector<std::pair<double, double>> all;
        unsigned state = seed * 2654435761U + 1;
        const auto next = [&] { return double((state = state * 1664525U + 1013904223U) >> 29); };
        for (unsigned i = 0; i < 1 + seed % 9; ++i) all.emplace_back(next(), next());
        std::vector<size_t> front = paretoFront(all), wanted;
        for (size_t i = 0; i < all.size(); ++i) {
            const bool beaten = std::ranges::any_of(all, [&](const auto& o) {
                return o.first <= all[i].first && o.second <= all[i].second && o != all[i];
            });
            if (!beaten) wanted.push_back(i);
        }
        std::ranges::sort(front);
        EXPECT_EQ(front, wanted) << seed;
    }
}

TEST_F(SweepResultsTest, PartsReadBackAsTheyWereWritten) {
    const SweepRepetition before = repetition(1, 2.5);
    const SweepRepetition after = repetitionOf(partText(before), "x");
    EXPECT_EQ(after.round, 1);
    EXPECT_EQ(after.frames[0].steps[2].group, "tracing");
    EXPECT_EQ(after.frames[0].steps[2].ms, 10);
    SweepPicture seen = picture(0.25);
    seen.rays = SweepRayFigures{9, 0.5, 0.75, 0.125};
    const SweepPicture read = pictureOf(partText(seen), "x");
    EXPECT_EQ(read.errors, seen.errors);
    EXPECT_EQ(read.rays, seen.rays);
    EXPECT_EQ(read.leftOut[0].why, "nobody reads it");
    EXPECT_EQ(read.reports, seen.reports);
    EXPECT_EQ(machineOf(partText(machine), "x"), machine);
    EXPECT_EQ(
        referenceRecordOf(partText(SweepReferenceRecord{0.5, 2, "p", {{"a", 1}}, 0.25, 8, "h"}), "x").noise,
        0.5);
    EXPECT_THROW(static_cast<void>(repetitionOf("{", "x")), InputError);
    EXPECT_THROW(static_cast<void>(pictureOf("{}", "x")), InputError);
}

TEST_F(SweepResultsTest, TimesAreOfStepsGroupsAndWhatTheSweepNames) {
    SweepRow row;
    addTimes(row, sweep, {repetition(0, 1), repetition(1, 3)});
    EXPECT_EQ(row.repeats, 2);
    EXPECT_EQ(row.ms.at("total").median, 18);
    EXPECT_EQ(row.ms.at("frame").median, 20);
    EXPECT_EQ(row.ms.at("generation").median, 10);
    EXPECT_EQ(row.ms.at("own").median, 14) << "generation and tracing without the map";
    EXPECT_EQ(row.ms.at("tracing").q1, 6);
    ASSERT_EQ(row.steps.size(), 3U);
    EXPECT_EQ(row.steps[1].first, "roma.rotate");
    EXPECT_EQ(row.steps[1].second.median, 6);
}

TEST_F(SweepResultsTest, AStepThatDidNotRunTookNoTime) {
    SweepRepetition idle = repetition(1, 1);
    idle.frames[0].steps.pop_back();
    SweepRow row;
    addTimes(row, sweep, {repetition(0, 1), idle});
    EXPECT_EQ(row.ms.at("tracing"), (Quartiles{1, 2, 3}));
    EXPECT_EQ(row.steps[2].second.median, 2);
}

TEST_F(SweepResultsTest, TurnsOfTwoMachinesNeverMix) {
    SweepRow row;
    addTimes(row, sweep, {repetition(0, 1), repetition(1, 100, "bbbbbb"), repetition(2, 1)});
    EXPECT_EQ(row.machine, "aaaaaa");
    EXPECT_EQ(row.repeats, 2);
    EXPECT_EQ(row.ms.at("total").q3, 9);
}

TEST_F(SweepResultsTest, TheFrontIsOfOneMachineAndPlot) {
    std::vector<SweepRow> rows(3);
    for (size_t i = 0; i < 3; ++i) {
        addTimes(rows[i], sweep, {repetition(0, double(i + 1), i == 2 ? "bbbbbb" : "aaaaaa")});
        rows[i].picture = picture(0.1);
    }
    markPareto(rows, sweep);
    EXPECT_TRUE(rows[0].pareto);
    EXPECT_FALSE(rows[1].pareto) << "slower for the same error";
    EXPECT_TRUE(rows[2].pareto) << "the only one of its machine";
}

TEST_F(SweepResultsTest, JsonHasTheStatedKeys) {
    const SweepFolder folder(root / "out", sweep);
    folder.begin(false, &machine);
    folder.write(machine);
    measure(folder, {});
    const auto json = nlohmann::json::parse(resultsJson(sweep, folder.gather(points, units)));
    ASSERT_EQ(json.at("rows").size(), 6U);
    const auto& row = json.at("rows").at(1);
    for (const char* key : {"scene", "variant", "repeat_count", "ms", "memory", "mse", "psnr", "ssim", "flip",
                            "reference_noise", "command"})
        EXPECT_TRUE(row.contains(key)) << key;
    EXPECT_EQ(row.at("variant"), "a, x 2");
    EXPECT_EQ(row.at("repeat_count"), 2);
    EXPECT_EQ(row.at("ms").at("total"), 9 * 2.5);
    EXPECT_EQ(row.at("memory"), 111);
    EXPECT_EQ(row.at("flip"), 0.05);
    EXPECT_EQ(row.at("reference_noise"), 0.01);
    EXPECT_THAT(row.at("command").get<std::string>(),
                HasSubstr("--scene builtin:blob --size 640x360 --frames 16 --still "
                          "--set p.x=2 --output ao.visibility=a-x-2.exr"));
    EXPECT_EQ(json.at("machines").at(0).at("spin").at("one_thread_ms").at("median"), 20);
    EXPECT_TRUE(json.at("missing").empty());
}

TEST_F(SweepResultsTest, CsvQuotesAndHasAsManyFieldsInEveryLine) {
    const SweepFolder folder(root / "out", sweep);
    folder.begin(false, &machine);
    measure(folder, {});
    const std::string csv = resultsCsv(sweep, folder.gather(points, units));
    EXPECT_THAT(csv, HasSubstr("\"b, <\"\"c\"\">\""));
    std::vector<size_t> counts;
    bool quoted = false;
    size_t fields = 1;
    for (const char c : csv) {
        if (c == '"') quoted = !quoted;
        if (c == ',' && !quoted) ++fields;
        if (c == '\n' && !quoted) counts.push_back(std::exchange(fields, 1));
    }
    ASSERT_EQ(counts.size(), 7U);
    EXPECT_THAT(counts, testing::Each(counts.front()));
}

TEST_F(SweepResultsTest, MarkdownHasTheTablesWithTheirCommand) {
    const SweepFolder folder(root / "out", sweep);
    folder.begin(false, &machine);
    folder.write(machine);
    measure(folder, {});
    folder.write(units[1], points[1], [] {
        SweepPicture failed;
        failed.failed = "it does not compile";
        return failed;
    }());
    sweep.framesGiven = true;
    const std::string json = resultsJson(sweep, folder.gather(points, units));
    const std::string expected = fmt::format(R"(## T

    kestrel sweep {}/s.json --frames 16 --out results

640x360, pictures after 16 frames, medians of 2 repetitions of 1 timed frames.
Machine aaaaaa, 2026-01-31: cpu, 2 threads; renderer; driver; clock: finish; Kestrel 0. Spin test: one thread 20.0 ms (20.0 to 20.0), two at once 21.0 ms (21.0 to 21.0).
In bold: on the Pareto front of its plot.

### blob

| variant | total, ms | generation, ms | tracing, ms | half quartile distance | FLIP | RMSE | memory, MiB |
|---|---:|---:|---:|---:|---:|---:|---:|
| **a, x 1** | 13.5 | 7.50 | 6.00 | 2.25 | 0.100 | 0.100 | 0.000106 |
| **a, x 2** | 22.5 | 12.5 | 10.0 | 2.25 | 0.0500 | 0.0500 | 0.000106 |
| **b, \<"c"\>** | 31.5 | 17.5 | 14.0 | 2.25 | 0.0333 | 0.0333 | 0.000106 |

### tower

)",
                                             root.string());
    const std::string text = resultsMarkdown(json, "x");
    EXPECT_EQ(text.substr(0, expected.size()), expected);
    EXPECT_THAT(text,
                HasSubstr("| a, x 2 | failed | failed | failed | failed | failed | failed | failed |\n"));
    EXPECT_THROW(static_cast<void>(resultsMarkdown("{", "x")), InputError);
    EXPECT_THROW(static_cast<void>(resultsMarkdown("{}", "x")), InputError);
}

TEST_F(SweepResultsTest, ThePageHasNoOutsideLinkAndNoTextThatBecomesMarkup) {
    const SweepFolder folder(root / "out", sweep);
    folder.begin(false, &machine);
    measure(folder, {});
    const std::string page = resultsPage(sweep, folder.gather(points, units));
    std::string rest = page;
    const std::string svg = "http://www.w3.org/2000/svg"; // a name, not an address
    for (size_t at = rest.find(svg); at != std::string::npos; at = rest.find(svg)) rest.erase(at, svg.size());
    EXPECT_EQ(rest.find("http"), std::string::npos);
    EXPECT_EQ(rest.find("src=\""), std::string::npos);
    EXPECT_EQ(page.find("<\\\"c"), std::string::npos);
    EXPECT_THAT(page, HasSubstr("b, \\u003c\\\"c\\\">"));
}

TEST_F(SweepResultsTest, AFolderIsKeptFromOtherMachines) {
    SweepFolder(root / "out", sweep).begin(false, &machine);
    EXPECT_THAT(refusal(false, machine), HasSubstr("--resume goes on"));
    EXPECT_EQ(refusal(true, machine), "");
    SweepMachine other = machine;
    other.id = "bbbbbb";
    EXPECT_THAT(refusal(true, other), HasSubstr("times compare within one machine only"));
}

TEST_F(SweepResultsTest, WhatASweepGainsJoinsAndWhatChangesIsTold) {
    SweepFolder(root / "out", sweep).begin(false, &machine);
    load(R"("plot": { "error": "mse" }, "comment": "C", )"); // nothing that is measured
    EXPECT_EQ(refusal(true, machine), "");
    writeFile(root / "s.json", std::string_view(R"({ "kestrel_sweep": 1,
        "scenes": ["builtin:hall", "builtin:blob"],
        "reference": { "graph": "g.json", "output": "truth.visibility" },
        "variants": [{ "name": "new", "graph": "g.json", "output": "ao.visibility" },
                     { "name": "a", "graph": "g.json", "output": "ao.visibility", "axes": { "p.x": [2, 3] } }] })"));
    sweep = loadSweep(root / "s.json");
    EXPECT_EQ(refusal(true, machine), "") << "a scene, a variant and a value more, others gone";
    load();
    EXPECT_EQ(refusal(true, machine), "") << "those that were gone are still known";

    const auto changed = [&](const std::string& more, const std::string& from = "",
                             const std::string& to = "") {
        load(more);
        std::string text = readText(root / "s.json");
        if (!from.empty()) text.replace(text.find(from), from.size(), to);
        writeFile(root / "s.json", std::string_view(text));
        sweep = loadSweep(root / "s.json");
        return refusal(true, machine);
    };
    EXPECT_THAT(changed(R"("frames": 3, )"), HasSubstr("'frames' was 16 and is 3"));
    EXPECT_THAT(changed(R"("seed": 3, )"), HasSubstr("'seed' was 0 and is 3"));
    EXPECT_THAT(changed(R"("rebuild": true, )"), HasSubstr("'rebuild' was false and is true"));
    EXPECT_THAT(changed("", "truth.visibility", "truth.other"),
                HasSubstr("'output' of the reference was 'truth.visibility' and is 'truth.other'"));
    EXPECT_THAT(changed("", R"("axes": {)", R"("set": ["p.y=1"], "axes": {)"),
                HasSubstr(R"('set' of the variant 'a, x 1' was ["p.x=1"] and is ["p.y=1","p.x=1"])"));
    EXPECT_THAT(changed("", R"("axes": {)", R"("frames": 2, "axes": {)"),
                HasSubstr("'frames' of the variant 'a, x 1' was null and is 2"));
    // "B/c" would lie where "b, <"c">" lies.
    EXPECT_THAT(changed("", R"("b, <\"c\">")", R"("B/c")"),
                HasSubstr(R"(the variant 'B/c' would lie in the files of 'b, <"c">', which was measured)"));
    load();
    writeFile(root / "g.json", std::string_view(R"({ "kestrel": 1, "passes": {}, "name": "changed" })"));
    EXPECT_THAT(refusal(true, machine), HasSubstr("the text of the graph 'g.json' has changed"));
    for (const char* damaged : {"0123456789abcdef\naaaaaa\n", "{}", "[]", "",
                                R"({"kestrel_sweep_manifest":1,"machine":"a","facts":{"x":1}})"}) {
        writeFile(root / "out" / "sweep.manifest", std::string_view(damaged));
        EXPECT_THAT(refusal(true, machine), HasSubstr("another version of Kestrel, or damaged")) << damaged;
    }
}

TEST_F(SweepResultsTest, ShardsJoinToTheWhole) {
    const SweepFolder whole(root / "whole", sweep);
    whole.begin(false, &machine);
    whole.write(machine);
    measure(whole, {});
    const SweepFolder first(root / "1", sweep), second(root / "2", sweep), joined(root / "joined", sweep);
    first.begin(false, &machine);
    second.begin(false, &machine);
    first.write(machine);
    second.write(machine);
    measure(first, parseShard("1/2"));
    measure(second, parseShard("2/2"));
    EXPECT_EQ(first.gather(points, units).missing.size(), 3U);
    joined.begin(false, nullptr);
    joined.merge(first);
    joined.merge(second);
    EXPECT_EQ(resultsJson(sweep, joined.gather(points, units)),
              resultsJson(sweep, whole.gather(points, units)));
    EXPECT_THROW(joined.merge(second), InputError) << "it is there already";
    EXPECT_THROW(joined.merge(SweepFolder(root / "none", sweep)), InputError);
    load(R"("frames": 3, )");
    EXPECT_THROW(joined.merge(SweepFolder(root / "1", sweep)), InputError) << "of another sweep";
}

TEST_F(SweepResultsTest, WhatIsNotMeasuredIsMissing) {
    const SweepFolder folder(root / "out", sweep);
    folder.begin(false, &machine);
    folder.write(units[0], points[0], picture(0.1)); // no repetition yet
    SweepPicture failed;
    failed.failed = "it does not compile";
    folder.write(units[0], points[1], failed);
    const SweepResults results = folder.gather(points, units);
    ASSERT_EQ(results.rows.size(), 1U);
    EXPECT_EQ(results.rows[0].picture.failed, "it does not compile");
    EXPECT_EQ(results.missing.size(), 5U);
    EXPECT_THAT(results.missing, testing::Contains("blob: a, x 1"));
}

std::vector<std::byte> rayBytes(const std::vector<std::uint32_t>& flags) {
    std::vector<shared::RayRecord> rays;
    for (const std::uint32_t flag : flags) {
        shared::RayRecord ray{};
        ray.flags = flag;
        rays.push_back(ray);
    }
    const auto bytes = std::as_bytes(std::span(rays));
    return {bytes.begin(), bytes.end()};
}

TEST(CompareHits, CountsRaysThatExist) {
    const float none = std::numeric_limits<float>::infinity();
    const auto figures =
        compareHits(rayBytes({1, 1, 1, 1, 0}), {2, none, 3, none, 1}, {4, 1, none, none, none});
    EXPECT_EQ(figures.rays, 4);
    EXPECT_EQ(figures.hitShare, 0.5);
    EXPECT_EQ(figures.agreement, 0.5);
    EXPECT_EQ(figures.distanceError, 0.5);
    EXPECT_FALSE(compareHits(rayBytes({1}), {0}, {0}).distanceError)
        << "hits of any-hit queries have no distance";
    EXPECT_EQ(compareHits(rayBytes({0}), {0}, {none}).agreement, 1) << "of no ray";
    EXPECT_THROW(static_cast<void>(compareHits(rayBytes({1, 1}), {0}, {0})), InputError);
}

// What reads a table may take "012345" or "925e13" for a number, never a name that begins with a letter.
TEST(SweepMachine, HasANameThatIsNoNumber) {
    const SweepMachine machine = thisMachine("renderer", "driver", "clock");
    EXPECT_THAT(machine.id, testing::MatchesRegex("m[0-9a-f]{6}"));
    EXPECT_THAT(machine.date, testing::MatchesRegex("20[0-9][0-9]-[01][0-9]-[0-3][0-9]"));
    EXPECT_EQ(machine.id, thisMachine("renderer", "driver", "clock").id);
    EXPECT_NE(machine.id, thisMachine("renderer", "driver", "other").id);
}

// The reference of a moving sweep is rendered at the time that the variants' last frame has.
TEST(TimeAfter, GoesByFramesAndStartsAgain) {
    EXPECT_DOUBLE_EQ(timeAfter(0, 10), 1.0 / 60);
    EXPECT_EQ(timeAfter(5, 0), 0) << "nothing moves";
    EXPECT_NEAR(timeAfter(1.995, 2), 1.995 + 1.0 / 60 - 2, 1e-12);
    double time = 0;
    for (int i = 0; i < 1000; ++i) ASSERT_LE(time = timeAfter(time, 0.01), 0.01);
}

TEST(ShellWord, QuotesWhatAShellWouldChange) {
    EXPECT_EQ(shellWord("ao.tracer=bvh.tracer"), "ao.tracer=bvh.tracer");
    EXPECT_EQ(shellWord("a b"), "'a b'");
    EXPECT_EQ(shellWord("it's"), "'it'\\''s'");
    EXPECT_EQ(shellWord(""), "''");
}

} // namespace
} // namespace kestrel
