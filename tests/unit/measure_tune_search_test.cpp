// The search of `kestrel tune` on functions whose least value is known.
#include "measure/tune/tune_search.h"
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

namespace kestrel {
namespace {

using testing::Each;
using testing::ElementsAre;
using Function = std::function<double(const TuneSetting&)>;

// Counts what is asked, and gives nothing above the bound where `early`.
struct Asker {
    Function error;
    std::function<bool(const TuneSetting&)> affordable = [](const TuneSetting&) { return true; };
    bool early = false;
    std::vector<TuneSetting> asked = {}, timed = {};

    TuneFound search(const std::vector<TuneAxis>& axes, const TuneSetting& start,
                     const TuneEffort& effort = {}) {
        asked.clear();
        timed.clear();
        return searchTuning(axes, start, effort,
                            {[this](const TuneSetting& setting, double bound) -> std::optional<double> {
                                 asked.push_back(setting);
                                 const double value = error(setting);
                                 return early && value >= bound ? std::nullopt : std::optional(value);
                             },
                             [this](const TuneSetting& setting) {
                                 timed.push_back(setting);
                                 return affordable(setting);
                             }});
    }
};

double square(double x) { return x * x; }

const std::vector<TuneAxis> plane{{-2, 2}, {0, 10}};

TEST(TuneSearch, FindsTheBottomOfABowl) {
    Asker asker{[](const TuneSetting& s) { return 0.1 + square(s[0] - 0.7) + square(s[1] - 4.2) / 25; }};
    const TuneFound found = asker.search(plane, {-2, 10}, {.gain = 0});
    // Three rounds of ten: 4 / 9, then two of its widths in nine steps, twice.
    EXPECT_NEAR(found.setting[0], 0.7, 4 * 2.0 / 9 / 9 * 2 / 9 / 2 + 1e-3);
    EXPECT_NEAR(found.setting[1], 4.2, 10 * 2.0 / 9 / 9 * 2 / 9 / 2 + 1e-3);
    EXPECT_DOUBLE_EQ(found.error, asker.error(found.setting));
    EXPECT_DOUBLE_EQ(found.startError, asker.error({-2, 10}));
    EXPECT_EQ(found.asked, static_cast<int>(asker.asked.size()));
    EXPECT_LE(found.asked, 1 + 8 + 3 * 20);
}

TEST(TuneSearch, FollowsAValleyThatNoAxisLiesAlong) {
    Asker asker{[](const TuneSetting& s) { return 1 + square(s[0] + s[1] - 3) + 0.3 * square(s[0] - s[1]); }};
    const TuneFound found = asker.search({{0, 4}, {0, 4}}, {4, 4}, {.rounds = 8, .gain = 0});
    EXPECT_NEAR(found.setting[0], 1.5, 0.15);
    EXPECT_NEAR(found.setting[1], 1.5, 0.15);
}

// Deep at 8.5, where a descent from the start at 1 would never come.
TEST(TuneSearch, IsNotHeldByTheNearestOfSeveralMinima) {
    Asker asker{
        [](const TuneSetting& s) { return 3 + std::cos(2 * s[0]) - 0.2 * s[0] + 0.02 * square(s[0] - 8); }};
    double least = 1e9;
    for (int i = 0; i <= 100'000; ++i) least = std::min(least, asker.error({i / 10'000.0}));
    for (const double start : {0.0, 1.5, 4.0, 9.9})
        EXPECT_LT(asker.search({{0, 10}}, {start}, {.gain = 0}).error, least + 0.01) << start;
}

TEST(TuneSearch, StepsOfALogarithmicRangeAreEqualRatios) {
    EXPECT_THAT(tuneValues({0.001, 1000, false, true}, 0.001, 1000, 7),
                ElementsAre(0.001, 0.01, 0.1, 1, 10, 100, 1000));
    Asker asker{[](const TuneSetting& s) { return 1 + square(std::log(s[0] / 0.02)); }};
    const TuneFound found = asker.search({{1e-3, 1e3, false, true}}, {1}, {.gain = 0});
    EXPECT_NEAR(found.setting[0] / 0.02, 1, 0.05);
}

TEST(TuneSearch, ValuesReadWellAndLieWithinTheRange) {
    EXPECT_THAT(tuneValues({0, 1}, 0, 1, 10),
                ElementsAre(0, 0.111, 0.222, 0.333, 0.444, 0.556, 0.667, 0.778, 0.889, 1));
    EXPECT_THAT(tuneValues({0.25, 2}, 0.25, 2, 3), ElementsAre(0.25, 1.13, 2));
    EXPECT_THAT(tuneValues({1, 4, true}, 1, 4, 10), ElementsAre(1, 2, 3, 4)) << "whole ones each once";
    EXPECT_THAT(tuneValues({1e6, 1.00001e6}, 1e6, 1.00001e6, 3), ElementsAre(1e6, 1000005, 1000010));
}

TEST(TuneSearch, WholeNumbersAndChoicesAreOnlyWhatTheyMayBe) {
    const std::vector<TuneAxis> axes{{1, 64, true}, {.choices = 3}};
    Asker asker{[](const TuneSetting& s) { return 1 + square(s[0] - 37) / 100 + (s[1] == 2 ? 0 : 1); }};
    const TuneFound found = asker.search(axes, {1, 0}, {.gain = 0});
    EXPECT_THAT(found.setting, ElementsAre(37, 2));
    for (const TuneSetting& setting : asker.asked) {
        EXPECT_EQ(setting[0], std::round(setting[0]));
        EXPECT_TRUE(setting[0] >= 1 && setting[0] <= 64 &&
                    (setting[1] == 0 || setting[1] == 1 || setting[1] == 2));
    }
}

TEST(TuneSearch, NothingIsAskedTwice) {
    Asker asker{[](const TuneSetting& s) { return 1 + square(s[0] - 3) + s[1]; }};
    static_cast<void>(asker.search({{1, 9, true}, {.choices = 4}}, {9, 3}));
    EXPECT_EQ(std::set<TuneSetting>(asker.asked.begin(), asker.asked.end()).size(), asker.asked.size());
}

TEST(TuneSearch, TheLimitOfTimeBindsWhatIsTaken) {
    // More steps are always better, and take longer: 20 is the most that is affordable.
    Asker asker{[](const TuneSetting& s) { return 1 / s[0] + square(s[1] - 0.5); },
                [](const TuneSetting& s) { return s[0] <= 20; }};
    const TuneFound found = asker.search({{1, 64, true}, {0, 1}}, {8, 0}, {.gain = 0});
    EXPECT_EQ(found.setting[0], 20);
    EXPECT_NEAR(found.setting[1], 0.5, 0.02);
    EXPECT_GT(found.tooSlow, 0);
    for (const TuneStep& step : found.path) EXPECT_LE(step.setting[0], 20);
    // Only of what would be taken is the time measured.
    EXPECT_LT(asker.timed.size(), asker.asked.size() / 2);
}

TEST(TuneSearch, TheStartStandsWhereNothingIsBetterOrAffordable) {
    Asker flat{[](const TuneSetting&) { return 0.25; }};
    const TuneFound same = flat.search(plane, {0.3, 77}); // outside of its range, as a default may be
    EXPECT_THAT(same.setting, ElementsAre(0.3, 77));
    EXPECT_TRUE(same.path.empty() && flat.timed.empty());
    Asker dear{[](const TuneSetting& s) { return square(s[0]); }, [](const TuneSetting&) { return false; }};
    const TuneFound kept = dear.search({{0, 1}}, {1});
    EXPECT_THAT(kept.setting, ElementsAre(1));
    EXPECT_GT(kept.tooSlow, 0);
    // Less than a thousandth better is noise.
    Asker hardly{[](const TuneSetting& s) { return 1 - 0.0005 * s[0]; }};
    EXPECT_THAT(hardly.search({{0, 1}}, {0}).setting, ElementsAre(0));
}

TEST(TuneSearch, AStartWithoutAnErrorEndsIt) {
    Asker asker{[](const TuneSetting& s) { return s[0]; }};
    const TuneFound found = searchTuning(
        {{0, 1}}, {1}, {},
        {[](const TuneSetting&, double) { return std::nullopt; }, [](const TuneSetting&) { return true; }});
    EXPECT_TRUE(std::isinf(found.startError));
    EXPECT_EQ(found.asked, 1);
}

TEST(TuneSearch, GoesTheSameWayEachTimeAndWhoeverStopsEarlyChangesNothing) {
    Asker asker{[](const TuneSetting& s) { return 2 + std::sin(3 * s[0]) * std::cos(s[1]) + 0.01 * s[1]; }};
    const TuneFound first = asker.search(plane, {1, 1}, {.seed = 5});
    const std::vector<TuneSetting> way = asker.asked;
    const TuneFound second = asker.search(plane, {1, 1}, {.seed = 5});
    EXPECT_EQ(asker.asked, way);
    EXPECT_EQ(first.setting, second.setting);
    asker.early = true;
    EXPECT_EQ(asker.search(plane, {1, 1}, {.seed = 5}).setting, first.setting);
    EXPECT_EQ(asker.asked, way);
    asker.early = false;
    static_cast<void>(asker.search(plane, {1, 1}, {.seed = 6}));
    EXPECT_NE(asker.asked, way) << "other probes";
}

TEST(TuneSearch, ProbesAreSpreadOverTheSpace) {
    std::vector<TuneSetting> seen;
    static_cast<void>(searchTuning({{0, 1}, {0, 1}}, {0, 0}, {.rounds = 0, .probes = 64, .seed = 3},
                                   {[&](const TuneSetting& setting, double) {
                                        seen.push_back(setting);
                                        return std::optional(1.0);
                                    },
                                    [](const TuneSetting&) { return true; }}));
    std::vector<int> cells(16, 0);
    for (size_t i = 1; i < seen.size(); ++i)
        ++cells[static_cast<size_t>(std::min(3.0, seen[i][0] * 4)) * 4 +
                static_cast<size_t>(std::min(3.0, seen[i][1] * 4))];
    EXPECT_THAT(cells, Each(testing::AllOf(testing::Ge(2), testing::Le(6)))) << "four of 64 in each of 16";
}

} // namespace
} // namespace kestrel
