// What a step finds bound, and what is refused.
#include "execute_fixture.h"
#include "shared/view.h"
#include <gmock/gmock.h>

namespace kestrel::test {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

class BindTest : public ExecuteTest {
protected:
    void SetUp() override {
        ExecuteTest::SetUp();
        addArithmetic();
    }

    // A pass with one compute step over the frame, in every frame.
    void addCompute(const std::string& type, const std::vector<std::string>& ports, const std::string& text,
                    std::vector<Use> uses, const std::function<void(Declaration&, const World&)>& more,
                    const FunctionPass::Execute& execute = {}) {
        const std::string file = type + ".comp";
        shader(file, "layout(local_size_x = 8, local_size_y = 8) in;\n" + text);
        addType(
            type, ports,
            [file, uses, more](const FunctionPass&, const World& world, const Inputs&) {
                Declaration declaration;
                declaration.depends = Causes::Frame;
                declaration.steps = {stepOf("work", {file}, uses)};
                if (more) more(declaration, world);
                return declaration;
            },
            execute ? execute : [](FunctionPass&, const Step&, Commands& commands) { overFrame(commands); });
    }

    std::string messageOfFrame(const Graph& graph, RenderOptions options = {}) {
        return messageOf<Error>([&] { rendererOf(graph, options)->frame(); });
    }
};

TEST_F(BindTest, TheFrameBlockTellsTheFrame) {
    addCompute("Tell", {"out result"},
               R"(#include "shared/view.h"
                  layout(std140) uniform Frame { FrameData frame_data; };
                  layout(rgba32f) uniform writeonly image2D result;
                  void main() {
                      imageStore(result, ivec2(gl_GlobalInvocationID.xy),
                                 vec4(frame_data.size, frame_data.index, frame_data.seed));
                  })",
               {write("result")}, [](Declaration& declaration, const World& world) {
                   declaration.outputs = {imageOf(world, "result", Format::RGBA32F)};
               });
    RenderOptions options;
    options.seed = 7;
    const auto renderer = rendererOf(graphOf({"tell: Tell"}, {}, {"tell.result"}), options);
    for (int i = 0; i < 3; ++i) renderer->frame();
    const Image image = renderer->read({"tell", "result"});
    EXPECT_EQ((std::vector<float>{image.values.begin(), image.values.begin() + 4}),
              (std::vector<float>{8, 4, 2, 7}));
}

TEST_F(BindTest, AViewBlockTellsTheViewOfItsImage) {
    addCompute("Small", {"out depth"},
               R"(layout(r32f) uniform writeonly image2D depth;
                  void main() { imageStore(depth, ivec2(gl_GlobalInvocationID.xy), vec4(1)); })",
               {write("depth")}, [](Declaration& declaration, const World& world) {
                   View view;
                   view.divisor = 2;
                   view.guard = 2;
                   declaration.outputs = {
                       {.port = "depth", .desc = Desc::texture2D(Format::R32F, world.extentOf(view), view)}};
               });
    addCompute("Tell", {"in depth", "out result"},
               R"(#include "shared/view.h"
                  layout(std140) uniform DepthView { ViewData depth_view; };
                  layout(r32f) uniform readonly image2D depth;
                  layout(rgba32f) uniform writeonly image2D result;
                  void main() {
                      float one = imageLoad(depth, ivec2(0)).x;
                      imageStore(result, ivec2(gl_GlobalInvocationID.xy),
                                 vec4(depth_view.size, depth_view.divisor, depth_view.position.z) * one);
                  })",
               {read("depth"), write("result")}, [](Declaration& declaration, const World& world) {
                   declaration.outputs = {imageOf(world, "result", Format::RGBA32F)};
               });
    const auto renderer =
        rendererOf(graphOf({"small: Small", "tell: Tell"}, {"small.depth > tell.depth"}, {"tell.result"}));
    renderer->frame();
    const Image image = renderer->read({"tell", "result"});
    EXPECT_EQ((std::vector<float>{image.values.begin(), image.values.begin() + 4}),
              (std::vector<float>{6, 4, 2, 3}));
}

TEST_F(BindTest, ASamplerFiltersAsTheUseSays) {
    for (const bool linear : {false, true})
        addCompute(linear ? "Linear" : "Nearest", {"in signal", "out result"},
                   R"(uniform sampler2D signal;
                      layout(r32f) uniform writeonly image2D result;
                      void main() {
                          vec2 border = vec2(4.0, 2.0) / vec2(8.0, 4.0) + vec2(0.001, 0.0);
                          imageStore(result, ivec2(gl_GlobalInvocationID.xy), textureLod(signal, border, 0.0));
                      })",
                   {{.port = "signal", .access = Access::Fetch, .linear = linear}, write("result")},
                   [](Declaration& declaration, const World& world) {
                       declaration.outputs = {imageOf(world, "result")};
                   });
    addCompute("Ramp", {"out result"},
               R"(layout(r32f) uniform writeonly image2D result;
                  void main() {
                      ivec2 p = ivec2(gl_GlobalInvocationID.xy);
                      imageStore(result, p, vec4(p.x < 4 ? 0.0 : 1.0));
                  })",
               {write("result")}, [](Declaration& declaration, const World& world) {
                   declaration.outputs = {imageOf(world, "result")};
               });
    const auto renderer =
        rendererOf(graphOf({"ramp: Ramp", "n: Nearest", "l: Linear"},
                           {"ramp.result > n.signal", "ramp.result > l.signal"}, {"n.result", "l.result"}));
    renderer->frame();
    EXPECT_EQ(renderer->read({"n", "result"}).at(0, 0), 1.0f);
    EXPECT_NEAR(renderer->read({"l", "result"}).at(0, 0), 0.5f, 0.02f);
}

// The fragment shader sees GL's rows, the image has row 0 at the top.
TEST_F(BindTest, ADrawFillsItsAttachmentsInOrder) {
    shader("two.frag", R"(out float out_first;
        out vec2 out_second;
        void main() { out_first = gl_FragCoord.y; out_second = gl_FragCoord.xy; })");
    addType(
        "Draw", {"out first", "out second"},
        [](const FunctionPass&, const World& world, const Inputs&) {
            Declaration declaration;
            declaration.outputs = {imageOf(world, "second", Format::RG32F), imageOf(world, "first")};
            declaration.steps = {
                stepOf("draw", {"lib/fullscreen.vert", "two.frag"},
                       {write("second", Access::Attachment), write("first", Access::Attachment)})};
            return declaration;
        },
        [](FunctionPass&, const Step&, Commands& commands) { commands.drawFullscreen(); });
    const auto renderer = rendererOf(graphOf({"draw: Draw"}, {}, {"draw.first", "draw.second"}));
    renderer->frame();
    const Image first = renderer->read({"draw", "first"}), second = renderer->read({"draw", "second"});
    EXPECT_EQ(first.at(0, 0), 3.5f);
    EXPECT_EQ(first.at(7, 3), 0.5f);
    EXPECT_EQ(second.at(7, 0, 0), 7.5f);
    EXPECT_EQ(second.at(7, 0, 1), 3.5f);
}

// The one barrier that a software driver shows when it is missing.
TEST_F(BindTest, ADispatchSeesWhatADrawWroteIntoABuffer) {
    shader("count.frag", R"(layout(std430) buffer Counts { uint counts[]; };
        void main() { atomicAdd(counts[uint(gl_FragCoord.x)], 1u); })");
    addType(
        "Counter", {"buffer out counts"},
        [](const FunctionPass&, const World&, const Inputs&) {
            Declaration declaration;
            declaration.outputs = {{.port = "counts", .desc = Desc::buffer(64 * 4), .clear = glm::vec4(0)}};
            declaration.steps = {
                stepOf("draw", {"lib/fullscreen.vert", "count.frag"}, {write("counts", Access::Storage)})};
            declaration.depends = Causes::Frame;
            return declaration;
        },
        [](FunctionPass&, const Step&, Commands& commands) {
            DrawState state = DrawState::overwrite();
            state.viewport = glm::uvec2(64, 100);
            commands.drawFullscreen(state);
        });
    addCompute("Show", {"buffer in counts", "out result"},
               R"(layout(std430) readonly buffer Counts { uint counts[]; };
                  layout(r32f) uniform writeonly image2D result;
                  void main() {
                      ivec2 p = ivec2(gl_GlobalInvocationID.xy);
                      imageStore(result, p, vec4(counts[p.x + 8 * p.y]));
                  })",
               {read("counts", Access::Storage), write("result")},
               [](Declaration& declaration, const World& world) {
                   declaration.outputs = {imageOf(world, "result")};
               });
    const auto renderer = rendererOf(
        graphOf({"counter: Counter", "show: Show"}, {"counter.counts > show.counts"}, {"show.result"}));
    for (int i = 0; i < 3; ++i) {
        renderer->frame();
        EXPECT_THAT(renderer->read({"show", "result"}).values, Each(100.0f)) << "frame " << i;
    }
}

TEST_F(BindTest, TheSceneIsDrawnFromTheFramesCamera) {
    shader("white.frag", "out float out_result;\nvoid main() { out_result = 1.0; }\n");
    shader("quad.vert", R"(#include "lib/vertex.glsl"
        #include "shared/view.h"
        layout(std140) uniform ResultView { ViewData result_view; };
        void main() { gl_Position = result_view.viewProjection * vec4(in_position, 1.0); })");
    addType(
        "Draw", {"out result"},
        [](const FunctionPass&, const World& world, const Inputs&) {
            Declaration declaration;
            Output output = imageOf(world, "result");
            output.clear = glm::vec4(0.25f);
            declaration.outputs = {output};
            declaration.depends = Causes::Camera | Causes::Transforms | Causes::Size;
            declaration.steps = {
                stepOf("draw", {"quad.vert", "white.frag"}, {write("result", Access::Attachment)})};
            return declaration;
        },
        [](FunctionPass&, const Step&, Commands& commands) {
            DrawState state = DrawState::overwrite();
            commands.drawScene(state, {TriangleClass::Opaque, TriangleClass::OpaqueDoubleSided});
        });
    RenderOptions options;
    options.size = {32, 32, 1};
    const auto renderer = rendererOf(graphOf({"draw: Draw"}, {}, {"draw.result"}), options);
    renderer->frame();
    const Image front = renderer->read({"draw", "result"});
    EXPECT_EQ(front.at(16, 16), 1.0f);
    EXPECT_EQ(front.at(0, 0), 0.25f);
    renderer->setCamera("right"); // the quad moves to the left and off the middle column's right side
    renderer->frame();
    const Image right = renderer->read({"draw", "result"});
    EXPECT_EQ(right.at(8, 16), 1.0f);
    EXPECT_EQ(right.at(20, 16), 0.25f) << "cleared anew";
}

TEST_F(BindTest, AnIndirectDispatchOfNoGroupsLeavesTheClearValue) {
    addType(
        "Arguments", {"buffer out arguments"},
        [](const FunctionPass&, const World&, const Inputs&) {
            Declaration declaration;
            declaration.outputs = {{.port = "arguments", .desc = Desc::buffer(16)}};
            declaration.steps = {stepOf("upload", {}, {write("arguments", Access::Copy)})};
            return declaration;
        },
        [](FunctionPass& pass, const Step&, Commands& commands) {
            commands.upload("arguments",
                            std::vector<std::uint32_t>{0, static_cast<std::uint32_t>(pass.value), 1, 1});
        });
    addCompute(
        "Indirect", {"buffer in arguments", "out result"},
        R"(layout(r32f) uniform writeonly image2D result;
                  void main() { imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(9.0)); })",
        {read("arguments", Access::Indirect), write("result")},
        [](Declaration& declaration, const World& world) {
            Output output = imageOf(world, "result");
            output.clear = glm::vec4(0.5f);
            declaration.outputs = {output};
        },
        [](FunctionPass&, const Step&, Commands& commands) { commands.dispatchIndirect("arguments", 4); });
    const auto renderer = rendererOf(graphOf({"arguments: Arguments = 1", "work: Indirect"},
                                             {"arguments.arguments > work.arguments"}, {"work.result"}));
    renderer->frame();
    EXPECT_THAT(renderer->read({"work", "result"}).values, Each(9.0f));
    renderer->set("arguments.value=0");
    renderer->frame();
    EXPECT_THAT(renderer->read({"work", "result"}).values, Each(0.5f));
}

TEST_F(BindTest, ATexelBufferIsReadAsAnImage) {
    addType(
        "Table", {"buffer out table"},
        [](const FunctionPass&, const World&, const Inputs&) {
            Declaration declaration;
            declaration.outputs = {{.port = "table", .desc = Desc::buffer(8 * 4, Format::R32F)}};
            declaration.steps = {stepOf("upload", {}, {write("table", Access::Copy)})};
            return declaration;
        },
        [](FunctionPass&, const Step&, Commands& commands) {
            commands.upload("table", std::vector<float>{0, 10, 20, 30, 40, 50, 60, 70});
        });
    for (const bool fetch : {false, true})
        addCompute(fetch ? "Fetch" : "Load", {"buffer in table", "out result"},
                   std::string(fetch ? "uniform samplerBuffer table;\n#define AT(i) texelFetch(table, i)\n"
                                     : "layout(r32f) uniform readonly imageBuffer table;\n"
                                       "#define AT(i) imageLoad(table, i)\n") +
                       R"(layout(r32f) uniform writeonly image2D result;
                          void main() {
                              ivec2 p = ivec2(gl_GlobalInvocationID.xy);
                              imageStore(result, p, AT(p.x));
                          })",
                   {read("table", fetch ? Access::Fetch : Access::Image), write("result")},
                   [](Declaration& declaration, const World& world) {
                       declaration.outputs = {imageOf(world, "result")};
                   });
    const auto renderer = rendererOf(graphOf({"table: Table", "load: Load", "fetch: Fetch"},
                                             {"table.table > load.table", "table.table > fetch.table"},
                                             {"load.result", "fetch.result"}));
    renderer->frame();
    EXPECT_EQ(renderer->read({"load", "result"}).at(5, 2), 50.0f);
    EXPECT_EQ(renderer->read({"load", "result"}), renderer->read({"fetch", "result"}));
}

// ---- what is refused

TEST_F(BindTest, ASlotThatNothingBindsIsNamed) {
    addCompute("Lost", {"out result"},
               R"(layout(r32f) uniform writeonly image2D result;
                  uniform sampler2D nowhere;
                  void main() { imageStore(result, ivec2(gl_GlobalInvocationID.xy), texelFetch(nowhere, ivec2(0), 0)); })",
               {write("result")}, [](Declaration& declaration, const World& world) {
                   declaration.outputs = {imageOf(world, "result")};
               });
    EXPECT_THAT(messageOfFrame(graphOf({"lost: Lost"}, {}, {"lost.result"})),
                AllOf(HasSubstr("pass 'lost', step 'work'"), HasSubstr("'nowhere'"), HasSubstr("Lost.comp")));
}

TEST_F(BindTest, AUniformThatTheShaderDoesNotKnowIsNamed) {
    addCompute(
        "Typo", {"out result"},
        R"(layout(r32f) uniform writeonly image2D result;
                  void main() { imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(1)); })",
        {write("result")},
        [](Declaration& declaration, const World& world) {
            declaration.outputs = {imageOf(world, "result")};
        },
        [](FunctionPass&, const Step&, Commands& commands) { commands.set("straength", 1.0f); });
    EXPECT_THAT(messageOfFrame(graphOf({"typo: Typo"}, {}, {"typo.result"})),
                AllOf(HasSubstr("pass 'typo', step 'work'"), HasSubstr("'straength'")));
}

TEST_F(BindTest, AnExceptionInAPassNamesPassAndStep) {
    addCompute(
        "Thrower", {"out result"},
        R"(layout(r32f) uniform writeonly image2D result;
                  void main() { imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(1)); })",
        {write("result")},
        [](Declaration& declaration, const World& world) {
            declaration.outputs = {imageOf(world, "result")};
        },
        [](FunctionPass&, const Step&, Commands&) { throw std::runtime_error("out of ideas"); });
    EXPECT_EQ(messageOfFrame(graphOf({"thrower: Thrower"}, {}, {"thrower.result"})),
              "pass 'thrower' failed in step 'work': out of ideas");
}

TEST_F(BindTest, APortThatIsNoUseOfTheStepIsNamed) {
    addCompute(
        "Reach", {"in signal", "out result"},
        R"(layout(r32f) uniform writeonly image2D result;
                  void main() { imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(1)); })",
        {write("result")},
        [](Declaration& declaration, const World& world) {
            declaration.outputs = {imageOf(world, "result")};
        },
        [](FunctionPass&, const Step&, Commands& commands) {
            static_cast<void>(commands.downloadImage("signal"));
        });
    EXPECT_THAT(messageOfFrame(
                    graphOf({"a: Fill = 1", "reach: Reach"}, {"a.result > reach.signal"}, {"reach.result"})),
                HasSubstr("pass 'reach', step 'work': port 'signal' is not among the step's uses"));
}

TEST_F(BindTest, LoopsThatAreTooLongTogetherAreNamedWhereTheyAreCounted) {
    addCompute(
        "Long", {"out result"},
        R"(#include "lib/iterations.glsl"
                  layout(r32f) uniform writeonly image2D result;
                  uniform int iterations_wanted;
                  void main() {
                      float sum = 0.0;
                      for (int i = 0; i < iterations_wanted / 2; ++i) { ITERATION; sum += 1.0; }
                      for (int i = 0; i < iterations_wanted / 2; ++i) { ITERATION; sum += 1.0; }
                      ITERATIONS_END;
                      imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(sum));
                  })",
        {write("result")},
        [](Declaration& declaration, const World& world) {
            declaration.outputs = {imageOf(world, "result")};
        },
        [](FunctionPass& pass, const Step&, Commands& commands) {
            commands.set("iterations_wanted", static_cast<int>(pass.value));
            commands.dispatch(1);
        });
    RenderOptions options;
    options.countIterations = true;
    const auto messageOf = [&](const std::string& iterations, const RenderOptions& given) {
        return messageOfFrame(graphOf({"long: Long = " + iterations}, {}, {"long.result"}), given);
    };
    EXPECT_EQ(messageOf("64000", options), "no error");
    EXPECT_THAT(messageOf("70000", options),
                AllOf(HasSubstr("pass 'long', step 'work'"), HasSubstr("65000 iterations")));
    EXPECT_EQ(messageOf("70000", {}), "no error"); // unasked, nothing is counted
    // Up to the limit every iteration is made, in whichever loop.
    const auto made = rendererOf(graphOf({"long: Long = 64000"}, {}, {"long.result"}));
    made->frame();
    EXPECT_EQ(made->read({"long", "result"}).at(0, 0, 0), 64000);
}

// ---- values that no output should hold

TEST_F(BindTest, TheFirstBadValueIsNamed) {
    addCompute("Bad", {"out result"},
               R"(layout(r32f) uniform writeonly image2D result;
                  void main() {
                      ivec2 p = ivec2(gl_GlobalInvocationID.xy);
                      float zero = float(gl_NumWorkGroups.z) - 1.0;
                      imageStore(result, p, vec4(p == ivec2(5, 1) ? zero / zero : 0.5));
                  })",
               {write("result")}, [](Declaration& declaration, const World& world) {
                   declaration.outputs = {imageOf(world, "result")};
               });
    RenderOptions options;
    options.checkFinite = true;
    const Graph graph = graphOf({"bad: Bad"}, {}, {"bad.result"});
    EXPECT_EQ(messageOfFrame(graph), "no error");
    // Row 1 of OpenGL is the third from the top.
    EXPECT_THAT(messageOfFrame(graph, options),
                AllOf(HasSubstr("frame 0: pass 'bad', port 'result', pixel (5, 2), channel 0"),
                      HasSubstr("is not a number; 1 of its values is bad")));
}

} // namespace
} // namespace kestrel::test
