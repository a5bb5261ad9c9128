#include "core/error.h"
#include "shader/compose.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string textOf(const ProgramRequest& request, ShaderLibrary& library) {
    return compose(request, library).stages.at(0).text;
}

// One line a problem.
std::string problemsOf(const ProgramRequest& request, ShaderLibrary& library) {
    try {
        compose(request, library);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

// The text composed from one compute shader, without any request, or the problems.
std::string problemsOf(const std::string& text) {
    ShaderLibrary library;
    library.addVirtual("lib/a.glsl", "");
    library.addVirtual("x.comp", text);
    return problemsOf({{"x.comp"}, {{"ONE", "1"}, {"ZERO", "0"}}, {}}, library);
}

TEST(Compose, WritesVersionDefinesAndLineNumbers) {
    ShaderLibrary library;
    library.addVirtual("lib/a.glsl", "float a;\n");
    library.addVirtual("x.comp", "#include \"lib/a.glsl\" // once\n"
                                 "#include \"lib/a.glsl\"\n"
                                 "void main() {}");
    const ComposedProgram program = compose({{"x.comp"}, {{"B", ""}, {"A", "2 + 3"}}, {}}, library);
    ASSERT_EQ(program.stages.size(), 1u);
    EXPECT_EQ(program.stages[0].text, "#version 460 core\n"
                                      "#define A 2 + 3\n"
                                      "#define B 1\n"
                                      "#line 1 1\n"
                                      "#line 1 2\n"
                                      "float a;\n"
                                      "#line 2 1\n"
                                      "\n"
                                      "void main() {}\n");
    EXPECT_EQ(program.stages[0].stage, ShaderStage::Compute);
    EXPECT_EQ(program.stages[0].file, "x.comp");
    EXPECT_THAT(program.stages[0].sources, ElementsAre("(head)", "x.comp", "lib/a.glsl"));
    EXPECT_THAT(program.dependencies, ElementsAre("lib/a.glsl", "x.comp"));
    EXPECT_EQ(program.name, "x.comp");
}

TEST(Compose, HoistsExtensionsWithTheirPlace) {
    ShaderLibrary library;
    library.addVirtual("lib/a.glsl", "float a;\n#extension GL_ARB_shader_ballot : require\n");
    library.addVirtual("x.comp", "#include \"lib/a.glsl\"\n"
                                 "#ifdef USED\n#extension GL_ARB_gpu_shader_int64 : enable // why\n#endif\n"
                                 "#ifdef UNUSED\n#extension GL_ARB_shader_clock : require\n#endif\n"
                                 "#extension GL_ARB_shader_ballot : require\n");
    EXPECT_EQ(textOf({{"x.comp"}, {{"USED", "1"}}, {}}, library),
              "#version 460 core\n"
              "#line 2 2\n"
              "#extension GL_ARB_shader_ballot : require\n"
              "#line 3 1\n"
              "#extension GL_ARB_gpu_shader_int64 : enable\n"
              "#line 2 0\n"
              "#define USED 1\n"
              "#line 1 1\n"
              "#line 1 2\n"
              "float a;\n"
              "\n"
              "#line 2 1\n"
              "#ifdef USED\n\n#endif\n"
              "#ifdef UNUSED\n\n#endif\n"
              "\n");
}

TEST(Compose, GivesEachModuleItsPrefixAndItsDefines) {
    ShaderLibrary library;
    library.addVirtual("lib/t.glsl", "struct T { int x; };\n");
    library.addVirtual("outer.glsl",
                       "#include <port:near>\n#include \"lib/t.glsl\"\nint M(f)() { return R; }\n");
    library.addVirtual("inner.glsl", "int M(f)() { return STEPS; }\n");
    library.addVirtual("x.comp", "#include <port:tracer>\nvoid main() {}\n");
    const ModuleInstance inner{"inner.glsl", {{"STEPS", "7"}}, {}};
    const ModuleInstance outer{"outer.glsl", {{"R", "2"}, {"S", ""}}, {{"near", inner}}};
    const ComposedProgram program = compose({{"x.comp"}, {{"R", "1"}}, {{"tracer", outer}}}, library);
    EXPECT_EQ(program.stages[0].text, "#version 460 core\n"
                                      "#define R 1\n"
                                      "#line 1 1\n"
                                      // in: the module's R hides the program's
                                      "#undef R\n#define R 2\n#define S 1\n#define M(x) tracer_##x\n"
                                      "#line 1 2\n"
                                      // deeper: neither the outer module's defines hold nor the program's
                                      "#undef M\n#undef R\n#undef S\n#define STEPS 7\n"
                                      "#define M(x) tracer_near_##x\n"
                                      "#line 1 3\n"
                                      "int M(f)() { return STEPS; }\n"
                                      // back again
                                      "#undef M\n#undef STEPS\n#define R 2\n#define S 1\n"
                                      "#define M(x) tracer_##x\n"
                                      "#line 2 2\n"
                                      // a library file sees the program's defines and no M
                                      "#undef M\n#undef R\n#undef S\n#define R 1\n"
                                      "#line 1 4\n"
                                      "struct T { int x; };\n"
                                      "#undef R\n#define R 2\n#define S 1\n#define M(x) tracer_##x\n"
                                      "#line 3 2\n"
                                      "int M(f)() { return R; }\n"
                                      "#undef M\n#undef R\n#undef S\n#define R 1\n"
                                      "#line 2 1\n"
                                      "void main() {}\n");
    EXPECT_THAT(program.dependencies, ElementsAre("inner.glsl", "lib/t.glsl", "outer.glsl", "x.comp"));
}

TEST(Compose, AConsumersSwitchIsNothingToItsModules) {
    ShaderLibrary library;
    library.addVirtual("lib/bits.glsl", "int bits;\n");
    library.addVirtual("m.glsl",
                       "#ifdef BITS\n#include \"lib/bits.glsl\"\n#endif\nint M(f)() { return 1; }\n");
    library.addVirtual("x.comp", "#include <port:a>\nvoid main() {}\n");
    EXPECT_THAT(textOf({{"x.comp"}, {{"BITS", "1"}}, {{"a", {"m.glsl", {}, {}}}}}, library),
                Not(HasSubstr("int bits")));
    // Its own switch is.
    EXPECT_THAT(textOf({{"x.comp"}, {}, {{"a", {"m.glsl", {{"BITS", "1"}}, {}}}}}, library),
                HasSubstr("int bits"));
}

TEST(Compose, EndsAModulesOwnMacrosWithIt) {
    ShaderLibrary library;
    library.addVirtual("m.glsl", "#ifndef STEPS\n#define STEPS 32\n#endif\nint M(f)() { return STEPS; }\n");
    library.addVirtual("x.comp", "#include <port:a>\n#include <port:b>\n#include <port:a>\n");
    const std::string text = textOf(
        {{"x.comp"}, {}, {{"a", {"m.glsl", {}, {}}}, {"b", {"m.glsl", {{"STEPS", "8"}}, {}}}}}, library);
    EXPECT_EQ(text, "#version 460 core\n"
                    "#line 1 1\n"
                    "#define M(x) a_##x\n"
                    "#line 1 2\n"
                    "#ifndef STEPS\n#define STEPS 32\n#endif\nint M(f)() { return STEPS; }\n"
                    "#undef STEPS\n"
                    "#undef M\n"
                    "#line 2 1\n"
                    "#define STEPS 8\n#define M(x) b_##x\n"
                    "#line 1 2\n"
                    "#ifndef STEPS\n#define STEPS 32\n#endif\nint M(f)() { return STEPS; }\n"
                    "#undef M\n#undef STEPS\n"
                    "#line 3 1\n"
                    "\n"); // the instance a is there already
}

TEST(Compose, AModulesPartIsAsIfItStoodThere) {
    ShaderLibrary library;
    library.addVirtual("x.comp", "#include <port:a>\n#include <port:b>\nvoid main() {}\n");
    library.addVirtual(
        "m.glsl",
        "#define OWN 1\n#include <part:p.glsl>\n#include <part:p.glsl>\nint M(f)() { return BOTH; }\n");
    library.addVirtual("p.glsl", "#ifdef OWN\n#define BOTH (OWN + STEPS)\nint M(p);\n#endif\n");
    const ComposedProgram program = compose(
        {{"x.comp"}, {}, {{"a", {"m.glsl", {{"STEPS", "8"}}, {}}}, {"b", {"m.glsl", {{"STEPS", "9"}}, {}}}}},
        library);
    const std::string& text = program.stages.at(0).text;
    const std::string once = "#define OWN 1\n"
                             "#line 1 3\n"
                             "#ifdef OWN\n#define BOTH (OWN + STEPS)\nint M(p);\n#endif\n"
                             "#line 3 2\n"
                             "\n"
                             "int M(f)() { return BOTH; }\n"
                             "#undef BOTH\n#undef OWN\n";
    const size_t first = text.find(once);
    ASSERT_NE(first, std::string::npos) << text;
    EXPECT_NE(text.find(once, first + once.size()), std::string::npos) << text;
    EXPECT_THAT(program.dependencies, ElementsAre("m.glsl", "p.glsl", "x.comp"));
}

TEST(Compose, OnlyModulesHaveParts) {
    EXPECT_THAT(problemsOf("#include <part:lib/a.glsl>\n"),
                HasSubstr("x.comp:1: only a module has parts ('lib/a.glsl')"));
    ShaderLibrary library;
    library.addVirtual("x.comp", "#include <port:a>\n");
    library.addVirtual("m.glsl",
                       "#include <part:q.glsl>\n#ifdef GL_unknown\n#include <part:p.glsl>\n#endif\n");
    library.addVirtual("p.glsl", "");
    const std::string problems = problemsOf({{"x.comp"}, {}, {{"a", {"m.glsl", {}, {}}}}}, library);
    EXPECT_THAT(problems, HasSubstr("m.glsl:1: "));
    EXPECT_THAT(problems, HasSubstr("m.glsl:3: the part 'p.glsl' is included where"));
}

TEST(Compose, BlanksWhatIsForCpp) {
    ShaderLibrary library;
    library.addVirtual("shared/b.h", "#pragma once\n"
                                     "#ifdef __cplusplus\n"
                                     "#include <cstdint>\n"
                                     "#if 1\n"
                                     "constexpr int n = 1'000; // it's C++\n"
                                     "#endif\n"
                                     "#else\n"
                                     "const int n = 1000;\n"
                                     "#endif\n"
                                     "#ifndef __cplusplus\n"
                                     "#include \"lib/a.glsl\"\n"
                                     "#endif\n");
    library.addVirtual("lib/a.glsl", "float a;\n");
    library.addVirtual("x.comp", "#include \"shared/b.h\"\n");
    EXPECT_EQ(textOf({{"x.comp"}, {}, {}}, library), "#version 460 core\n"
                                                     "#line 1 1\n"
                                                     "#line 1 2\n"
                                                     "\n"
                                                     "#ifdef __cplusplus\n"
                                                     "\n\n\n\n"
                                                     "#else\n"
                                                     "const int n = 1000;\n"
                                                     "#endif\n"
                                                     "#ifndef __cplusplus\n"
                                                     "#line 1 3\n"
                                                     "float a;\n"
                                                     "#line 12 2\n"
                                                     "#endif\n"
                                                     "#line 2 1\n");
}

TEST(Compose, FollowsIncludesOnlyWhereTheDefinesTakeThem) {
    ShaderLibrary library;
    library.addVirtual("lib/a.glsl", "float a;\n");
    library.addVirtual("x.comp",
                       "/*\n#include \"lib/none.glsl\"\n*/\n"
                       "#if METHOD == 2\n#include \"lib/a.glsl\"\n#else\n#include \"lib/none.glsl\"\n"
                       "#include <port:none>\n#endif\n");
    EXPECT_EQ(textOf({{"x.comp"}, {{"METHOD", "2"}}, {}}, library),
              "#version 460 core\n#define METHOD 2\n#line 1 1\n"
              "/*\n#include \"lib/none.glsl\"\n*/\n"
              "#if METHOD == 2\n#line 1 2\nfloat a;\n#line 6 1\n#else\n\n\n#endif\n");
    EXPECT_THAT(problemsOf({{"x.comp"}, {{"METHOD", "1"}}, {}}, library),
                HasSubstr("x.comp:7: no shader file 'lib/none.glsl'"));
}

TEST(Compose, JudgesMacrosThatFilesDefine) {
    ShaderLibrary library;
    library.addVirtual("lib/a.glsl", "float a;\n");
    library.addVirtual("x.comp", "#ifndef RAYS\n#define RAYS 4\n#endif\n"
                                 "#if RAYS > 1\n#include \"lib/a.glsl\"\n#endif\n");
    EXPECT_THAT(textOf({{"x.comp"}, {}, {}}, library), HasSubstr("float a;"));
    EXPECT_THAT(textOf({{"x.comp"}, {{"RAYS", "1"}}, {}}, library), Not(HasSubstr("float a;")));
}

TEST(Compose, SortsTheStagesAndComposesEachByItself) {
    ShaderLibrary library;
    library.addVirtual("lib/a.glsl", "float a;\n");
    library.addVirtual("x.vert", "#include \"lib/a.glsl\"\n");
    library.addVirtual("x.geom", "");
    library.addVirtual("x.frag", "#include \"lib/a.glsl\"\n");
    const ComposedProgram program = compose({{"x.frag", "x.geom", "x.vert"}, {}, {}}, library);
    ASSERT_EQ(program.stages.size(), 3u);
    EXPECT_EQ(program.name, "x.vert+x.geom+x.frag");
    EXPECT_EQ(program.stages[1].stage, ShaderStage::Geometry);
    EXPECT_THAT(program.stages[0].text, HasSubstr("float a;"));
    EXPECT_THAT(program.stages[2].text, HasSubstr("float a;"));
}

TEST(Compose, KeysAreStableAndTellTextsApart) {
    ShaderLibrary library;
    library.addVirtual("x.vert", "void main() {}\n");
    library.addVirtual("x.frag", "void main() {}\n");
    library.addVirtual("y.frag", "void main() { }\n");
    const auto key = [&](std::vector<std::string> files, Defines defines = {}) {
        return compose({std::move(files), std::move(defines), {}}, library).key;
    };
    // A stored value: the key names files of a cache that outlives the process.
    EXPECT_EQ(key({"x.vert", "x.frag"}), 16677243765815665048u);
    EXPECT_EQ(key({"x.vert", "x.frag"}), key({"x.frag", "x.vert"}));
    EXPECT_NE(key({"x.vert", "x.frag"}), key({"x.vert", "y.frag"}));
    EXPECT_NE(key({"x.vert", "x.frag"}), key({"x.vert"}));
    EXPECT_NE(key({"x.vert"}, {{"A", "1"}}), key({"x.vert"}, {{"A", "2"}}));
    EXPECT_EQ(key({"x.vert"}, {{"A", ""}}), key({"x.vert"}, {{"A", "1"}}));
}

TEST(Compose, NamesMissingFilesAndPorts) {
    ShaderLibrary library;
    library.addVirtual("lib/tracer.glsl", "");
    library.addVirtual("x.comp",
                       "\n#include \"lib/trace.glsl\"\n#include <port:tracr>\n#include <port:lost>\n");
    EXPECT_EQ(
        problemsOf({{"x.comp"}, {}, {{"tracer", {"lib/tracer.glsl", {}, {}}}, {"lost", {"no.glsl", {}, {}}}}},
                   library),
        "x.comp:2: no shader file 'lib/trace.glsl' (did you mean 'lib/tracer.glsl'?); searched no folder\n"
        "x.comp:3: no module is connected to port 'tracr' (did you mean 'tracer'?)\n"
        "x.comp:4: the module at port 'lost': no shader file 'no.glsl'; searched no folder");
    EXPECT_EQ(problemsOf({{"none.comp"}, {}, {}}, library), "no shader file 'none.comp'; searched no folder");
    EXPECT_EQ(problemsOf("#include <cstdint>\n"),
              "x.comp:1: cannot read '#include <cstdint>': write #include \"folder/file.glsl\", "
              "#include <port:NAME> or, in a module, #include <part:folder/file.glsl>");
}

TEST(Compose, RefusesLibrariesWhereTheDefinesDoNotDecide) {
    EXPECT_EQ(problemsOf("#ifdef GL_ARB_shader_clock\n#include \"lib/a.glsl\"\n#endif\n"),
              "x.comp:2: 'lib/a.glsl' is included where the program's defines do not decide whether it is "
              "compiled: it could be missing elsewhere; include it outside the conditional");
    EXPECT_EQ(problemsOf("#include \"lib/a.glsl\"\n#ifdef GL_X\n#include \"lib/a.glsl\"\n#endif\n"),
              "no error");
    EXPECT_EQ(problemsOf("#ifdef GL_X\n#include <port:a>\n#endif\n"), "no error");
    EXPECT_EQ(problemsOf("#ifdef GL_X\n#extension GL_X : require\n#endif\n"),
              "x.comp:2: #extension stands where the program's defines do not decide whether it is compiled");
}

TEST(Compose, RefusesASecondIncludeOfAnUndecidedModule) {
    ShaderLibrary library;
    library.addVirtual("m.glsl", "float M(x);\n");
    library.addVirtual("x.comp", "#ifdef GL_X\n#include <port:a>\n#endif\n#include <port:a>\n");
    EXPECT_EQ(
        problemsOf({{"x.comp"}, {}, {{"a", {"m.glsl", {}, {}}}}}, library),
        "x.comp:4: the module 'a' is included a second time, and the defines do not decide whether the first "
        "is compiled");
}

TEST(Compose, RefusesReservedNames) {
    EXPECT_EQ(
        problemsOf("float a__b;\n// a__b\n#if 0\nfloat a__b;\n#endif\nint v = __VERSION__ + __LINE__;\n"),
        "x.comp:1: 'a__b' has a double underscore, which GLSL reserves");
    EXPECT_EQ(problemsOf("float M( _x);\n"),
              "x.comp:1: M(_...) would make a name with a double underscore, which GLSL reserves");
    EXPECT_EQ(problemsOf("#define M(x) x\n"),
              "x.comp:1: #define M: the name is reserved for the prefix of module names");
    EXPECT_EQ(
        problemsOf("#undef ONE\n"),
        "x.comp:1: #undef ONE: the name is given by the program's defines; guard a default with #ifndef");
    ShaderLibrary library;
    library.addVirtual("x.comp",
                       "#include <port:a__b>\n#include <port:a_>\n#include <port:gl_a>\n#include <port:>\n");
    EXPECT_EQ(
        problemsOf({{"x.comp"}, {}, {}}, library),
        "x.comp:1: the port name 'a__b' has a double underscore, which GLSL reserves\n"
        "x.comp:2: the port name 'a_' begins or ends with an underscore, which would make a double one\n"
        "x.comp:3: the port name 'gl_a' begins with gl_, which GLSL reserves\n"
        "x.comp:4: the port name '' is no GLSL name (letters, digits, underscores)");
    EXPECT_EQ(problemsOf({{"x.comp"}, {{"M", "1"}, {"a b", "1"}, {"c", "1\n2"}}, {}}, library),
              "x.comp: the define 'M' is reserved for composition\n"
              "x.comp: the define 'a b' is no GLSL name (letters, digits, underscores)\n"
              "x.comp: the define 'c' has a text of more than one line");
}

TEST(Compose, RefusesClashesOfModules) {
    ShaderLibrary library;
    library.addVirtual("lib/a.glsl", "#define PI 3\n#include <port:a>\n");
    library.addVirtual("inner.glsl", "");
    library.addVirtual("outer.glsl", "#include <port:b>\n");
    library.addVirtual(
        "x.comp", "#include <port:a>\n#include <port:a_b>\n#include \"lib/a.glsl\"\n#include <port:c>\n");
    const ModuleInstance inner{"inner.glsl", {}, {}};
    EXPECT_EQ(
        problemsOf({{"x.comp"},
                    {},
                    {{"a", {"outer.glsl", {}, {{"b", inner}}}},
                     {"a_b", inner},
                     {"c", {"inner.glsl", {{"PI", "4"}}, {}}}}},
                   library),
        "x.comp:2: two modules would get the same names 'a_b_...': rename a port\n"
        "lib/a.glsl:2: a library file cannot include the module of a port ('a')\n"
        "x.comp:4: the define 'PI' of the module at port 'c' is a macro that the text before it defines too");
}

TEST(Compose, RefusesWhatCompositionWritesItselfAndOpenConditionals) {
    EXPECT_EQ(problemsOf("#version 430\n#line 3\n#if ONE\n"),
              "x.comp:1: #version is written by composition: remove it from the file\n"
              "x.comp:2: #line is written by composition: remove it from the file\n"
              "x.comp:3: this conditional has no #endif in its file");
    EXPECT_EQ(problemsOf("#endif\n#if ONE\n#else\n#else\n#endif\n"),
              "x.comp:1: #endif without #if in this file\n"
              "x.comp:4: #else after #else");
}

TEST(Compose, RefusesStagesThatDoNotGoTogether) {
    ShaderLibrary library;
    for (const char* file : {"a.vert", "b.vert", "a.frag", "a.comp"}) library.addVirtual(file, "");
    EXPECT_EQ(problemsOf({{}, {}, {}}, library), "a program needs at least one stage file");
    EXPECT_EQ(problemsOf({{"a.vert", "b.vert"}, {}, {}}, library),
              "b.vert: is a second vertex stage beside a.vert");
    EXPECT_EQ(problemsOf({{"a.frag"}, {}, {}}, library), "a.frag: the program has no vertex stage");
    EXPECT_EQ(problemsOf({{"a.vert", "a.comp"}, {}, {}}, library),
              "a.comp: a compute stage stands alone in its program");
    EXPECT_EQ(problemsOf({{"a.comp", "a.glsl"}, {}, {}}, library),
              "a.glsl: is no stage: the file must end in .vert, .geom, .frag or .comp");
}

TEST(Compose, BoundsTheDepthOfModules) {
    ShaderLibrary library;
    library.addVirtual("m.glsl", "#include <port:a>\n");
    library.addVirtual("x.comp", "#include <port:a>\n");
    ModuleInstance chain{"m.glsl", {}, {}};
    for (int depth = 0; depth < maxModuleDepth; ++depth) chain = ModuleInstance{"m.glsl", {}, {{"a", chain}}};
    EXPECT_THAT(problemsOf({{"x.comp"}, {}, {{"a", chain}}}, library),
                HasSubstr("m.glsl:1: modules in modules deeper than 16"));
}

TEST(AllCombinations, ListsEachOnce) {
    EXPECT_THAT(allCombinations({}), ElementsAre(Defines{}));
    EXPECT_THAT(allCombinations({{"A", {"1", undefinedChoice}}, {"B", {"x", "y"}}}),
                ElementsAre(Defines{{"A", "1"}, {"B", "x"}}, Defines{{"A", "1"}, {"B", "y"}},
                            Defines{{"B", "x"}}, Defines{{"B", "y"}}));
    EXPECT_THROW(allCombinations({{"A", {}}}), InputError);
}

} // namespace
} // namespace kestrel
