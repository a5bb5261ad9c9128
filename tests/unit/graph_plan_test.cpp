// Memory and barriers as data.
#include "graph/barriers.h"
#include "graph/memory.h"
#include "graph_mock.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

namespace kestrel {
namespace {

using namespace test;
using testing::ElementsAre;

// ---- barriers

TEST(Barriers, EachAccessHasItsBarrier) {
    EXPECT_EQ(barrierFor(Access::Fetch), Barrier::TextureFetch);
    EXPECT_EQ(barrierFor(Access::Image), Barrier::ShaderImage);
    EXPECT_EQ(barrierFor(Access::Storage), Barrier::ShaderStorage);
    EXPECT_EQ(barrierFor(Access::Uniform), Barrier::Uniform);
    EXPECT_EQ(barrierFor(Access::Attachment), Barrier::Framebuffer);
    EXPECT_EQ(barrierFor(Access::Vertex), Barrier::VertexAttrib);
    EXPECT_EQ(barrierFor(Access::Indirect), Barrier::Command);
    EXPECT_EQ(barrierFor(Access::Copy), Barrier::BufferUpdate);
    EXPECT_EQ(barrierFor(Access::Host), Barrier::BufferUpdate);
}

constexpr std::array allAccesses = {Access::Fetch,    Access::Image,      Access::Storage,
                                    Access::Uniform,  Access::Attachment, Access::Vertex,
                                    Access::Indirect, Access::Copy,       Access::Host};

TEST(Barriers, OnlyShaderWritesNeedOneBeforeTheyAreSeen) {
    for (const Access first : allAccesses)
        for (const Access second : allAccesses) {
            const bool shader = first == Access::Image || first == Access::Storage;
            EXPECT_EQ(barrierBetween(first, true, second, false), shader ? barrierFor(second) : Barrier::None)
                << accessName(first) << " then " << accessName(second);
            EXPECT_EQ(barrierBetween(first, false, second, false), Barrier::None);
        }
}

TEST(Barriers, AShaderWriteMayNotOvertakeWhatIsStillRead) {
    for (const Access first : allAccesses) {
        const bool driver = first == Access::Copy || first == Access::Host;
        EXPECT_EQ(barrierBetween(first, false, Access::Image, true),
                  driver ? Barrier::None : Barrier::ShaderImage);
        EXPECT_EQ(barrierBetween(first, false, Access::Storage, true),
                  driver ? Barrier::None : Barrier::ShaderStorage);
        EXPECT_EQ(barrierBetween(first, false, Access::Attachment, true), Barrier::None);
    }
}

TEST(Barriers, HaveNames) {
    EXPECT_EQ(barrierText(Barrier::None), "none");
    EXPECT_EQ(barrierText(Barrier::TextureFetch | Barrier::ShaderStorage), "TextureFetch|ShaderStorage");
}

// A chain of passes by hand: pass i runs every frame, and touches what is given.
struct Touch {
    int resource;
    Access access;
    bool write;
};
Plan planOf(const std::vector<std::vector<Touch>>& steps, int resources, bool everyFrame = true) {
    Plan plan;
    for (int i = 0; i < resources; ++i) {
        PlanResource resource;
        resource.port = {"none", "r"};
        resource.object = i;
        plan.resources.push_back(resource);
        plan.objects.push_back({image(), ""});
    }
    for (size_t i = 0; i < steps.size(); ++i) {
        PlanPass pass;
        pass.name = "p" + std::to_string(i);
        pass.firstStep = static_cast<int>(i);
        pass.stepCount = 1;
        pass.everyFrame = everyFrame;
        plan.passes.push_back(pass);
        PlanStep planned;
        planned.pass = static_cast<int>(i);
        for (const Touch& touch : steps[i]) {
            PlanBinding binding;
            binding.resource = touch.resource;
            binding.access = touch.access;
            binding.write = touch.write;
            planned.bindings.push_back(binding);
        }
        plan.steps.push_back(planned);
    }
    return plan;
}

std::vector<std::string> barriersOf(Plan plan) {
    planBarriers(plan);
    std::vector<std::string> texts;
    for (const PlanStep& step : plan.steps) texts.push_back(barrierText(step.barrier));
    return texts;
}

TEST(Barriers, StandWhereTheyAreNeededAndOnlyOnce) {
    // Rendered, fetched, fetched: nothing.
    EXPECT_THAT(barriersOf(planOf({{{0, Access::Attachment, true}}, {{0, Access::Fetch, false}}}, 1)),
                ElementsAre("none", "none"));
    // Stored, fetched by two: before the first; and the next frame's store waits for the fetches.
    EXPECT_THAT(
        barriersOf(planOf(
            {{{0, Access::Image, true}}, {{0, Access::Fetch, false}}, {{0, Access::Fetch, false}}}, 1)),
        ElementsAre("ShaderImage", "TextureFetch", "none"));
    // Storage written, then as arguments of a dispatch and as uniforms.
    EXPECT_THAT(barriersOf(planOf({{{0, Access::Storage, true}},
                                   {{0, Access::Indirect, false}},
                                   {{0, Access::Uniform, false}},
                                   {{0, Access::Host, false}}},
                                  1)),
                ElementsAre("ShaderStorage", "Command", "Uniform", "BufferUpdate"));
    // One barrier serves two resources.
    EXPECT_THAT(barriersOf(planOf({{{0, Access::Image, true}, {1, Access::Image, true}},
                                   {{0, Access::Fetch, false}},
                                   {{1, Access::Fetch, false}}},
                                  2)),
                ElementsAre("ShaderImage", "TextureFetch", "none"));
}

TEST(Barriers, ABarrierOfAPassThatMayBeSkippedServesNobodyElse) {
    Plan plan = planOf({{{0, Access::Image, true}, {1, Access::Image, true}},
                        {{0, Access::Fetch, false}},
                        {{1, Access::Fetch, false}}},
                       2, false);
    EXPECT_THAT(barriersOf(plan), ElementsAre("ShaderImage", "TextureFetch", "TextureFetch"));
    // It serves others for what it reads itself, where it runs whenever that was written.
    plan = planOf({{{0, Access::Image, true}}, {{0, Access::Fetch, false}}, {{0, Access::Fetch, false}}}, 1,
                  false);
    EXPECT_THAT(barriersOf(plan), ElementsAre("ShaderImage", "TextureFetch", "TextureFetch"));
    plan.passes[1].inputs = {0};
    EXPECT_THAT(barriersOf(plan), ElementsAre("ShaderImage", "TextureFetch", "none"));
}

TEST(Barriers, TheFrameIsACircle) {
    // What the last step writes, the first one reads in the next frame.
    EXPECT_THAT(barriersOf(planOf({{{0, Access::Fetch, false}}, {{0, Access::Storage, true}}}, 1)),
                ElementsAre("TextureFetch", "ShaderStorage"));
}

TEST(Barriers, RangesOfOneBufferMeetOnlyWhereTheyOverlap) {
    Plan plan =
        planOf({{{0, Access::Image, true}}, {{1, Access::Fetch, false}}, {{0, Access::Fetch, false}}}, 2);
    plan.objects = {{Desc::buffer(1024), ""}};
    for (PlanResource& resource : plan.resources) {
        resource.desc = Desc::buffer(512);
        resource.object = 0;
    }
    plan.resources[1].offset = 256;
    EXPECT_THAT(barriersOf(plan), ElementsAre("ShaderImage", "TextureFetch", "none"));
    plan.resources[1].offset = 512;
    EXPECT_THAT(barriersOf(plan), ElementsAre("ShaderImage", "none", "TextureFetch"));
}

// ---- memory

Declare chainLink(std::uint32_t side, bool scratch) {
    return [=](const World&, const Inputs& in, const Demand&) {
        Declaration d;
        d.depends = Causes::Frame;
        d.outputs = {output("r", image(side))};
        d.steps = {step("s", {writes("r", Access::Attachment)})};
        if (in.connected("x")) d.steps[0].uses.push_back(reads("x"));
        if (in.connected("y")) d.steps[0].uses.push_back(reads("y"));
        if (scratch) {
            d.outputs.push_back(output("scratch", image(side)));
            d.steps.insert(d.steps.begin(), step("first", {writes("scratch", Access::Attachment)}));
            d.steps[1].uses.push_back(reads("scratch"));
        }
        return d;
    };
}

Registry chainRegistry() {
    Registry registry;
    registry.add(mockType("Link", {opt("x"), opt("y"), out("r"), internal("scratch")}, chainLink(64, false)));
    registry.add(mockType("Small", {opt("x"), out("r"), internal("scratch")}, chainLink(32, false)));
    registry.add(mockType("Inner", {opt("x"), out("r"), internal("scratch")}, chainLink(64, true)));
    return registry;
}

// Steps: 0 a.s, 1 b.s, 2 small.s, 3 c.first, 4 c.s, 5 d.s, 6 e.s. An image of 64x64 RGBA16F has 32768 bytes,
// one of 32x32 has 8192.
//   a.r [0,1] object 0    b.r [1,6] object 1    small.r [2,4] object 2 (smaller)
//   c.scratch [3,4]: object 0 is free since 1   c.r [4,5]: a third one   d.r [5,6]: object 0, free since 4
//   e.r: an output, its own
constexpr const char* chain = R"({"kestrel": 1, "passes": {
    "a": {"type": "Link"}, "b": {"type": "Link"}, "small": {"type": "Small"}, "c": {"type": "Inner"},
    "d": {"type": "Link"}, "e": {"type": "Link"}},
    "edges": [["a.r", "b.x"], ["b.r", "small.x"], ["small.r", "c.x"], ["c.r", "d.x"], ["d.r", "e.x"],
              ["b.r", "e.y"]],
    "outputs": ["e.r"]})";

TEST(Memory, SharingIsExactToTheByte) {
    const Plan plan = compileText(chain, chainRegistry());
    constexpr std::uint64_t large = 64 * 64 * 8, small = 32 * 32 * 8;
    EXPECT_EQ(plan.memory.unshared, 5 * large + small);
    EXPECT_EQ(plan.memory.transient, 3 * large + small);
    EXPECT_EQ(plan.memory.persistent, large);
    std::vector<std::string> labels;
    for (const PlanObject& object : plan.objects) labels.push_back(object.label);
    EXPECT_THAT(labels, ElementsAre("a.r, c.scratch, d.r", "e.r", "b.r", "small.r", "c.r"));
    EXPECT_EQ(resourceAt(plan, "b.r")->firstStep, 1);
    EXPECT_EQ(resourceAt(plan, "b.r")->lastStep, 6);
}

TEST(Memory, ASwitchTurnsSharingOff) {
    CompileOptions options;
    options.shareMemory = false;
    const Plan plan = compileText(chain, chainRegistry(), options);
    EXPECT_EQ(plan.memory.transient, plan.memory.unshared);
    EXPECT_EQ(plan.objects.size(), plan.resources.size());
}

TEST(Memory, WhatMayBeSkippedSharesNothing) {
    Registry registry = chainRegistry();
    registry.add(mockType("Static", {opt("x"), out("r")}, simple({"x"}, {"r"}, Causes::Materials)));
    const Plan plan =
        compileText(R"({"kestrel": 1, "passes": {"a": {"type": "Static"}, "b": {"type": "Static"},
        "c": {"type": "Static"}, "d": {"type": "Link"}}, "edges": [["a.r", "b.x"], ["b.r", "c.x"], ["c.r", "d.x"]],
        "outputs": ["d.r"]})",
                    registry);
    EXPECT_EQ(plan.memory.transient, 0u);
    EXPECT_EQ(plan.memory.persistent, 3u * 16 * 16 * 8 + 64 * 64 * 8);
}

// A chain of buffers: pass i writes one of so many bytes and reads that of the pass before.
Registry bufferRegistry(const std::vector<std::uint64_t>& sizes) {
    Registry registry;
    for (size_t i = 0; i < sizes.size(); ++i)
        registry.add(mockType("B" + std::to_string(i),
                              {opt("x", PortKind::Buffer), out("r", PortKind::Buffer)},
                              [bytes = sizes[i]](const World&, const Inputs& in, const Demand&) {
                                  Declaration d;
                                  d.depends = Causes::Frame;
                                  d.outputs = {output("r", Desc::buffer(bytes))};
                                  d.steps = {step("s", {writes("r", Access::Storage)})};
                                  if (in.connected("x"))
                                      d.steps[0].uses.push_back(reads("x", Access::Storage));
                                  return d;
                              }));
    return registry;
}
// Each step reads what the one before made, so two neighbours live at a time.
constexpr const char* bufferChain = R"({"kestrel": 1, "passes": {
    "a": {"type": "B0"}, "b": {"type": "B1"}, "c": {"type": "B2"}, "d": {"type": "B3"}, "e": {"type": "B4"}},
    "edges": [["a.r", "b.x"], ["b.r", "c.x"], ["c.r", "d.x"], ["d.r", "e.x"]], "outputs": ["e.r"]})";

TEST(Memory, BuffersOfDifferentSizesShareByRanges) {
    // a [0,1] and b [1,2] meet, b and c [2,3], c and d [3,4]: the peak is a and b. e is an output.
    const Plan plan = compileText(bufferChain, bufferRegistry({1024, 3072, 768, 2048, 5000}));
    EXPECT_EQ(plan.memory.unshared, 1024u + 3072 + 768 + 2048);
    EXPECT_EQ(plan.memory.transient, 1024u + 3072);
    EXPECT_EQ(plan.memory.persistent, 5000u);
    ASSERT_EQ(plan.objects.size(), 2u);
    EXPECT_EQ(plan.objects[0].label, "a.r, b.r, c.r, d.r");
    EXPECT_EQ(plan.objects[0].desc, Desc::buffer(4096));
    EXPECT_EQ(resourceAt(plan, "b.r")->offset, 0u);
    EXPECT_EQ(resourceAt(plan, "d.r")->offset, 0u);
    EXPECT_EQ(resourceAt(plan, "a.r")->offset, 3072u);
    EXPECT_EQ(resourceAt(plan, "c.r")->offset, 3072u);
    // The barrier before each reader also holds back the store into a place that was read a step ago.
    EXPECT_THAT(barriersOf(plan),
                ElementsAre("none", "ShaderStorage", "ShaderStorage", "ShaderStorage", "ShaderStorage"));
}

TEST(Memory, BuffersStayAloneWhereRangesSaveNothing) {
    // Less than the alignment is no gain, and equal sizes share as textures do.
    Plan plan = compileText(bufferChain, bufferRegistry({200, 100, 200, 255, 64}));
    EXPECT_EQ(plan.memory.transient, 200u + 100 + 255);
    EXPECT_EQ(plan.memory.unshared, 200u + 100 + 200 + 255);
    for (const PlanResource& resource : plan.resources) EXPECT_EQ(resource.offset, 0u);
    CompileOptions options;
    options.shareMemory = false;
    plan = compileText(bufferChain, bufferRegistry({1000, 3000, 700, 2000, 4096}), options);
    EXPECT_EQ(plan.memory.transient, plan.memory.unshared);
    EXPECT_EQ(plan.objects.size(), plan.resources.size());
}

void expectPacked(const std::vector<Lifetime>& lifetimes, const Packing& packing) {
    ASSERT_EQ(packing.offsets.size(), lifetimes.size());
    std::uint64_t end = 0;
    for (size_t i = 0; i < lifetimes.size(); ++i) {
        EXPECT_EQ(packing.offsets[i] % rangeAlignment, 0u);
        end = std::max(end, packing.offsets[i] + lifetimes[i].bytes);
        for (size_t j = 0; j < i; ++j) {
            const bool together =
                lifetimes[i].first <= lifetimes[j].last && lifetimes[j].first <= lifetimes[i].last;
            const bool apart = packing.offsets[i] + lifetimes[i].bytes <= packing.offsets[j] ||
                               packing.offsets[j] + lifetimes[j].bytes <= packing.offsets[i];
            EXPECT_TRUE(!together || apart) << i << " and " << j;
        }
    }
    EXPECT_EQ(packing.bytes, end);
    EXPECT_GE(packing.bytes, peakBytes(lifetimes));
}

// The fewest bytes: in some order of placing, the lowest gap for each is optimal (take an optimal packing by
// offset; each moves down at most).
std::uint64_t fewestBytes(const std::vector<Lifetime>& lifetimes) {
    std::vector<size_t> order(lifetimes.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::uint64_t fewest = UINT64_MAX;
    do {
        std::vector<std::uint64_t> offsets(lifetimes.size());
        std::uint64_t end = 0;
        for (size_t i = 0; i < order.size(); ++i) {
            const Lifetime& one = lifetimes[order[i]];
            std::uint64_t& offset = offsets[order[i]];
            for (bool moved = true; moved;) {
                moved = false;
                for (size_t j = 0; j < i; ++j) {
                    const Lifetime& other = lifetimes[order[j]];
                    const std::uint64_t begin = offsets[order[j]];
                    if (one.first > other.last || other.first > one.last) continue;
                    if (offset + one.bytes <= begin || begin + other.bytes <= offset) continue;
                    offset = begin + other.bytes;
                    moved = true;
                }
            }
            end = std::max(end, offset + one.bytes);
        }
        fewest = std::min(fewest, end);
    } while (std::next_permutation(order.begin(), order.end()));
    return fewest;
}

TEST(Packing, IsValidAndNearlyTheFewestBytes) {
    std::mt19937 random(1);
    const auto below = [&](std::uint32_t n) { return static_cast<int>(random() % n); };
    int optimal = 0;
    constexpr int trials = 300;
    for (int trial = 0; trial < trials && !testing::Test::HasFailure(); ++trial) {
        SCOPED_TRACE(trial);
        std::vector<Lifetime> lifetimes(static_cast<size_t>(2 + below(5)));
        for (Lifetime& one : lifetimes) {
            one.first = below(8);
            one.last = one.first + below(5);
            one.bytes = rangeAlignment * static_cast<std::uint64_t>(1 + below(8));
        }
        const Packing packing = packLifetimes(lifetimes);
        expectPacked(lifetimes, packing);
        const std::uint64_t fewest = fewestBytes(lifetimes);
        EXPECT_GE(packing.bytes, fewest);
        EXPECT_LE(packing.bytes, fewest + fewest / 3);
        optimal += packing.bytes == fewest ? 1 : 0;
    }
    EXPECT_GE(optimal, trials * 9 / 10);
    EXPECT_EQ(packLifetimes({}).bytes, 0u);
}

TEST(Packing, ManyOfAnySizeAreValid) {
    std::mt19937 random(2);
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<Lifetime> lifetimes(60);
        for (Lifetime& one : lifetimes) {
            one.first = static_cast<int>(random() % 40);
            one.last = one.first + static_cast<int>(random() % 10);
            one.bytes = 1 + random() % 5000;
        }
        expectPacked(lifetimes, packLifetimes(lifetimes));
    }
}

TEST(Memory, StorageIsEqualButForTheView) {
    Desc a = image(), b = image();
    b.view.jitter = true;
    EXPECT_TRUE(sameStorage(a, b));
    b.mips = 2;
    EXPECT_FALSE(sameStorage(a, b));
}

TEST(Memory, BytesCountMipsLayersAndFaces) {
    EXPECT_EQ(Desc::texture3D(Format::R8, {4, 4, 4}, 3).totalBytes(), 64u + 8 + 1);
    EXPECT_EQ(Desc::array2D(Format::R32UI, {3, 2, 5}).totalBytes(), 3u * 2 * 5 * 4);
    Desc cube = Desc::texture2D(Format::RG16F, {8, 8, 1});
    cube.kind = ResourceKind::TextureCube;
    EXPECT_EQ(cube.totalBytes(), 6u * 64 * 4);
    EXPECT_EQ(Desc::buffer(100).totalBytes(), 100u);
    EXPECT_EQ(describe(Desc::texture3D(Format::R8, {4, 4, 4}, 3)), "r8 4x4x4, 3 mips");
    EXPECT_EQ(describe(Desc::array2D(Format::R32UI, {3, 2, 5})), "r32ui 3x2, 5 layers");
    EXPECT_EQ(describe(Desc::buffer(std::uint64_t{4} << 20)), "buffer 4 MiB");
    EXPECT_EQ(describe(Desc::buffer(1536, Format::R32UI)), "r32ui buffer 1.5 KiB");
}

} // namespace
} // namespace kestrel
