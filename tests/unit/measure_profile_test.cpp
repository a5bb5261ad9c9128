#include "measure/profile.h"
#include "measure/run_stats.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

FrameRecord frameOf(double ms, std::vector<StepSample> samples) {
    FrameRecord frame;
    frame.ms = ms;
    frame.samples = std::move(samples);
    return frame;
}

TEST(Spread, OfAnOddCountIsTheMiddle) { EXPECT_EQ(spreadOf({3, 1, 2}), (Spread{2, 1, 3})); }

TEST(Spread, OfAnEvenCountIsTheMeanOfTheMiddleTwo) { EXPECT_EQ(spreadOf({4, 1, 3, 2}), (Spread{2.5, 1, 4})); }

TEST(Spread, OfNothingIsZero) { EXPECT_EQ(spreadOf({}), (Spread{0, 0, 0})); }

TEST(Profile, AddsTheStepsOfAPassAndCountsTheFramesInWhichItRan) {
    Profile profile;
    profile.add(frameOf(10, {{"bom", "OccupancyMap", "x", "generation", 0, 1},
                             {"bom", "OccupancyMap", "y", "generation", 0, 2},
                             {"ao", "RayAmbientOcclusion", "trace", "tracing", 0, 4}}));
    profile.add(frameOf(6, {{"ao", "RayAmbientOcclusion", "trace", "tracing", 1, 5}}));
    const std::vector<Profile::PassTime> passes = profile.passes();
    ASSERT_EQ(passes.size(), 2U);
    EXPECT_EQ(passes[0].name, "bom");
    EXPECT_EQ(passes[0].runs, 1);
    EXPECT_EQ(passes[0].ms, (Spread{3, 3, 3}));
    EXPECT_EQ(passes[1].runs, 2);
    EXPECT_EQ(passes[1].ms, (Spread{4.5, 4, 5}));
    EXPECT_EQ(profile.frame(), (Spread{8, 6, 10}));
}

TEST(Profile, AGroupThatDidNotRunInAFrameCountsAsZeroThere) {
    Profile profile;
    profile.add(frameOf(10, {{"bom", "OccupancyMap", "x", "generation", 0, 3}}));
    profile.add(frameOf(6, {}));
    profile.add(frameOf(6, {}));
    EXPECT_EQ(profile.groups().at("generation"), (Spread{0, 0, 3}));
}

TEST(RunStats, JsonHasTheKeysThatScriptsRelyOn) {
    RunStats stats;
    stats.graph = "g";
    stats.size = {640, 360, 1};
    stats.passes.push_back({"ao", "RayAmbientOcclusion", 2, {4.5, 4, 5}});
    stats.leftOut.push_back({"bvh", "nobody reads 'bvh.tracer'"});
    stats.memory = {1, 2, 3};
    stats.resources = {{"store.nodes", 1200}};
    const auto json = nlohmann::json::parse(statsJson(stats));
    for (const char* key : {"graph", "scene", "size", "frames", "seed", "renderer", "driver", "clock", "spin",
                            "passes", "frame_ms", "left_out", "memory"})
        EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_EQ(json["size"], nlohmann::json({640, 360}));
    EXPECT_EQ(json["passes"][0]["ms"]["median"], 4.5);
    EXPECT_EQ(json["passes"][0]["runs"], 2);
    EXPECT_EQ(json["left_out"][0]["why"], "nobody reads 'bvh.tracer'");
    EXPECT_EQ(json["memory"]["unshared"], 2);
    EXPECT_EQ(json["resources"], nlohmann::json::parse(R"([{"port": "store.nodes", "bytes": 1200}])"));
}

TEST(BytesText, GoesOverToTheNextUnitAt1024) {
    EXPECT_EQ(bytesText(1023), "1023 bytes");
    EXPECT_EQ(bytesText(1536), "1.5 KiB");
    EXPECT_EQ(bytesText(std::uint64_t{3} << 30), "3 GiB");
}

} // namespace
} // namespace kestrel
