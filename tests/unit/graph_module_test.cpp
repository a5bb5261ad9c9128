// Modules: names, defines, inherited uses, what is provided and requested.
#include "graph/glsl_names.h"
#include "graph/network.h"
#include "graph_mock.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using namespace test;
using testing::ElementsAre;

TEST(GlslName, FollowsTheRule) {
    const auto name = [](const std::string& prefix, Access access, bool previous = false,
                         bool beside = false) {
        Use use = reads("ray_buffer", access);
        use.previous = previous;
        return glslName(prefix, use, ResourceKind::Buffer, beside);
    };
    EXPECT_EQ(name("", Access::Fetch), "ray_buffer");
    EXPECT_EQ(name("", Access::Image, false, true), "ray_buffer_out");
    EXPECT_EQ(name("tracer_", Access::Image), "tracer_ray_buffer");
    EXPECT_EQ(name("", Access::Storage), "RayBuffer");
    EXPECT_EQ(name("tracer_near_", Access::Uniform), "tracer_near_RayBuffer");
    EXPECT_EQ(name("", Access::Storage, true), "PreviousRayBuffer");
    EXPECT_EQ(name("tracer_", Access::Fetch, true), "tracer_previous_ray_buffer");
    EXPECT_EQ(name("", Access::Copy), "");
    EXPECT_EQ(glslName("", writes("depth", Access::Attachment), ResourceKind::Texture2D, false), "out_depth");
}

Output moduleOutput(const std::string& port, Bits provides) { return output(port, Desc::module(provides)); }

Module module(std::string port, std::string shader, std::vector<Use> uses,
              std::vector<ModuleUse> modules = {}) {
    Module made;
    made.port = std::move(port);
    made.shader = std::move(shader);
    made.uses = std::move(uses);
    made.modules = std::move(modules);
    return made;
}

Registry tracerRegistry() {
    Registry registry;
    registry.add(
        mockType("Map", {out("map", PortKind::Buffer)}, [](const World&, const Inputs&, const Demand&) {
            Declaration d;
            d.outputs = {output("map", Desc::buffer(1024, Format::R32UI))};
            d.steps = {step("build", {writes("map", Access::Storage)})};
            return d;
        }));
    // Traces through its own rotated maps and the input map.
    registry.add(mockType(
        "Roma",
        {in("map", PortKind::Buffer), internal("maps", PortKind::Buffer), out("tracer", PortKind::Tracer)},
        [](const World&, const Inputs&, const Demand& demand) {
            Declaration d;
            d.outputs = {output("maps", Desc::buffer(4096, Format::R32UI)),
                         moduleOutput("tracer", provides::Snaps)};
            d.modules = {module("tracer", "roma/roma.glsl",
                                {reads("maps", Access::Image), reads("map", Access::Storage)})};
            if ((demand.requests("tracer") & requests::ClosestHit) != 0)
                d.modules[0].defines["CLOSEST"] = "1";
            d.steps = {step("rotate", {reads("map"), writes("maps", Access::Storage)})};
            return d;
        }));
    // Only a file: no step, no resource.
    registry.add(mockType("Screen", {in("depth"), out("tracer", PortKind::Tracer)},
                          [](const World&, const Inputs&, const Demand&) {
                              Declaration d;
                              d.depends = Causes::Frame;
                              d.outputs = {moduleOutput("tracer", provides::Surface)};
                              d.modules = {module("tracer", "screen/screen.glsl", {reads("depth")})};
                              return d;
                          }));
    registry.add(mockType(
        "NearFar",
        {in("near", PortKind::Tracer), in("far", PortKind::Tracer), internal("block", PortKind::Buffer),
         out("tracer", PortKind::Tracer)},
        [](const World&, const Inputs& in, const Demand& demand) {
            Declaration d;
            const Bits nearGives = in["near"].desc.provides, farGives = in["far"].desc.provides;
            if ((nearGives & provides::Snaps) != 0)
                d.problems = {{"near", "snaps: both halves need one direction"}};
            d.outputs = {moduleOutput("tracer", (nearGives & farGives) | (farGives & provides::Snaps)),
                         output("block", Desc::buffer(16))};
            const Bits taken = demand.requests("tracer");
            d.modules = {module("tracer", "near_far/near_far.glsl", {reads("block", Access::Uniform)},
                                {{"near", taken & ~requests::Snap}, {"far", taken}})};
            d.steps = {step("block", {writes("block", Access::Copy)}, {}, {})};
            return d;
        }));
    registry.add(mockType("Snapper", {out("tracer", PortKind::Tracer)},
                          [](const World&, const Inputs&, const Demand&) {
                              Declaration d;
                              d.outputs = {moduleOutput("tracer", provides::Snaps | provides::AlwaysSnaps)};
                              d.modules = {module("tracer", "snapper/snapper.glsl", {})};
                              return d;
                          }));
    registry.add(mockType("Depth", {out("depth")}, simple({}, {"depth"})));
    const auto consumer = [](Bits taken) {
        return [taken](const World&, const Inputs&, const Demand&) {
            Declaration d;
            d.outputs = {output("r")};
            d.steps = {step("trace", {writes("r")}, {{"tracer", taken}}, {"ao/ao.comp"})};
            return d;
        };
    };
    registry.add(mockType("Ao", {in("tracer", PortKind::Tracer), out("r")},
                          consumer(requests::AnyHit | requests::Snap)));
    registry.add(mockType("Shadow", {in("tracer", PortKind::Tracer), out("r")}, consumer(requests::AnyHit)));
    registry.add(mockType("Gi", {in("tracer", PortKind::Tracer), out("r")},
                          consumer(requests::ClosestHit | requests::Surface | requests::Snap)));
    return registry;
}

std::vector<std::string> bindingNames(const Plan& plan, const PlanStep& step) {
    std::vector<std::string> names;
    for (const PlanBinding& binding : step.bindings)
        names.push_back(binding.name + "=" +
                        plan.resources[static_cast<size_t>(binding.resource)].port.text());
    return names;
}

TEST(Modules, TwoTracersNestedInAConsumer) {
    const Plan plan = compileText(R"({"kestrel": 1, "passes": {
        "map": {"type": "Map"}, "roma": {"type": "Roma"}, "gbuffer": {"type": "Depth"}, "screen": {"type": "Screen"},
        "both": {"type": "NearFar"}, "ao": {"type": "Ao"}, "shadow": {"type": "Shadow"}},
        "edges": [["map.map", "roma.map"], ["gbuffer.depth", "screen.depth"], ["screen.tracer", "both.near"],
                  ["roma.tracer", "both.far"], ["both.tracer", "ao.tracer"], ["both.tracer", "shadow.tracer"]],
        "outputs": ["ao.r", "shadow.r"]})",
                                  tracerRegistry());
    EXPECT_THAT(passNames(plan), ElementsAre("map", "roma", "gbuffer", "screen", "both", "ao", "shadow"));
    const PlanPass& ao = *passAt(plan, "ao");
    const PlanStep& trace = plan.steps[static_cast<size_t>(ao.firstStep)];
    EXPECT_THAT(bindingNames(plan, trace),
                ElementsAre("r=ao.r", "tracer_Block=both.block", "tracer_near_depth=gbuffer.depth",
                            "tracer_far_maps=roma.maps", "tracer_far_Map=map.map"));
    EXPECT_EQ(trace.bindings[0].port, "r");
    EXPECT_EQ(trace.bindings[3].port, "maps");
    EXPECT_EQ(trace.bindings[0].path, "");
    EXPECT_EQ(trace.bindings[3].path, "tracer_far_");

    const ProgramRequest& program = plan.programs[static_cast<size_t>(trace.program)];
    const ModuleInstance& both = program.modules.at("tracer");
    EXPECT_EQ(both.file, "near_far/near_far.glsl");
    EXPECT_EQ(both.defines, (Defines{{"REQUESTS_ANY", "1"}, {"REQUESTS_SNAP", "1"}}));
    EXPECT_EQ(both.modules.at("near").defines, (Defines{{"REQUESTS_ANY", "1"}}));
    EXPECT_EQ(both.modules.at("far").file, "roma/roma.glsl");
    EXPECT_EQ(both.modules.at("far").defines, (Defines{{"REQUESTS_ANY", "1"}, {"REQUESTS_SNAP", "1"}}));
    // The same module in a consumer that does not bear snapping: another variant, also inside.
    const PlanPass& shadow = *passAt(plan, "shadow");
    const auto& exact =
        plan.programs[static_cast<size_t>(plan.steps[static_cast<size_t>(shadow.firstStep)].program)];
    EXPECT_EQ(exact.modules.at("tracer").defines, (Defines{{"REQUESTS_ANY", "1"}}));
    EXPECT_EQ(exact.modules.at("tracer").modules.at("far").defines, (Defines{{"REQUESTS_ANY", "1"}}));

    // Causes: through the module to everything behind it. The block of `both` needs none of them.
    EXPECT_THAT(ao.inputs, ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(ao.inputPasses.at("tracer"), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_TRUE(ao.everyFrame);
    const PlanPass& nearFar = *passAt(plan, "both");
    EXPECT_THAT(nearFar.inputs, ElementsAre());
    EXPECT_FALSE(nearFar.everyFrame);
    EXPECT_EQ(passAt(plan, "screen")->stepCount, 0);
    EXPECT_EQ(passAt(plan, "screen")->descs.at("tracer").provides, provides::Surface);

    // The depth lives until its last reader, which reads it through two modules.
    EXPECT_EQ(resourceAt(plan, "gbuffer.depth")->lastStep, shadow.firstStep);
    EXPECT_FALSE(resourceAt(plan, "roma.maps")->transient);
    // The maps (image) and the map (storage) were made visible by barriers of steps before.
    EXPECT_EQ(trace.barrier, Barrier::TextureFetch);

    std::map<std::string, const PlanView*> views;
    for (const PlanView& view : trace.views) views.emplace(view.name, &view);
    ASSERT_TRUE(views.contains("RView") && views.contains("tracer_near_PreviousDepthView"));
    ASSERT_TRUE(views.contains("tracer_near_DepthView"));
    EXPECT_EQ(plan.resources[static_cast<size_t>(views.at("tracer_near_DepthView")->resource)].port.text(),
              "gbuffer.depth");
    EXPECT_TRUE(views.at("tracer_near_PreviousDepthView")->previous);
}

TEST(Modules, TheUnionOfWhatConsumersTakeReachesTheProvider) {
    const std::string text = R"({"kestrel": 1, "passes": {"map": {"type": "Map"}, "roma": {"type": "Roma"},
        "ao": {"type": "Ao"}, "shadow": {"type": "Shadow"}},
        "edges": [["map.map", "roma.map"], ["roma.tracer", "ao.tracer"], ["roma.tracer", "shadow.tracer"]],
        "outputs": ["ao.r", "shadow.r"]})";
    const Plan plan = compileText(text, tracerRegistry());
    EXPECT_FALSE(plan.programs.back().modules.at("tracer").defines.contains("CLOSEST"));
    CompileOptions keep;
    keep.keepAll = true;
    EXPECT_TRUE(compileText(text, tracerRegistry(), keep)
                    .programs.back()
                    .modules.at("tracer")
                    .defines.contains("CLOSEST"));
}

TEST(Modules, AMismatchIsAnErrorWithASentence) {
    EXPECT_EQ(
        messageOf([] {
            compileText(R"({"kestrel": 1, "passes": {"map": {"type": "Map"}, "roma": {"type": "Roma"},
"s": {"type": "Snapper"},
"gi": {"type": "Gi"}, "shadow": {"type": "Shadow"}, "both": {"type": "NearFar"}, "ao": {"type": "Ao"}},
"edges": [["map.map", "roma.map"],
["roma.tracer", "gi.tracer"], ["s.tracer", "shadow.tracer"],
["roma.tracer", "both.near"], ["roma.tracer", "both.far"], ["both.tracer", "ao.tracer"]],
"outputs": ["gi.r", "shadow.r", "ao.r"]})",
                        tracerRegistry());
        }),
        "g.json:5:1: pass 'gi' (Gi), 'tracer': 'gi' needs normals and materials at hits, which 'roma.tracer' "
        "does not give\n"
        "g.json:5:31: pass 'shadow' (Shadow), 'tracer': 'shadow' needs the exact direction, but 's.tracer' "
        "always snaps to a nearby one\n"
        "g.json:6:1: pass 'both' (NearFar), 'near': snaps: both halves need one direction");
}

TEST(Modules, AMismatchThatNobodyAsksForIsNoError) {
    const std::string text = R"({"kestrel": 1, "passes": {"map": {"type": "Map"}, "roma": {"type": "Roma"},
        "gi": {"type": "Gi"}, "ao": {"type": "Ao"}}, "edges": [["map.map", "roma.map"], ["roma.tracer", "gi.tracer"],
        ["roma.tracer", "ao.tracer"]], "outputs": ["ao.r"]})";
    EXPECT_THAT(passNames(compileText(text, tracerRegistry())), ElementsAre("map", "roma", "ao"));
    CompileOptions keep;
    keep.keepAll = true; // every demand that it can bear: none
    const Plan plan = compileText(text, tracerRegistry(), keep);
    EXPECT_THAT(passNames(plan), ElementsAre("map", "roma", "ao"));
    EXPECT_THAT(leftOutTexts(plan), ElementsAre("gi: it cannot bear every demand, and nobody reads 'gi.r'"));
}

} // namespace
} // namespace kestrel
