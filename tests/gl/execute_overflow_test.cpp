// Buffers that turn out too small: the plan is compiled anew and the frame run again.
#include "execute_fixture.h"
#include <gmock/gmock.h>

namespace kestrel::test {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

class OverflowTest : public ExecuteTest {
protected:
    void SetUp() override {
        ExecuteTest::SetUp();
        addArithmetic();
        // Needs `value` elements and begins with 4; tells how many it has.
        addType(
            "List", {"in? signal", "buffer out list"},
            [](const FunctionPass&, const World& world, const Inputs&) {
                Declaration declaration;
                const auto grown = world.grown.find("list.list");
                const std::uint64_t elements = grown != world.grown.end() ? grown->second : 4;
                declaration.outputs = {{.port = "list", .desc = Desc::buffer(elements * 4)}};
                declaration.steps = {stepOf("count", {}, {write("list", Access::Copy)})};
                declaration.depends = Causes::Frame;
                return declaration;
            },
            [this](FunctionPass& pass, const Step&, Commands& commands) {
                ++runs_["list"];
                const std::uint64_t has = commands.desc("list").bytes / 4;
                const auto needs = static_cast<std::uint64_t>(pass.value);
                if (has < needs) commands.overflow("list", greedy_ ? has + 1 : needs);
                commands.report("elements", static_cast<double>(has));
            });
        // Adds to what it holds, and so shows whether it ran twice in a frame.
        shader("sum.comp", R"(layout(local_size_x = 8, local_size_y = 8) in;
            layout(r32f) uniform image2D total;
            uniform float value;
            void main() {
                ivec2 p = ivec2(gl_GlobalInvocationID.xy);
                imageStore(total, p, imageLoad(total, p) + value);
            })");
        addType(
            "Sum", {"in signal", "out total"},
            [](const FunctionPass&, const World& world, const Inputs&) {
                Declaration declaration;
                Output total = imageOf(world, "total");
                total.keeps = true;
                declaration.outputs = {total};
                declaration.steps = {stepOf("sum", {"sum.comp"}, {read("signal"), write("total")})};
                declaration.always = true;
                return declaration;
            },
            [this](FunctionPass& pass, const Step&, Commands& commands) { count(pass, commands); });
    }

    bool greedy_ = false; // asks for one element more each time
};

TEST_F(OverflowTest, TheBufferGrowsAndTheFrameRunsAgain) {
    const auto renderer = rendererOf(graphOf({"list: List = 100"}, {}, {"list.list"}));
    EXPECT_EQ(renderer->frame().recompiled, 1);
    EXPECT_EQ(renderer->desc({"list", "list"}).bytes, 400U);
    EXPECT_EQ(renderer->last().values.at("list").at("elements"), 100);
    EXPECT_EQ(runs_["list"], 2);
    EXPECT_EQ(renderer->frame().recompiled, 0);
    EXPECT_EQ(runs_["list"], 3);
}

TEST_F(OverflowTest, WhatRanBeforeInTheFrameDoesNotRunTwice) {
    const Graph graph =
        graphOf({"fill: FrameFill = 1", "sum: Sum = 1", "list: List = 100"},
                {"fill.result > sum.signal", "sum.total > list.signal"}, {"sum.total", "list.list"});
    const auto renderer = rendererOf(graph);
    renderer->frame();
    EXPECT_EQ(runs_["sum"], 1);
    EXPECT_THAT(renderer->read({"sum", "total"}).values, Each(1.0f));
    renderer->frame();
    EXPECT_THAT(renderer->read({"sum", "total"}).values, Each(2.0f));
}

TEST_F(OverflowTest, WithoutEndIsAnErrorThatNamesTheNeed) {
    greedy_ = true;
    const auto renderer = rendererOf(graphOf({"list: List = 100"}, {}, {"list.list"}));
    EXPECT_THAT(messageOf<InputError>([&] { renderer->frame(); }),
                AllOf(HasSubstr("list.list overflows after growing 8 times"), HasSubstr("13 elements")));
}

TEST_F(OverflowTest, BeyondTheDeviceIsAnErrorThatNamesNeedAndLimit) {
    const auto renderer = rendererOf(graphOf({"list: List = 999999999"}, {}, {"list.list"}));
    const std::string limit = std::to_string(context().capabilities().maxStorageBlockBytes);
    EXPECT_THAT(messageOf<MachineError>([&] { renderer->frame(); }),
                AllOf(HasSubstr("list.list"), HasSubstr("4000000000"), HasSubstr(limit)));
}

} // namespace
} // namespace kestrel::test
