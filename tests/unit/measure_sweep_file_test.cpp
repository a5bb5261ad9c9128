#include "measure/sweep_file.h"
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string head = R"({ "kestrel_sweep": 1, "scenes": ["builtin:blob", "builtin:tower"],
 "reference": { "graph": "r.json", "output": "truth.visibility" },
 "rays": { "graph": "q.json", "rays": "rays.rays", "hits": "embree.hits", "frames": 3 },
)";

Sweep sweepOf(const std::string& variants, const std::string& more = "") {
    return parseSweep(head + more + R"("variants": [)" + variants + "] }", "s.json");
}

// Every message of a sweep that must be refused.
std::vector<std::string> mistakesOf(const std::string& text) {
    try {
        static_cast<void>(expandSweep(parseSweep(text, "s.json")));
    } catch (const InputError& error) {
        std::vector<std::string> lines;
        for (const Problem& problem : error.problems()) lines.push_back(problem.text());
        return lines;
    }
    return {};
}

std::vector<std::string> namesOf(const Sweep& sweep) {
    std::vector<std::string> names;
    for (const SweepPoint& point : expandSweep(sweep)) names.push_back(point.name);
    return names;
}

std::vector<std::string> settingsOf(const SweepPoint& point) {
    std::vector<std::string> texts;
    for (const SweepSetting& setting : point.settings) texts.push_back(setting.text);
    return texts;
}

const std::string plain = R"({ "name": "a", "graph": "g.json", "output": "ao.visibility" })";

TEST(SweepFile, HasDefaultsAndTakesItsNameFromTheFile) {
    const Sweep sweep = sweepOf(plain);
    EXPECT_EQ(sweep.name, "s");
    EXPECT_EQ(sweep.title, "s");
    EXPECT_EQ(sweep.repeats, 5);
    EXPECT_EQ(sweep.plotError, "flip");
    EXPECT_EQ(sweep.scenes[1].name, "tower");
    EXPECT_EQ(sweep.reference->output.text(), "truth.visibility");
    EXPECT_FALSE(sweep.rebuild || sweep.moving || sweep.hdr);
}

TEST(SweepFile, ReadsWhatItSays) {
    const Sweep sweep =
        sweepOf(plain, R"("title": "T", "size": [64, 36], "frames": 7, "warm_up": 0, "repeats": 2,
        "timed_frames": 3, "seed": 9, "rebuild": true, "hdr": true, "moving": true,
        "times": { "own": ["generation", "-bom"] }, "plot": { "time": "own", "error": "mse" }, )");
    EXPECT_EQ(sweep.title, "T");
    EXPECT_EQ(sweep.size, (Extent{64, 36, 1}));
    EXPECT_EQ(sweep.frames, 7);
    EXPECT_EQ(sweep.warmUp, 0);
    EXPECT_EQ(sweep.repeats, 2);
    EXPECT_EQ(sweep.timedFrames, 3);
    EXPECT_EQ(sweep.seed, 9U);
    EXPECT_TRUE(sweep.rebuild && sweep.hdr && sweep.moving);
    EXPECT_EQ(sweep.times[0].terms[1].name, "bom");
    EXPECT_EQ(sweep.times[0].terms[1].factor, -1);
    EXPECT_EQ(sweep.plotTime, "own");
    EXPECT_EQ(sweep.plotError, "mse");
}

TEST(SweepFile, TellsEveryMistakeAtOnceWithItsPlace) {
    const std::vector<std::string> mistakes = mistakesOf(R"({ "kestrel_sweep": 1, "repeets": 3,
 "size": [0, 36],
 "scenes": ["builtin:blob", "builtin:blob", { "source": "../other.glb", "camra": "" }, ""],
 "variants": [
  { "name": "a", "graph": "g.json", "output": "ao" },
  { "name": "a", "graph": "g.json", "output": "ao.visibility", "hits": "q.hits",
    "axes": { "ao.rays": [1, 1], "roma.angular": [] }, "series": "a {ao.ray}", "along": "ao.rayz",
    "exclude": [{ "ao.rays": 3 }] } ],
 "plot": { "error": "flipp" } })");
    using testing::Contains;
    EXPECT_THAT(mistakes, Contains(HasSubstr("s.json:1:23: the sweep has no key 'repeets'")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("did you mean 'repeats'")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("s.json:2:10: 'size' must be")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("s.json:3:29: the scene 'blob' is there twice")));
    EXPECT_THAT(mistakes,
                Contains(HasSubstr("s.json:3:73: a scene has no key 'camra' (did you mean 'camera'?)")));
    EXPECT_THAT(mistakes,
                Contains(HasSubstr("the scene must be 'builtin:NAME' or name a .gltf or .glb file")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("s.json:5:47: 'output' must be \"pass.port\", not 'ao'")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("either 'output' (a picture) or 'hits'")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("the variant 'a' is there twice")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("the axis 'ao.rays' has the value '1' twice")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("the axis 'roma.angular' has no values")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("no axis 'ao.ray' (did you mean 'ao.rays'?)")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("no axis 'ao.rayz' (did you mean 'ao.rays'?)")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("the axis 'ao.rays' has no value '3' (it has 1, 1)")));
    EXPECT_THAT(mistakes,
                Contains(HasSubstr("'flipp' is none of flip, mse, rmse and ssim (did you mean 'flip'?)")));
    EXPECT_THAT(mistakes, Contains(HasSubstr("needs the sweep's 'reference'")));
}

// Each key's bounds and kind, as the table that the schema is made of says.
TEST(SweepFile, EveryNumberIsHeldAgainstItsRange) {
    const std::tuple<std::string, int, int> keys[] = {{"frames", 1, maxSweepFrames},
                                                      {"warm_up", 0, maxSweepFrames},
                                                      {"repeats", 1, maxSweepRepeats},
                                                      {"timed_frames", 1, maxSweepFrames},
                                                      {"seed", 0, maxSweepSeed}};
    for (const auto& [key, low, high] : keys) {
        for (const int good : {low, high})
            EXPECT_NO_THROW(static_cast<void>(sweepOf(plain, fmt::format(R"("{}": {}, )", key, good))))
                << key;
        const std::string wanted = fmt::format("'{}' must be a whole number from {} to {}", key, low, high);
        for (const std::string& bad :
             {std::to_string(low - 1), std::to_string(high + 1), std::string("1.5"), std::string("\"1\"")})
            EXPECT_THAT(
                mistakesOf(head + fmt::format(R"("{}": {}, "variants": [)", key, bad) + plain + "] }"),
                testing::Contains(HasSubstr(wanted)))
                << key << " " << bad;
    }
    EXPECT_THAT(mistakesOf(head + R"("hdr": 1, "variants": [)" + plain + "] }"),
                testing::Contains(HasSubstr("'hdr'")));
}

TEST(SweepFile, RefusesOtherVersionsAndHostileSizes) {
    EXPECT_THAT(mistakesOf(R"({ "kestrel_sweep": 2, "scenes": ["builtin:blob"], "variants": [] })"),
                testing::Contains(HasSubstr("must be 1, not 2")));
    std::string values = "0";
    for (int i = 1; i < 150; ++i) values += "," + std::to_string(i);
    const std::string axes = fmt::format(R"({{ "a.b": [{0}], "a.c": [{0}] }})", values);
    EXPECT_THAT(mistakesOf(head + R"("variants": [{ "name": "a", "graph": "g", "output": "a.b", "axes": )" +
                           axes + "}] }"),
                testing::Contains(HasSubstr("more than 10000 points")));
}

TEST(SweepAxes, Multiply) {
    const Sweep sweep = sweepOf(R"({ "name": "roma", "graph": "g.json", "output": "ao.visibility",
        "axes": { "bom.resolution": [32, 64], "roma.angular": [4, 8] } })");
    EXPECT_THAT(namesOf(sweep),
                ElementsAre("roma, resolution 32, angular 4", "roma, resolution 32, angular 8",
                            "roma, resolution 64, angular 4", "roma, resolution 64, angular 8"));
    const SweepPoint point = expandSweep(sweep)[2];
    EXPECT_THAT(settingsOf(point), ElementsAre("bom.resolution=64", "roma.angular=4"));
    EXPECT_EQ(point.along, "bom.resolution");
    EXPECT_EQ(point.variant, "roma");
}

TEST(SweepAxes, MoveEdgesAndSetSeveralThings) {
    const Sweep sweep =
        sweepOf(R"({ "name": "all", "graph": "g.json", "output": "ao.visibility", "set": ["ao.rays=2"],
        "axes": { "tracer": [ { "label": "ROMA", "set": ["ao.tracer=roma.tracer", "roma.angular=8"] },
                              { "label": "BVH", "set": ["ao.tracer=bvh.tracer"] } ],
                  "resolution": { "set": ["bom.resolution={}", "fine.resolution={}"], "values": [64] } },
        "series": "{tracer} at {resolution}" })");
    const std::vector<SweepPoint> points = expandSweep(sweep);
    ASSERT_EQ(points.size(), 2U);
    EXPECT_THAT(settingsOf(points[0]), ElementsAre("ao.rays=2", "ao.tracer=roma.tracer", "roma.angular=8",
                                                   "bom.resolution=64", "fine.resolution=64"));
    EXPECT_EQ(points[0].series, "ROMA at 64");
    EXPECT_EQ(points[1].name, "all, tracer BVH, resolution 64");
}

TEST(SweepAxes, LeaveOutWhatIsExcluded) {
    const Sweep sweep = sweepOf(R"({ "name": "a", "graph": "g.json", "output": "ao.visibility",
        "axes": { "p.x": [1, 2, 3], "p.y": ["u", "v"], "p.z": [true, false] },
        "exclude": [{ "p.x": 2 }, { "p.x": 3, "p.y": "v" }, { "p.y": "u", "p.z": false }] })");
    EXPECT_THAT(namesOf(sweep), ElementsAre("a, x 1, y u, z true", "a, x 1, y v, z true",
                                            "a, x 1, y v, z false", "a, x 3, y u, z true"));
}

TEST(SweepAxes, EverythingExcludedIsAMistake) {
    EXPECT_THAT(
        mistakesOf(head +
                   R"("variants": [{ "name": "a", "graph": "g", "output": "a.b", "axes": { "p.x": [1] },
                                     "exclude": [{ "p.x": 1 }] }] })"),
        ElementsAre(HasSubstr("nothing is left to measure")));
}

TEST(SweepPoints, OfRaysRunAsManyFramesAsTheReference) {
    const Sweep sweep =
        sweepOf(plain + R"(, { "name": "r", "graph": "q.json", "hits": "query.hits" })", R"("frames": 9,)");
    const std::vector<SweepPoint> points = expandSweep(sweep);
    EXPECT_EQ(points[0].frames, 9);
    EXPECT_EQ(points[1].frames, 3);
    EXPECT_TRUE(points[1].ray);
}

TEST(SweepPoints, HaveFileNamesThatDiffer) {
    const Sweep sweep = sweepOf(R"({ "name": "A/b", "graph": "g.json", "output": "a.b" },
        { "name": "a b", "graph": "g.json", "output": "a.b" }, { "name": "../..", "graph": "g.json", "output": "a.b" },
        { "name": "réf", "graph": "g.json", "output": "a.b" })");
    std::vector<std::string> slugs;
    for (const SweepPoint& point : expandSweep(sweep)) slugs.push_back(point.slug);
    EXPECT_THAT(slugs, ElementsAre("a-b", "a-b-2", "x", "r-f"));
}

// What goes into the path of a file never names another folder.
TEST(SweepSlug, NeverLeavesItsFolder) {
    std::set<std::string> taken;
    for (const char* name : {"..", ".", "", "/", "a/../b", "\xff\xfe", "CON"}) {
        const std::string slug = sweepSlug(name, taken);
        EXPECT_EQ(slug.find('/'), std::string::npos) << name;
        EXPECT_NE(slug.front(), '.') << name;
    }
    EXPECT_EQ(taken.size(), 7U);
}

TEST(SweepUnits, AreASceneWithAllPointsOfAPlot) {
    const Sweep sweep =
        sweepOf(plain + R"(, { "name": "r", "graph": "q.json", "hits": "query.hits", "plot": "rays" },
        { "name": "b", "graph": "g.json", "output": "ao.visibility" })");
    const std::vector<SweepUnit> units = sweepUnits(sweep, expandSweep(sweep));
    ASSERT_EQ(units.size(), 4U);
    EXPECT_THAT(units[0].points, ElementsAre(0, 2));
    EXPECT_THAT(units[1].points, ElementsAre(1));
    EXPECT_EQ(units[1].slug, "blob-rays");
    EXPECT_EQ(units[2].scene, 1);
}

TEST(Shard, EachUnitIsInExactlyOne) {
    for (int count = 1; count <= 7; ++count)
        for (size_t unit = 0; unit < 20; ++unit) {
            int in = 0;
            for (int i = 1; i <= count; ++i)
                in += parseShard(fmt::format("{}/{}", i, count)).has(unit) ? 1 : 0;
            EXPECT_EQ(in, 1);
        }
}

TEST(Shard, RefusesWhatIsNone) {
    for (const char* text : {"0/2", "3/2", "1", "/", "1/0", "-1/2", "a/b", "1/2x", "1/2/3", "99999999999/2"})
        EXPECT_THROW(static_cast<void>(parseShard(text)), InputError) << text;
}

TEST(ChoosePoints, TakesVariantSeriesOrPointAndKnowsNearNames) {
    const Sweep sweep = sweepOf(R"({ "name": "roma", "graph": "g.json", "output": "a.b",
        "axes": { "p.x": [1, 2] }, "series": "ROMA {p.x}" }, { "name": "bvh", "graph": "g.json", "output": "a.b" })");
    const std::vector<SweepPoint> points = expandSweep(sweep);
    EXPECT_THAT(choosePoints(points, ""), ElementsAre(true, true, true));
    EXPECT_THAT(choosePoints(points, "roma"), ElementsAre(true, true, false));
    EXPECT_THAT(choosePoints(points, "ROMA 2"), ElementsAre(false, true, false));
    EXPECT_THAT(choosePoints(points, "roma, x 1"), ElementsAre(true, false, false));
    try {
        static_cast<void>(choosePoints(points, "rona"));
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("did you mean 'roma'"));
    }
}

TEST(SweepFile, ScenesAreSetUpWithEveryMistake) {
    const Sweep sweep = parseSweep(R"({ "kestrel_sweep": 1, "size": [64.0, 36], "frames": 3.0, "scenes": [
 { "source": "builtin:blob", "camera": "top", "lights": [{ "kind": "sphere", "position": [0, 1, 0], "radius": 1 }] },
 { "source": "builtin:blob", "camera": { "name": "mine", "eye": [0, 2, 0], "target": [1, 2, 0] }, "time": 2 }],
 "reference": { "graph": "r.json", "output": "truth.visibility" }, "variants": [)" +
                                       plain + "] }",
                                   "s.json");
    EXPECT_EQ(sweep.size, (Extent{64, 36, 1}));
    EXPECT_EQ(sweep.frames, 3);
    EXPECT_EQ(sweep.scenes[0].name, "blob, top");
    EXPECT_EQ(sweep.scenes[0].setup.lights.size(), 1u);
    EXPECT_EQ(sweep.scenes[1].name, "blob, mine");
    EXPECT_EQ(cameraOf(sweep.scenes[1]), "mine");
    EXPECT_EQ(sweep.scenes[1].setup.time, 2);
    const std::vector<std::string> mistakes = mistakesOf(
        R"({ "kestrel_sweep": 1, "scenes": [{ "source": "builtin:blob", "camera": { "eye": 3 }, "tmie": 2,
 "lights": [{ "kind": "sphere" }] }], "variants": [)" +
        plain + "] }");
    EXPECT_THAT(mistakes,
                testing::Contains(HasSubstr("'eye' of the camera must be an array, not a whole number")));
    EXPECT_THAT(mistakes, testing::Contains(HasSubstr("a scene has no key 'tmie' (did you mean 'time'?)")));
    EXPECT_THAT(mistakes, testing::Contains(HasSubstr("s.json:2:13: a sphere light needs 'radius'")));
}

// Axes of `values` values each, "a0" and so on.
std::string axesOf(int axes, int values) {
    std::string text;
    for (int a = 0; a < axes; ++a) {
        text += fmt::format(R"({}"a{}": [)", a > 0 ? ", " : "", a);
        for (int v = 0; v < values; ++v) text += fmt::format("{}{}", v > 0 ? ", " : "", v);
        text += "]";
    }
    return text;
}

std::vector<std::string> mistakesOfVariant(const std::string& keys) {
    return mistakesOf(head + R"("variants": [{ "name": "v", "graph": "g.json", "output": "a.b", )" + keys +
                      "}] }");
}

TEST(SweepFile, WhatIsTooMuchIsToldWithItsLimit) {
    using testing::Contains;
    // All of 10^12 combinations but one are excluded: what is tried counts, not what is left.
    EXPECT_THAT(
        mistakesOfVariant("\"axes\": {" + axesOf(12, 10) + R"(}, "exclude": [{"a0": 0}, {"a0": 1}, {"a0": 2},
                    {"a0": 3}, {"a0": 4}, {"a0": 5}, {"a0": 6}, {"a0": 7}, {"a0": 8}, {"a1": 0}])"),
        Contains(HasSubstr("multiply to more than 100000 combinations, excluded ones too, in all")));
    EXPECT_THAT(mistakesOfVariant("\"axes\": {" + axesOf(65, 1) + "}"),
                Contains(HasSubstr("65 axes; at most 64 are read")));
    EXPECT_THAT(mistakesOfVariant("\"axes\": {" + axesOf(1, 10'001) + "}"),
                Contains(HasSubstr("10001 values of an axis; at most 10000 are read")));
    EXPECT_THAT(mistakesOfVariant("\"axes\": {\"a\": [\"" + std::string(201, 'x') + "\"]}"),
                Contains(HasSubstr("a value of 201 bytes; at most 200 are read")));
    EXPECT_THAT(mistakesOfVariant("\"axes\": {\"" + std::string(201, 'x') + "\": [1]}"),
                Contains(HasSubstr("201 bytes in the name of an axis; at most 200 are read")));
    EXPECT_THAT(mistakesOfVariant("\"set\": [\"" + std::string(1001, 'x') + "\"]"),
                Contains(HasSubstr("a setting of 1001 bytes; at most 1000 are read")));
    std::string settings;
    for (int i = 0; i < 1'000; ++i) settings += (i > 0 ? ", \"" : "\"") + std::string(1'000, 'x') + "\"";
    EXPECT_THAT(mistakesOfVariant("\"set\": [" + settings + "], \"axes\": {" + axesOf(2, 99) + "}"),
                Contains(HasSubstr("multiply to more than 268435456 bytes of settings")));
    EXPECT_THAT(mistakesOfVariant("\"set\": [" + settings + ", \"x\"]"),
                Contains(HasSubstr("1001 settings; at most 1000 are read")));
}

} // namespace
} // namespace kestrel
