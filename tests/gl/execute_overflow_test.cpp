// Buffers that turn out too small: the plan is compiled anew and the frame run again.
#include "execute_fixture.h"
#include <fmt/format.h>
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
            [](const FunctionPass& pass, const World&, const Inputs&) {
                Declaration declaration;
                const std::uint64_t elements = std::max<std::uint64_t>(pass.demand.grown("list"), 4);
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

// What a scene needed is not held against another one, another size or another property.
TEST_F(OverflowTest, GrowthEndsWithTheSceneTheSizeAndTheProperties) {
    const auto renderer = rendererOf(graphOf({"list: List = 100"}, {}, {"list.list"}));
    renderer->frame();
    EXPECT_EQ(renderer->desc({"list", "list"}).bytes, 400U);
    renderer->set("list.value=8");
    renderer->frame();
    EXPECT_EQ(renderer->desc({"list", "list"}).bytes, 32U);
    renderer->setSize({4, 4, 1});
    EXPECT_EQ(renderer->desc({"list", "list"}).bytes, 16U);
    renderer->frame();
    renderer->setScene(quadScene());
    EXPECT_EQ(renderer->desc({"list", "list"}).bytes, 16U);
}

// Two passes of one type grow each by itself.
TEST_F(OverflowTest, GrowthBelongsToThePort) {
    const auto renderer =
        rendererOf(graphOf({"small: List = 3", "large: List = 100"}, {}, {"small.list", "large.list"}));
    renderer->frame();
    EXPECT_EQ(renderer->desc({"small", "list"}).bytes, 16U);
    EXPECT_EQ(renderer->desc({"large", "list"}).bytes, 400U);
}

// Counted on the GPU and read by the executor. The image depends on the list, the sum keeps what it had: it
// must see whole lists only, in the frame that overflows too.
TEST_F(OverflowTest, CountersAreReadForThePass) {
    shader("append.comp", R"(layout(local_size_x = 8, local_size_y = 8) in;
        layout(std430) buffer Count { uint wanted; };
        layout(std430) buffer Items { float items[]; };
        uniform int each;
        void main() {
            for (int i = 0; i < each; ++i) {
                uint at = atomicAdd(wanted, 1u);
                if (at < uint(items.length())) items[at] = 1.0;
            }
        })");
    shader("total.comp", R"(layout(local_size_x = 8, local_size_y = 8) in;
        layout(std430) readonly buffer Items { float items[]; };
        layout(r32f) uniform writeonly image2D result;
        void main() {
            float sum = 0.0;
            for (int i = 0; i < items.length(); ++i) sum += items[i];
            imageStore(result, ivec2(gl_GlobalInvocationID.xy), vec4(sum));
        })");
    addType(
        "Append", {"buffer out items", "buffer own count"},
        [](const FunctionPass& pass, const World&, const Inputs&) {
            Declaration declaration;
            const std::uint64_t capacity = std::max<std::uint64_t>(pass.demand.grown("items"), 16);
            Output items{.port = "items", .desc = Desc::buffer(capacity * 4), .clear = glm::vec4(0)};
            items.counter = "count";
            items.capacity = capacity;
            declaration.outputs = {items, {.port = "count", .desc = Desc::buffer(4), .clear = glm::vec4(0)}};
            declaration.steps = {stepOf("append", {"append.comp"},
                                        {write("items", Access::Storage), write("count", Access::Storage)})};
            declaration.depends = Causes::Frame;
            return declaration;
        },
        [this](FunctionPass& pass, const Step&, Commands& commands) {
            ++runs_[pass.name];
            commands.set("each", static_cast<int>(pass.value) + (commands.frame().index >= 2 ? 4 : 0));
            overFrame(commands);
        });
    addType(
        "Total", {"buffer in items", "out result"},
        [](const FunctionPass&, const World& world, const Inputs&) {
            Declaration declaration;
            declaration.outputs = {imageOf(world, "result")};
            declaration.steps = {
                stepOf("total", {"total.comp"}, {read("items", Access::Storage), write("result")})};
            return declaration;
        },
        [this](FunctionPass& pass, const Step&, Commands& commands) {
            ++runs_[pass.name];
            overFrame(commands);
        });
    // 64 invocations cover the frame of 8 x 4: each adds `value` items, four more from the third frame on.
    const auto renderer =
        rendererOf(graphOf({"list: Append = 2", "total: Total", "sum: Sum = 0", "other: FrameFill = 1"},
                           {"list.items > total.items", "total.result > sum.signal"},
                           {"total.result", "sum.total", "other.result"}));
    EXPECT_EQ(renderer->frame().recompiled, 1);
    EXPECT_THAT(renderer->read({"total", "result"}).values, Each(128.0f));
    EXPECT_EQ(runs_["list"], 2);
    EXPECT_EQ(runs_["sum"], 1) << "what keeps something ran before the list was known to be whole";
    EXPECT_EQ(runs_["other"], 1) << "what does not depend on the list ran twice";
    EXPECT_EQ(renderer->frame().recompiled, 0);
    EXPECT_EQ(renderer->frame().recompiled, 1);
    EXPECT_THAT(renderer->read({"total", "result"}).values, Each(384.0f));
    EXPECT_EQ(runs_["sum"], 3);
}

// Each in its turn, or all at once: what one frame may take is told by port.
TEST_F(OverflowTest, ManyBuffersMayGrowInOneFrame) {
    std::vector<std::string> passes, outputs;
    for (int i = 0; i < 12; ++i) {
        passes.push_back(fmt::format("list{}: List = 100", i));
        outputs.push_back(fmt::format("list{}.list", i));
    }
    const auto renderer = rendererOf(graphOf(passes, {}, outputs));
    EXPECT_GT(renderer->frame().recompiled, 8);
    for (int i = 0; i < 12; ++i)
        EXPECT_EQ(renderer->last().values.at(fmt::format("list{}", i)).at("elements"), 100) << i;
}

TEST_F(OverflowTest, WithoutEndIsAnErrorThatNamesTheNeed) {
    greedy_ = true;
    const auto renderer = rendererOf(graphOf({"list: List = 100"}, {}, {"list.list"}));
    EXPECT_THAT(messageOf<MachineError>([&] { renderer->frame(); }),
                AllOf(HasSubstr("list.list overflows after growing 8 times"), HasSubstr("elements")));
}

TEST_F(OverflowTest, BeyondTheDeviceIsAnErrorThatNamesNeedAndLimit) {
    const auto renderer = rendererOf(graphOf({"list: List = 999999999"}, {}, {"list.list"}));
    const std::string limit = std::to_string(context().capabilities().maxStorageBlockBytes);
    EXPECT_THAT(messageOf<MachineError>([&] { renderer->frame(); }),
                AllOf(HasSubstr("list.list"), HasSubstr("4000000000"), HasSubstr(limit)));
}

} // namespace
} // namespace kestrel::test
