#include "shader/condition.h"
#include <gtest/gtest.h>
#include <map>

namespace kestrel {
namespace {

// Names that are absent are undefined; "?" as text makes a macro unknown.
MacroLookup lookupOf(std::map<std::string, std::string> macros) {
    return [macros = std::move(macros)](std::string_view name) -> MacroState {
        const auto found = macros.find(std::string(name));
        if (found == macros.end()) return {Truth::No, {}};
        if (found->second == "?") return {Truth::Unknown, {}};
        return {Truth::Yes, found->second};
    };
}

Truth evaluate(std::string_view expression) {
    return evaluateCondition(expression, lookupOf({{"ONE", "1"},
                                                   {"TWO", "2u"},
                                                   {"HEX", "0x10"},
                                                   {"MINUS", "-3"},
                                                   {"ALIAS", "TWO"},
                                                   {"SELF", "SELF"},
                                                   {"SUM", "1 + 1"},
                                                   {"UNKNOWN", "?"}}));
}

TEST(Condition, EvaluatesCsIntegerExpressions) {
    for (const char* yes : {"1",
                            "ONE",
                            "!0",
                            "TWO == 2",
                            "HEX == 16",
                            "ALIAS == 2",
                            "defined ONE",
                            "defined(TWO)",
                            "!defined(ABSENT)",
                            "ABSENT == 0",
                            "1 + 2 * 3 == 7",
                            "(1 + 2) * 3 == 9",
                            "7 % 4 == 3",
                            "1 << 4 == HEX",
                            "MINUS < 0",
                            "-MINUS == 3",
                            "~0 == -1",
                            "ONE && TWO || 0",
                            "0 || ONE > 0 && TWO >= 2",
                            "6 & 3 ^ 1 | 8",
                            "10 / 3 == 3",
                            "017 == 15",
                            "8 - 4 - 2 == 2"})
        EXPECT_EQ(evaluate(yes), Truth::Yes) << yes;
    for (const char* no : {"0", "ABSENT", "TWO != 2", "defined ABSENT", "ONE && ABSENT", "3 < 2", "1 >> 1"})
        EXPECT_EQ(evaluate(no), Truth::No) << no;
}

TEST(Condition, StaysUnknownWhereTheOutcomeDependsOnTheUnknown) {
    for (const char* unknown :
         {"UNKNOWN", "defined(UNKNOWN)", "UNKNOWN == 1", "ONE && UNKNOWN", "!UNKNOWN", "SELF", "SUM * 2",
          "1 / 0", "", "1 +", "(1", "1 1", "ONE(2)", "1.5", "1 << 99"})
        EXPECT_EQ(evaluate(unknown), Truth::Unknown) << unknown;
    EXPECT_EQ(evaluate("ABSENT && UNKNOWN"), Truth::No);
    EXPECT_EQ(evaluate("ONE || UNKNOWN"), Truth::Yes);
    EXPECT_EQ(evaluate(std::string(1000, '(')), Truth::Unknown);
    std::string negated(1000, '!');
    negated += '1';
    EXPECT_EQ(evaluate(negated), Truth::Unknown);
}

// Feeds directives; returns whether the line after each is active.
class Conditionals : public testing::Test {
protected:
    Truth after(const std::string& directive) {
        const std::optional<Directive> read = directiveOf(directive);
        EXPECT_EQ(stack.take(*read, ++line, lookup), ConditionalStack::Result::Done) << directive;
        return stack.active();
    }
    ConditionalStack stack;
    MacroLookup lookup = lookupOf({{"ONE", "1"}, {"UNKNOWN", "?"}});
    int line = 0;
};

TEST_F(Conditionals, TakeOneBranch) {
    EXPECT_EQ(after("#if 0"), Truth::No);
    EXPECT_EQ(after("#elif ONE"), Truth::Yes);
    EXPECT_EQ(after("# ifdef ABSENT"), Truth::No);
    EXPECT_EQ(stack.line(), 3);
    EXPECT_EQ(after("#else"), Truth::Yes);
    EXPECT_EQ(after("#endif"), Truth::Yes);
    EXPECT_EQ(after("#elif ONE"), Truth::No);
    EXPECT_EQ(after("#else"), Truth::No);
    EXPECT_EQ(after("#endif"), Truth::Yes);
    EXPECT_FALSE(stack.open());
}

TEST_F(Conditionals, AreUndecidedAfterAnUndecidedBranch) {
    EXPECT_EQ(after("#ifdef UNKNOWN"), Truth::Unknown);
    EXPECT_EQ(after("#ifndef ONE"), Truth::No);
    EXPECT_EQ(after("#endif"), Truth::Unknown);
    EXPECT_EQ(after("#elif ONE"), Truth::Unknown);
    EXPECT_EQ(after("#else"), Truth::No);
    EXPECT_EQ(after("#endif"), Truth::Yes);
}

TEST_F(Conditionals, KnowWhatOnlyCppTakes) {
    after("#ifdef __cplusplus");
    EXPECT_TRUE(stack.onlyForCpp());
    after("#if 1");
    EXPECT_TRUE(stack.onlyForCpp());
    after("#endif");
    after("#else");
    EXPECT_FALSE(stack.onlyForCpp());
    after("#endif");
    after("#if 0");
    EXPECT_FALSE(stack.onlyForCpp());
}

TEST_F(Conditionals, RefuseWhatIsOutOfPlace) {
    EXPECT_EQ(stack.take({"endif", ""}, 1, lookup), ConditionalStack::Result::WithoutIf);
    EXPECT_EQ(stack.take({"else", ""}, 1, lookup), ConditionalStack::Result::WithoutIf);
    EXPECT_EQ(stack.take({"define", "X"}, 1, lookup), ConditionalStack::Result::NotConditional);
    after("#if 1");
    after("#else");
    EXPECT_EQ(stack.take({"elif", "1"}, 4, lookup), ConditionalStack::Result::AfterElse);
}

TEST(ShaderLines, JoinContinuedLinesAndBlankComments) {
    const std::string text = "a /* b\n c */ d // e\n#define X \\\n 1\n#include \"x//y\"\n// z \\\nz\nlast";
    const std::vector<ShaderLine> lines = shaderLines(text);
    ASSERT_EQ(lines.size(), 6u);
    EXPECT_EQ(lines[0].code, "a ");
    EXPECT_EQ(lines[1].code, "  d ");
    EXPECT_EQ(lines[2].code, "#define X  1");
    EXPECT_EQ(lines[2].raw, "#define X \\\n 1");
    EXPECT_EQ(lines[2].count, 2);
    EXPECT_EQ(lines[3].number, 5);
    EXPECT_EQ(lines[3].code, "#include \"x//y\"");
    EXPECT_EQ(lines[4].code, "");
    EXPECT_EQ(lines[5].number, 8);
    EXPECT_EQ(lines[5].code, "last");
    EXPECT_TRUE(shaderLines("").empty());
    EXPECT_EQ(shaderLines("x\\").size(), 1u);
    EXPECT_EQ(shaderLines("x\\\n").size(), 1u);
}

} // namespace
} // namespace kestrel
