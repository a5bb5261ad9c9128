#include "core/json.h"
#include "core/problems.h"
#include "support/message.h"
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

TEST(Json, KnowsWhereEachValueStands) {
    const Json json =
        Json::parse("{\n  \"a\": [1, -2.5e1, \"x\\\"y\"],\n  \"\u00e4\": true, \"b\": {}\n}", "f.json");
    EXPECT_EQ(json.where.text(), "f.json:1:1");
    const Json* a = json.find("a");
    ASSERT_NE(a, nullptr);
    EXPECT_EQ(a->where.text(), "f.json:2:8");
    EXPECT_EQ(a->items[1].where.text(), "f.json:2:12");
    EXPECT_DOUBLE_EQ(a->items[1].number, -25);
    EXPECT_EQ(a->items[2].where.text(), "f.json:2:20");
    EXPECT_EQ(a->items[2].text, "x\"y");
    EXPECT_EQ(json.members[2].where.text(), "f.json:3:14"); // a two-byte letter is one column
    EXPECT_EQ(json.find("b")->where.text(), "f.json:3:19");
}

std::string parseMessage(std::string_view text) {
    return test::messageOf([&] { Json::parse(text, "f.json"); });
}

TEST(Json, RefusesWhatIsNotJsonWithItsPlace) {
    EXPECT_EQ(parseMessage("{\n \"a\": tru\n}").substr(0, 21), "f.json:2:10: not JSON");
    EXPECT_EQ(parseMessage("{\"a\": 1,\n\"a\": 2}"),
              "f.json:2:1: the key 'a' stands twice in one object (first on line 1)");
    EXPECT_EQ(parseMessage(std::string(70, '[')), "f.json:1:65: nested deeper than 64 levels");
}

TEST(Json, FieldsCollectEveryMistake) {
    const Json json = Json::parse(R"({"nmae": 1, "size": "big"})", "f.json");
    std::vector<Problem> problems;
    JsonFields fields(json, "a pass", problems);
    EXPECT_EQ(fields.required("name", Json::Kind::String), nullptr);
    EXPECT_EQ(fields.optional("size", Json::Kind::Int), nullptr);
    fields.refuseOthers();
    ASSERT_EQ(problems.size(), 3u);
    EXPECT_EQ(problems[0].text(), "f.json:1:1: a pass needs 'name'");
    EXPECT_EQ(problems[1].text(), "f.json:1:21: 'size' of a pass must be a whole number, not a string");
    EXPECT_EQ(problems[2].text(), "f.json:1:2: a pass has no key 'nmae' (did you mean 'name'?)");
}

TEST(NearName, FindsSlipsAndLeavesStrangersAlone) {
    const std::vector<std::string> names = {"normal", "depth", "albedo"};
    EXPECT_EQ(nearName("nromal", names), "normal");
    EXPECT_EQ(nearName("dept", names), "depth");
    EXPECT_EQ(nearName("visibility", names), "");
}

TEST(Json, NumbersBeyondDoubleAreTold) {
    EXPECT_EQ(parseMessage("{\"a\": [1,\n 1e400]}"),
              "f.json:2:2: the number 1e400 is too large: at most 1.798e+308 can be read");
    EXPECT_EQ(parseMessage("-1e999"),
              "f.json:1:1: the number -1e999 is too large: at most 1.798e+308 can be read");
}

TEST(Json, WholeNumbersAreWhole) {
    const Json json = Json::parse("[128.0, 1e3, 1.5, 1e300, 7, -2.0]", "f.json");
    const std::vector<bool> whole{true, true, false, false, true, true};
    for (size_t i = 0; i < whole.size(); ++i) EXPECT_EQ(json.items[i].isWhole(), whole[i]) << i;
    EXPECT_EQ(json.items[0].integer, 128);
    EXPECT_EQ(json.items[1].integer, 1000);
    EXPECT_EQ(json.items[5].integer, -2);
    EXPECT_EQ(json.items[0].kind, Json::Kind::Float) << "and stay as they were written";
    std::vector<Problem> problems;
    const Json object = Json::parse("{\"a\": 128.0, \"b\": 1.5}", "f.json");
    JsonFields fields(object, "it", problems);
    ASSERT_NE(fields.required("a", Json::Kind::Int), nullptr);
    EXPECT_EQ(fields.required("b", Json::Kind::Int), nullptr);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_EQ(problems[0].text(), "f.json:1:19: 'b' of it must be a whole number, not a number");
}

std::string repeated(size_t count, const std::string& text, const std::string& joint = ",") {
    std::string all;
    for (size_t i = 0; i < count; ++i) all += (i > 0 ? joint : "") + text;
    return all;
}

// A file of the greatest length that is read must neither take gigabytes nor hours.
TEST(Json, WhatIsTooMuchIsToldWithItsLimit) {
    EXPECT_EQ(parseMessage("[" + repeated(1'000'000, "0") + "]"),
              "f.json:1:2000000: has more than 1000000 values of JSON");
    EXPECT_EQ(Json::parse("[" + repeated(999'999, "0") + "]", "f.json").items.size(), 999'999u);
    EXPECT_EQ(parseMessage(std::string(17 << 20, ' ')),
              "f.json: has 17825792 bytes of JSON; at most 16777216 are read");
    std::string keys = "{";
    for (int i = 0; i < 300'000; ++i) keys += fmt::format("{}\"{}\":0", i > 0 ? "," : "", i);
    EXPECT_EQ(parseMessage(keys + "}"), "no error");
    EXPECT_THAT(parseMessage(keys + ",\n\"7\":0}"),
                testing::HasSubstr("f.json:2:1: the key '7' stands twice in one object (first on line 1)"));
}

TEST(Json, MistakesWithoutEndAreToldToAnEnd) {
    std::string keys = "{";
    for (int i = 0; i < 2'000; ++i) keys += fmt::format("{}\"{}\":0", i > 0 ? "," : "", i);
    const Json json = Json::parse(keys + "}", "f.json");
    std::vector<Problem> problems;
    try {
        JsonFields(json, "a pass", problems).refuseOthers();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.problems().size(), maxProblems + 1);
        EXPECT_EQ(error.problems().back().message, "has more than 1000 mistakes; these are the first");
    }
}

TEST(Error, WhatATerminalWouldObeyIsNotPassedOn) {
    const InputError error(Location{"a\x1b[2J.json", 1, 2}, "there is no key 'x\ny\x07'");
    EXPECT_STREQ(error.what(), "a?[2J.json:1:2: there is no key 'x y?'");
    EXPECT_EQ(error.problems().front().message, "there is no key 'x y?'");
}

TEST(NearName, ComparesNoLongTexts) {
    const std::string text(100'000, 'x');
    EXPECT_EQ(nearName(text, {text + "y"}), "");
    EXPECT_EQ(nearName("blur", std::vector<std::string>(100'000, "blurr")), "");
    EXPECT_EQ(nearName("ab", {"abcdefgh", "ba"}), "ba");
}

} // namespace
} // namespace kestrel
