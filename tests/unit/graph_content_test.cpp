// What ports carry: found by validation, told by the tables, held at compilation.
#include "core/json.h"
#include "graph/report.h"
#include "graph_mock.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

PortInfo carrying(PortInfo port, Content content, std::string sameExtentAs = {}) {
    port.content = std::move(content);
    port.sameExtentAs = std::move(sameExtentAs);
    return port;
}

// A source of everything, whose second picture is `side` wide, and a consumer that states what it takes.
Registry contentRegistry(std::uint32_t side = 16, View view = {}) {
    Registry registry;
    registry.add(mockType(
        "Source",
        {carrying(out("depth"), content::depth), carrying(out("linear"), content::viewDepth),
         carrying(out("grey"), {.channels = 1}), carrying(out("normal"), content::normal), out("plain"),
         carrying(out("rays", PortKind::Buffer), content::elements("RayRecord")),
         out("bytes", PortKind::Buffer)},
        [side, view](const World&, const Inputs&, const Demand& demand) {
            Declaration d;
            Step only = step("only", {});
            for (const char* port : {"depth", "linear", "grey", "normal", "plain"}) {
                if (!demand.reads(port)) continue;
                const bool grey = std::string_view(port) == "grey" || std::string_view(port) == "plain";
                Desc desc = Desc::texture2D(grey ? Format::R16F : Format::RGBA16F, {16, 16, 1});
                if (std::string_view(port) == "normal") {
                    desc.extent = {side, 16, 1};
                    desc.view = view;
                }
                d.outputs.push_back(output(port, desc));
                only.uses.push_back(writes(port));
            }
            for (const char* port : {"rays", "bytes"})
                if (demand.reads(port)) {
                    d.outputs.push_back(output(port, Desc::buffer(64)));
                    only.uses.push_back(writes(port, Access::Storage));
                }
            d.steps.push_back(only);
            return d;
        }));
    registry.add(
        mockType("Shade",
                 {carrying(in("depth"), content::depth), carrying(opt("normal"), content::normal, "depth"),
                  carrying(opt("rays", PortKind::Buffer), content::elements("RayRecord")), out("r")},
                 simple({"depth", "normal"}, {"r"})));
    return registry;
}

std::vector<std::string> mistakesOf(const std::string& edges) {
    std::vector<std::string> messages;
    const std::string text =
        R"({"kestrel": 1, "passes": {"s": {"type": "Source"}, "t": {"type": "Shade"}}, "edges": [)" + edges +
        R"(], "outputs": ["t.r"]})";
    for (const Problem& problem : validate(parseGraph(text, "g.json"), contentRegistry()))
        messages.push_back(problem.message);
    return messages;
}

TEST(Content, WhatFitsIsTaken) {
    EXPECT_THAT(mistakesOf(R"(["s.depth", "t.depth"], ["s.normal", "t.normal"], ["s.rays", "t.rays"])"),
                IsEmpty());
    // What is not stated is not held against anything but a struct.
    EXPECT_THAT(mistakesOf(R"(["s.plain", "t.depth"])"), IsEmpty());
}

TEST(Content, EveryMisfitIsAMistakeOfItsEdge) {
    EXPECT_THAT(
        mistakesOf(R"(["s.linear", "t.depth"], ["s.grey", "t.normal"], ["s.bytes", "t.rays"])"),
        ElementsAre("'s.linear' cannot feed 't.depth': it carries values of view space, not of device space",
                    "'s.grey' cannot feed 't.normal': it carries 1 of the 3 channels that are read",
                    "'s.bytes' cannot feed 't.rays': it carries no RayRecord elements"));
    EXPECT_EQ(contentMistake(content::elements("HitRecord"), content::elements("RayRecord")),
              "HitRecord elements, not RayRecord");
}

std::string compileMessage(const std::string& edges, const Registry& registry) {
    const std::string text =
        R"({"kestrel": 1, "passes": {"s": {"type": "Source"}, "t": {"type": "Shade"}}, "edges": [)" + edges +
        R"(], "outputs": ["t.r"]})";
    World world;
    world.facts.cameras = {"only"};
    return messageOf<InputError>([&] { compileText(text, registry, {}, world); });
}

TEST(Content, AnExtentThatMustBeSharedIsHeldWhereItIsKnown) {
    const std::string both = R"(["s.depth", "t.depth"], ["s.normal", "t.normal"])";
    EXPECT_THAT(compileMessage(both, contentRegistry(8)),
                HasSubstr("pass 't' (Shade), 'normal': is rgba16f 8x16 but depth is rgba16f 16x16"));
    // As large, but seen from elsewhere.
    EXPECT_THAT(compileMessage(both, contentRegistry(16, {.source = CameraView{}})),
                HasSubstr("is rgba16f 16x16 seen by camera 0 but depth is rgba16f 16x16"));
}

TEST(Content, ChannelsThatOnlyTheFormatTellsAreCounted) {
    EXPECT_THAT(compileMessage(R"(["s.depth", "t.depth"], ["s.plain", "t.normal"])", contentRegistry()),
                HasSubstr("'normal': is r16f 16x16, of which 3 channels are read"));
}

TEST(Content, ATypeThatContradictsItselfIsRefused) {
    Registry registry;
    EXPECT_THAT(messageOf<InputError>([&] {
                    registry.add(mockType("Wrong", {carrying(in("a"), {}, "nothing"), out("r")},
                                          simple({"a"}, {"r"})));
                }),
                HasSubstr("'a' cannot have the extent of 'nothing'"));
}

TEST(Content, IsToldByTheTables) {
    const Registry registry = contentRegistry();
    EXPECT_THAT(passTypeText(*registry.find("Shade")),
                HasSubstr("input normal (texture, optional, 3 channels, render space, extent of depth)"));
    const Json ports = Json::parse(passesJson({registry.find("Shade")}), "passes");
    const Json& normal = ports.find("passes")->items[0].find("ports")->items[1];
    EXPECT_EQ(normal.find("channels")->integer, 3);
    EXPECT_EQ(normal.find("space")->text, "render");
    EXPECT_EQ(normal.find("same_extent_as")->text, "depth");
    const Json schema = Json::parse(graphSchema(registry), "schema");
    EXPECT_EQ(schema.find("$defs")->find("Shade")->find("ports")->items[2].find("structure")->text,
              "RayRecord");
}

// ---- layers: what a consumer must know at its own declaration

Registry layersRegistry(int count) {
    Registry registry;
    registry.add(mockType(
        "Map", {out("layers", PortKind::Layers)}, [count](const World&, const Inputs&, const Demand&) {
            Declaration d;
            d.outputs = {output("layers", Desc::layersModule({.count = count, .ordered = true},
                                                             {.divisor = 4, .guard = 64, .jitter = true}))};
            Module module;
            module.port = "layers";
            module.shader = "map.glsl";
            d.modules = {std::move(module)};
            return d;
        }));
    registry.add(mockType("Reader", {in("layers", PortKind::Layers), out("r")},
                          [](const World&, const Inputs& inputs, const Demand&) {
                              Declaration d;
                              const Desc& desc = inputs["layers"].desc;
                              d.outputs = {output("r", image(static_cast<std::uint32_t>(
                                                           desc.depthLayers.count * desc.view.divisor)))};
                              d.steps = {step("read", {writes("r")}, {{"layers", 0}})};
                              return d;
                          }));
    return registry;
}

const std::string layersText = R"({"kestrel": 1, "passes": {"m": {"type": "Map"}, "r": {"type": "Reader"}},
    "edges": [["m.layers", "r.layers"]], "outputs": ["r.r"]})";

TEST(Content, ALayersModuleTellsItsConsumersWhatTheyDeclareBy) {
    const Plan plan = compileText(layersText, layersRegistry(4));
    EXPECT_EQ(describe(resourceAt(plan, "r.r")->desc), "rgba16f 16x16");
    EXPECT_EQ(describe(passAt(plan, "m")->descs.at("layers")), "module of 4 depth layers in order");
    EXPECT_THAT(messageOf<InputError>([] { compileText(layersText, layersRegistry(0)); }),
                HasSubstr("'layers': does not say how many depth layers a texel holds"));
}

TEST(Content, LayersWithoutTrianglesAreRefusedToWhoRequestsThem) {
    Registry registry = layersRegistry(4);
    registry.add(mockType("Surfaces", {in("layers", PortKind::Layers), out("r")},
                          [](const World&, const Inputs&, const Demand&) {
                              Declaration d;
                              d.outputs = {output("r", image(16))};
                              d.steps = {step("read", {writes("r")}, {{"layers", requests::Surface}})};
                              return d;
                          }));
    std::string text = layersText;
    text.replace(text.find("Reader"), 6, "Surfaces");
    EXPECT_THAT(messageOf<InputError>([&] { compileText(text, registry); }),
                HasSubstr("'r' needs the triangles of samples, which 'm.layers' does not give"));
}

} // namespace
} // namespace kestrel
