#include "core/files.h"
#include "shader/iterations.h"
#include "shader/problems.h"
#include "shader/validate.h"
#include "support/folders.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

namespace kestrel {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

std::string textOf(const std::vector<Problem>& problems) {
    std::string text;
    for (const Problem& problem : problems) text += problem.text() + "\n";
    return text;
}

// A tracer of two tracers in a consumer that also takes hits, as two levels of modules.
struct NestedTracers {
    ShaderLibrary library;
    ProgramRequest request;

    NestedTracers() {
        library.addVirtual("lib/tracer.glsl",
                           "#pragma once\n"
                           "struct Ray { vec3 origin, direction; float tMin, tMax; uint token; };\n"
                           "struct Hit { float t; uint source; uvec2 id; };\n");
        library.addVirtual(
            "near_far.glsl",
            "#include \"lib/tracer.glsl\"\n"
            "#include <port:near>\n"
            "#include <port:far>\n"
            "layout(std140) uniform M(Block) { float reach; } M(own);\n"
            "void M(aim)(inout Ray r) { M(far_aim)(r); }\n"
            "bool M(anyHit)(Ray r) {\n"
            "    Ray n = r, f = r; n.tMax = min(r.tMax, M(own).reach); f.tMin = max(r.tMin, M(own).reach);\n"
            "    return M(near_anyHit)(n) || M(far_anyHit)(f);\n"
            "}\n");
        library.addVirtual("sphere.glsl",
                           "#include \"lib/tracer.glsl\"\n"
                           "#define RADIUS_SQUARED (RADIUS * RADIUS)\n"
                           "const float M(radius2) = RADIUS_SQUARED;\n"
                           "void M(aim)(inout Ray r) {\n"
                           "#if SNAPS\n"
                           "    r.direction = sign(r.direction);\n"
                           "#endif\n"
                           "}\n"
                           "bool M(anyHit)(Ray r) { return dot(r.origin, r.origin) < M(radius2); }\n");
        library.addVirtual("all_hits.glsl", "#include \"lib/tracer.glsl\"\n"
                                            "bool M(visit)(inout Ray r, Hit h);\n"
                                            "void M(all)(Ray r) { M(visit)(r, Hit(1.0, 0u, uvec2(0u))); }\n");
        library.addVirtual("consumer.comp",
                           "layout(local_size_x = 8) in;\n"
                           "#include <port:tracer>\n"
                           "#include <port:hits>\n"
                           "layout(std430) buffer Sums { float sum[]; };\n"
                           "bool hits_visit(inout Ray r, Hit h) { sum[1] += h.t; return false; }\n"
                           "void main() {\n"
                           "    Ray r = Ray(vec3(0), vec3(1), 0.0, 1.0, 0u);\n"
                           "    tracer_aim(r);\n"
                           "    sum[0] += tracer_anyHit(r) ? 1.0 : 0.0;\n"
                           "    hits_all(r);\n"
                           "}\n");
        const ModuleInstance nearHalf{"sphere.glsl", {{"RADIUS", "1.0"}, {"SNAPS", "0"}}, {}};
        const ModuleInstance farHalf{"sphere.glsl", {{"RADIUS", "2.0"}, {"SNAPS", "1"}}, {}};
        request.files = {"consumer.comp"};
        request.modules["tracer"] = {"near_far.glsl", {}, {{"near", nearHalf}, {"far", farHalf}}};
        request.modules["hits"] = {"all_hits.glsl", {}, {}};
    }

    // Replaces one line of a file by a statement that does not compile.
    void plant(const std::string& path, const std::string& line) {
        std::string text = library.text(path);
        const size_t begin = text.find(line);
        ASSERT_NE(begin, std::string::npos);
        text.replace(begin, line.size(), "planted = 1;");
        library.addVirtual(path, text);
    }
    std::string firstProblem() { return validate(compose(request, library)).at(0).text(); }
};

TEST(Validate, TwoTracersInATracerBesideAnotherModuleCompile) {
    NestedTracers nested;
    EXPECT_EQ(textOf(validate(compose(nested.request, nested.library))), "");
}

TEST(Validate, AModuleForTwoPortsIsTwoInstances) {
    NestedTracers nested;
    nested.library.addVirtual("consumer.comp",
                              "layout(local_size_x = 8) in;\n"
                              "#include <port:a>\n#include <port:b>\n"
                              "layout(std430) buffer Sums { float sum[]; };\n"
                              "void main() { Ray r = Ray(vec3(0), vec3(1), 0.0, 1.0, 0u);\n"
                              "a_aim(r); b_aim(r); sum[0] = a_anyHit(r) || b_anyHit(r) ? 1 : 0; }\n");
    const ModuleInstance tracer = nested.request.modules["tracer"];
    nested.request.modules = {{"a", tracer}, {"b", tracer}};
    EXPECT_EQ(textOf(validate(compose(nested.request, nested.library))), "");
}

TEST(Validate, ErrorsInTheStagesFileKeepTheirLineAfterIncludes) {
    NestedTracers nested;
    nested.plant("consumer.comp", "    hits_all(r);");
    EXPECT_EQ(nested.firstProblem(), "consumer.comp:10: 'planted' : undeclared identifier in: planted = 1;");
}

TEST(Validate, ErrorsInALibraryFileKeepTheirLine) {
    NestedTracers nested;
    nested.plant("lib/tracer.glsl", "struct Hit { float t; uint source; uvec2 id; };");
    EXPECT_THAT(nested.firstProblem(), HasSubstr("lib/tracer.glsl:3: "));
    EXPECT_THAT(nested.firstProblem(), HasSubstr(" in: planted = 1;"));
}

TEST(Validate, ErrorsInAModuleKeepTheirLineAfterItsIncludes) {
    NestedTracers nested;
    nested.plant("near_far.glsl", "return M(near_anyHit)(n) || M(far_anyHit)(f);");
    EXPECT_EQ(nested.firstProblem(), "near_far.glsl:8: 'planted' : undeclared identifier in: planted = 1;");
}

TEST(Validate, ErrorsInANestedModuleKeepTheirLine) {
    NestedTracers nested;
    nested.plant("sphere.glsl", "    r.direction = sign(r.direction);");
    EXPECT_EQ(nested.firstProblem(), "sphere.glsl:6: 'planted' : undeclared identifier in: planted = 1;");
}

TEST(Validate, ErrorsInAHoistedExtensionKeepTheirLine) {
    ShaderLibrary library;
    library.addVirtual("x.comp",
                       "layout(local_size_x = 1) in;\nvoid main() {}\n#extension GL_ARB_nothing : require\n");
    EXPECT_EQ(
        validate(compose({{"x.comp"}, {{"A", "1"}}, {}}, library)).at(0).text(),
        "x.comp:3: '#extension' : extension not supported: GL_ARB_nothing in: #extension GL_ARB_nothing : "
        "require");
}

TEST(Validate, LinksTheStages) {
    ShaderLibrary library;
    library.addVirtual("x.vert",
                       "out vec3 colour;\nvoid main() { colour = vec3(1); gl_Position = vec4(0); }\n");
    library.addVirtual("x.frag",
                       "in vec3 colour;\nout vec4 target;\nvoid main() { target = vec4(colour, 1); }\n");
    library.addVirtual("y.frag",
                       "in vec2 colour;\nout vec4 target;\nvoid main() { target = vec4(colour, 1, 1); }\n");
    EXPECT_EQ(textOf(validate(compose({{"x.vert", "x.frag"}, {}, {}}, library))), "");
    const std::vector<Problem> problems = validate(compose({{"x.vert", "y.frag"}, {}, {}}, library));
    ASSERT_FALSE(problems.empty());
    EXPECT_EQ(problems[0].where.file, "x.vert+y.frag");
}

TEST(Validate, SharedHeadersCompileWithDefinesOfBothBranches) {
    ShaderLibrary library;
    library.addVirtual("shared/b.h",
                       "#pragma once\n#ifdef __cplusplus\n#include <cstdint>\nusing uint = std::uint32_t;\n"
                       "#endif\nconst uint cells = 128u;\n");
    library.addVirtual("x.comp",
                       "#include \"shared/b.h\"\n#include \"shared/b.h\"\n"
                       "layout(local_size_x = 1) in;\nbuffer B { uint n; };\nvoid main() { n = cells; }\n");
    EXPECT_EQ(textOf(validate(compose({{"x.comp"}, {}, {}}, library))), "");
}

TEST(Validate, LeavesUnknownExtensionsToTheDriver) {
    ShaderLibrary library;
    library.addVirtual("x.vert", "void main() { gl_Position = vec4(0); }\n");
    library.addVirtual("x.frag",
                       "#ifdef FETCH\n#extension GL_EXT_shader_framebuffer_fetch : require\n#endif\n"
                       "inout vec4 colour;\nvoid main() { colour += 1; }\n");
    const ComposedProgram fetches = compose({{"x.vert", "x.frag"}, {{"FETCH", "1"}}, {}}, library);
    EXPECT_FALSE(glslangKnows(fetches));
    EXPECT_THAT(validate(fetches), IsEmpty());
    const ComposedProgram plain = compose({{"x.vert", "x.frag"}, {}, {}}, library);
    EXPECT_TRUE(glslangKnows(plain));
    EXPECT_THAT(textOf(validate(plain)), HasSubstr("x.frag:4: "));
    for (const UnknownExtension& unknown : unknownExtensions()) {
        // The table lists only what glslang really lacks: asked without the table, it refuses.
        EXPECT_FALSE(unknown.reason.empty());
        library.addVirtual("y.comp", "layout(local_size_x = 1) in;\nvoid main() {}\n");
        ComposedProgram probe = compose({{"y.comp"}, {}, {}}, library);
        std::string& text = probe.stages[0].text;
        text.insert(text.find('\n') + 1, "#ifndef " + unknown.name + "\n#error lacks\n#endif\n");
        EXPECT_FALSE(validate(probe).empty()) << unknown.name;
    }
}

TEST(Validate, WorksFromSeveralThreads) {
    std::vector<std::string> results(4, "not run");
    std::vector<std::thread> threads;
    for (size_t i = 0; i < results.size(); ++i) {
        threads.emplace_back([&results, i] {
            NestedTracers nested;
            if (i % 2 == 1) nested.plant("consumer.comp", "    hits_all(r);");
            for (int repeat = 0; repeat < 5; ++repeat)
                results[i] = textOf(validate(compose(nested.request, nested.library)));
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(results[0], "");
    EXPECT_EQ(results[2], "");
    EXPECT_THAT(results[1], HasSubstr("consumer.comp:10: "));
    EXPECT_EQ(results[1], results[3]);
}

// The loop guard of the shader library.
class Iterations : public testing::TestWithParam<bool> {};

TEST_P(Iterations, CompilesWithAndWithoutCounting) {
    ShaderLibrary library({test::sourceFolder() / "shaders"});
    library.addVirtual("x.comp", "#include \"lib/iterations.glsl\"\n"
                                 "layout(local_size_x = 1) in;\n"
                                 "buffer B { uint bound; uint sum; };\n"
                                 "void main() {\n"
                                 "    for (uint i = 0u; i < bound; ++i) { ITERATION; ++sum; }\n"
                                 "    ITERATIONS_END;\n"
                                 "}\n");
    ProgramRequest request{{"x.comp"}, {}, {}};
    if (GetParam()) request.defines[iterationsDefine] = "1";
    const ComposedProgram program = compose(request, library);
    EXPECT_EQ(textOf(validate(program)), "");
    EXPECT_THAT(program.stages[0].text,
                HasSubstr("const uint iterationsLimit = " + std::to_string(maxIterations) + "u;"));
}
INSTANTIATE_TEST_SUITE_P(Debug, Iterations, testing::Bool());

ComposedStage stageOfTwoFiles() {
    ComposedStage stage;
    stage.text = "#version 460 core\n#define A 1\n#line 1 1\n#line 1 2\nfloat a;\nfloat b = c;\n#line 2 1\n"
                 "void main() {}\n";
    stage.sources = {"(head)", "x.comp", "lib/a.glsl"};
    stage.file = "x.comp";
    return stage;
}

TEST(MapShaderLog, ReadsEveryCompilersFormat) {
    const ComposedStage stage = stageOfTwoFiles();
    EXPECT_EQ(textOf(mapShaderLog("2:2(11): error: `c' undeclared\n2:1(1): warning: `a' unused\n", stage)),
              "lib/a.glsl:2:11: `c' undeclared in: float b = c;\n"
              "lib/a.glsl:1:1: warning: `a' unused in: float a;\n");
    EXPECT_EQ(textOf(mapShaderLog(
                  "ERROR: 2:2: 'c' : undeclared identifier \nERROR: 2:2: '' : compilation terminated \n"
                  "ERROR: 2 compilation errors.  No code generated.\n\n\n",
                  stage)),
              "lib/a.glsl:2: 'c' : undeclared identifier in: float b = c;\n");
    EXPECT_EQ(textOf(mapShaderLog("1(2) : error C1008: undefined variable \"c\"\n", stage)),
              "x.comp:2: error C1008: undefined variable \"c\" in: void main() {}\n");
}

TEST(MapShaderLog, ReadsTheSourceFromTheLinesOfDriverText) {
    const ComposedStage stage = stageOfTwoFiles();
    EXPECT_EQ(driverText(stage), "#version 460 core\n#define A 1\n#line 100001 1\n#line 200001 2\nfloat a;\n"
                                 "float b = c;\n#line 100002 1\nvoid main() {}\n");
    // As Mesa reports it: the source is always 0.
    EXPECT_EQ(textOf(mapShaderLog("0:200002(11): error: `c' undeclared\n0:100002(1): error: bad\n"
                                  "0:2(9): error: head\n",
                                  stage)),
              "lib/a.glsl:2:11: `c' undeclared in: float b = c;\n"
              "x.comp:2:1: bad in: void main() {}\n"
              "(head):2:9: head in: #define A 1\n");
    EXPECT_EQ(textOf(mapShaderLog("ERROR: 2:200002: 'c' : undeclared\n", stage)),
              "lib/a.glsl:2: 'c' : undeclared in: float b = c;\n");
}

TEST(MapShaderLog, KeepsWhatHasNoPlace) {
    const ComposedStage stage = stageOfTwoFiles();
    EXPECT_EQ(textOf(mapShaderLog("error: out of registers.\n9:1(1): error: elsewhere\n", stage)),
              "x.comp: out of registers\nx.comp: elsewhere\n");
    EXPECT_EQ(textOf(mapShaderLog("0:2(9): error: bad\n2:77: error: beyond\n", stage)),
              "(head):2:9: bad in: #define A 1\nlib/a.glsl:77: beyond\n");
    EXPECT_TRUE(mapShaderLog("", stage).empty());
    ComposedProgram program;
    program.name = "x.vert+x.frag";
    EXPECT_EQ(textOf(mapLinkLog("error: fragment shader input `c' has no output\n\n", program)),
              "x.vert+x.frag: fragment shader input `c' has no output\n");
}

} // namespace
} // namespace kestrel
