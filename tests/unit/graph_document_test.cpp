#include "core/files.h"
#include "graph_mock.h"
#include <algorithm>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using namespace test;
using testing::ElementsAre;

const std::string canonical = R"({
  "kestrel": 1,
  "name": "Ambient occlusion by rays",
  "comment": "Two rivals \"side by side\"",
  "scene": { "source": "builtin:tower", "camera": "stairs" },
  "passes": {
    "gbuffer": { "type": "GBuffer" },
    "roma": { "type": "Roma", "properties": { "directions": 16, "snap": true, "bias": 1.5, "method": "exact" } },
    "ao": { "type": "Ao", "properties": { "tint": [1, 0.5, 0.1] }, "position": [12, -3.5], "comment": "ä" }
  },
  "edges": [
    ["gbuffer.depth", "ao.depth"],
    ["roma.tracer", "ao.tracer"]
  ],
  "outputs": ["ao.visibility", "gbuffer.depth"]
}
)";

TEST(GraphDocument, CanonicalTextSurvivesLoadAndSaveToTheByte) {
    const Graph graph = parseGraph(canonical, "g.json");
    EXPECT_EQ(graph.name, "Ambient occlusion by rays");
    EXPECT_EQ(graph.sceneSetup.cameraName, "stairs");
    ASSERT_EQ(graph.passes.size(), 3u);
    EXPECT_EQ(std::get<double>(graph.passes[1].properties[2].second), 1.5);
    EXPECT_EQ(graph.edges[1].to.text(), "ao.tracer");
    EXPECT_EQ(saveGraph(graph), canonical);
}

TEST(GraphDocument, WhatTheSceneGainsIsReadCheckedAndSaved) {
    const std::string block =
        R"({ "source": "a.glb", "camera": { "eye": [0, 2, 0], "target": [1, 2, 0], "fov": 60 }, )"
        R"("lights": [{ "kind": "directional", "direction": [0, -1, 0], "intensity": 3 }], )"
        R"("animation": "walk", "time": 1.5, "fps": 30 })";
    const std::string text = "{\n  \"kestrel\": 1,\n  \"scene\": " + block +
                             ",\n  \"passes\": {},\n  \"edges\": [],\n  \"outputs\": []\n}\n";
    const Graph graph = parseGraph(text, "g.json");
    ASSERT_TRUE(graph.sceneSetup.camera);
    EXPECT_EQ(graph.sceneSetup.camera->target, glm::dvec3(1, 2, 0));
    EXPECT_EQ(graph.sceneSetup.lights.size(), 1u);
    EXPECT_EQ(graph.sceneSetup.time, 1.5);
    EXPECT_EQ(saveGraph(graph), text);
    EXPECT_EQ(
        messageOf([] {
            parseGraph(R"({"kestrel": 1, "passes": {}, "scene": {
"camera": {"eye": [0, 2], "tagret": [1, 2, 0]},
"lights": [{"kind": "spot"}, {"kind": "pont"}],
"camrea": 3, "fps": 0}})",
                       "g.json");
        }),
        "g.json:2:19: 'eye' must be three numbers from -1000000000 to 1000000000\n"
        "g.json:2:27: the camera has no key 'tagret' (did you mean 'target'?)\n"
        "g.json:3:12: a spot light needs 'position'\n"
        "g.json:3:12: a spot light needs 'direction'\n"
        "g.json:3:39: the kind of a light must be one of point, spot, directional, rectangle, sphere, not "
        "'pont' (did you mean 'point'?)\n"
        "g.json:4:21: 'fps' must be more than 0 and less than 1000000, not 0\n"
        "g.json:4:1: the scene has no key 'camrea' (did you mean 'camera'?)");
}

TEST(GraphDocument, AnyLayoutSavesToOneText) {
    const Graph loose =
        parseGraph(R"({"outputs":[], "passes":{"a":{"properties":{"x":1e3,"y":2.0},"type":"T"}},
        "edges":[], "kestrel":1})",
                   "g.json");
    const std::string saved = saveGraph(loose);
    EXPECT_EQ(saved, "{\n  \"kestrel\": 1,\n  \"passes\": {\n    \"a\": { \"type\": \"T\", \"properties\": "
                     "{ \"x\": 1000.0, \"y\": 2.0 } }\n  },\n  \"edges\": [],\n  \"outputs\": []\n}\n");
    EXPECT_EQ(saveGraph(parseGraph(saved, "g.json")), saved);
}

TEST(GraphDocument, EveryMistakeOfFormComesAtOnceWithItsPlace) {
    const std::string message = messageOf([] {
        parseGraph(R"({ "kestrel": 2,
  "nmae": "x",
  "scene": { "source": 7 },
  "passes": {
    "a": { "typ": "T", "properties": { "x": null, "y": [[1]] }, "position": [1] },
    "b": 3
  },
  "edges": [["a.x"], ["a.x", "b"], ["a.x", 7], "a.x"],
  "outputs": ["a.x.y", ".x"]
})",
                   "g.json");
    });
    EXPECT_EQ(message,
              "g.json:1:14: 'kestrel' (the version of the format) must be 1, not 2\n"
              "g.json:3:24: 'source' of the scene must be a string, not a whole number\n"
              "g.json:5:10: pass 'a' needs 'type'\n"
              "g.json:5:45: property 'x' of pass 'a' must be true or false, a number, a string or an array "
              "of up to 4 numbers, not null\n"
              "g.json:5:56: property 'y' of pass 'a' must be true or false, a number, a string or an array "
              "of up to 4 numbers, not another array\n"
              "g.json:5:77: 'position' of pass 'a' must be an array of two numbers\n"
              "g.json:5:12: pass 'a' has no key 'typ' (did you mean 'type'?)\n"
              "g.json:6:10: pass 'b' must be an object, not a whole number\n"
              "g.json:8:13: an edge must be an array of two strings, [\"pass.output\", \"pass.input\"], and "
              "where it bends on the canvas a list of points\n"
              "g.json:8:30: the end of an edge must be \"pass.port\", not 'b'\n"
              "g.json:8:44: the end of an edge must be a string \"pass.port\", not a whole number\n"
              "g.json:8:48: an edge must be an array of two strings, [\"pass.output\", \"pass.input\"], and "
              "where it bends on the canvas a list of points\n"
              "g.json:9:15: an output must be \"pass.port\", not 'a.x.y'\n"
              "g.json:9:24: an output must be \"pass.port\", not '.x'\n"
              "g.json:2:3: the graph has no key 'nmae' (did you mean 'name'?)");
}

TEST(GraphDocument, RefusesWhatIsTooMuch) {
    std::string passes, edges;
    for (size_t i = 0; i <= maxGraphPasses; ++i)
        passes += (i > 0 ? "," : "") + ("\"p" + std::to_string(i) + "\":{\"type\":\"T\"}");
    for (size_t i = 0; i <= maxGraphEdges; ++i) edges += i > 0 ? ",[\"a.b\",\"c.d\"]" : "[\"a.b\",\"c.d\"]";
    EXPECT_EQ(messageOf([&] { parseGraph("{\"kestrel\":1,\"passes\":{" + passes + "}}", "g.json"); }),
              "g.json:1:23: 10001 passes; at most 10000 are read");
    EXPECT_EQ(
        messageOf([&] { parseGraph("{\"kestrel\":1,\"passes\":{},\"edges\":[" + edges + "]}", "g.json"); }),
        "g.json:1:34: 100001 edges; at most 100000 are read");
    EXPECT_EQ(messageOf([&] {
                  parseGraph(fmt::format(R"({{"kestrel":1,"passes":{{}},"name":"{:x>70000}"}})", ""),
                             "g.json");
              }),
              "g.json:1:33: a text of 70000 bytes; at most 65536 are read");
}

// As many passes, frames and variables as may be, each named by others: whoever searches lists for names
// never ends.
TEST(GraphDocument, NamesAreFoundAtOnceHoweverManyThereAre) {
    std::string variables, passes, named;
    for (size_t i = 0; i < maxGraphPasses; ++i) {
        const char* joint = i > 0 ? "," : "";
        variables += fmt::format("{}\"v{}\":1", joint, i);
        passes += fmt::format(
            "{}\"p{}\":{{\"type\":\"T\",\"properties\":{{\"x\":{{\"variable\":\"v{}\"}}}}}}", joint, i, i);
        named += fmt::format("{}\"p{}\"", joint, maxGraphPasses - 1 - i);
    }
    std::string frames;
    for (int i = 0; i < 50; ++i)
        frames += fmt::format("{}{{\"title\":\"f\",\"passes\":[{}]}}", i > 0 ? "," : "", named);
    const Graph graph =
        parseGraph(fmt::format(R"({{"kestrel":1,"variables":{{{}}},"passes":{{{}}},"frames":[{}]}})",
                               variables, passes, frames),
                   "g.json");
    EXPECT_EQ(graph.frames.back().passes.size(), maxGraphPasses);
    EXPECT_EQ(graph.passes.back().bound.at("x"), "v9999");
}

// ---- validation and settings against a small table of types

enum class Method { Fast, Exact };
class Blur final : public Pass {
public:
    int radius = 2;
    float sigma = 0.1f;
    bool wide = false;
    Method method = Method::Exact;
    std::string note;
    glm::vec3 tint{1, 1, 1};
    Declaration declare(const World&, const Inputs&, const Demand&) const override { return {}; }
    void execute(const Step&, Commands&) override {}
};

Registry smallRegistry() {
    Registry registry;
    registry.add(mockType("Source", {out("colour"), out("tracer", PortKind::Tracer), internal("scratch")},
                          simple({}, {"colour"})));
    registry.add(Describe<Blur>("Blur", "Blurs")
                     .input("image", PortKind::Texture, "What to blur")
                     .optionalInput("tracer", PortKind::Tracer, "What to trace")
                     .output("result", PortKind::Texture, "The blurred image")
                     .number("radius", &Blur::radius, 1, 8, "pixels", "How far")
                     .number("sigma", &Blur::sigma, 0, 1, "", "How soft")
                     .flag("wide", &Blur::wide, "Twice as far")
                     .choice("method", &Blur::method, {"fast", "exact"}, "How")
                     .text("note", &Blur::note, "Whatever")
                     .vector("tint", &Blur::tint, 0, 1, "", "Colour"));
    return registry;
}

std::string validated(const std::string& passes, const std::string& edges, const std::string& outputs) {
    const Registry registry = smallRegistry();
    const Graph graph = parseGraph("{ \"kestrel\": 1, \"passes\": {\n" + passes + "\n}, \"edges\": [\n" +
                                       edges + "\n], \"outputs\": [\n" + outputs + "\n] }",
                                   "g");
    std::string text;
    for (const Problem& problem : validate(graph, registry)) text += problem.text() + "\n";
    return text;
}

TEST(GraphValidate, AcceptsAGoodGraph) {
    EXPECT_EQ(validated(R"("s": {"type": "Source"}, "b": {"type": "Blur", "properties": {"radius": 8,
              "sigma": 1, "wide": true, "method": "fast", "note": "x", "tint": [0, 1, 0.5]}})",
                        R"(["s.colour", "b.image"], ["s.tracer", "b.tracer"])", R"("b.result")"),
              "");
}

TEST(GraphValidate, NamesEachMistakeInTheOrderOfTheFile) {
    EXPECT_EQ(
        validated(R"("S": {"type": "Source"},
"b": {"type": "Blurr"},
"c": {"type": "Blur", "properties": {"radus": 1, "radius": 9, "sigma": "x",
 "wide": 1, "method": "exakt", "tint": [1, 2]}})",
                  R"(["S.color", "c.image"],
["other.x", "c.image"],
["S.colour", "c.tracer"],
["c.image", "c.result"],
["S.scratch", "c.picture"])",
                  R"("c.result",
"c.result",
"S.tracer",
"S.scratch",
"c.image",
"every.x")"),
        "g:2:1: the pass name 'S' must be lower_case letters, digits and single underscores, at most 64, "
        "and begin with a letter\n"
        "g:3:1: pass 'b' has the unknown type 'Blurr' (did you mean 'Blur'?)\n"
        "g:4:38: pass 'c' (Blur) has no property 'radus' (did you mean 'radius'?)\n"
        "g:4:50: property 'radius' of pass 'c' must be from 1 to 8 pixels, not 9\n"
        "g:4:63: property 'sigma' of pass 'c' must be a number, not a string\n"
        "g:5:2: property 'wide' of pass 'c' must be true or false, not a whole number\n"
        "g:5:13: property 'method' of pass 'c' must be one of fast, exact, not 'exakt' (did you mean "
        "'exact'?)\n"
        "g:5:32: property 'tint' of pass 'c' must be an array of 3 numbers, not of 2\n"
        "g:7:2: pass 'S' (Source) has no output 'color' (did you mean 'colour'?)\n"
        "g:8:1: the input 'c.image' is connected twice ('S.color' feeds it already)\n"
        "g:8:2: there is no pass 'other' (in 'other.x')\n"
        "g:9:1: a texture cannot feed a tracer port: 'S.colour' -> 'c.tracer'\n"
        "g:10:2: 'c.image' is an input; an output is needed here\n"
        "g:10:13: 'c.result' is an output; an input is needed here\n"
        "g:11:2: 'S.scratch' is internal to its pass; an output is needed here\n"
        "g:11:15: pass 'c' (Blur) has no input 'picture'\n"
        "g:14:1: the output 'c.result' stands twice\n"
        "g:15:1: 'S.tracer' is a tracer module; only textures and buffers can be outputs\n"
        "g:16:1: 'S.scratch' is internal to its pass; an output is needed here\n"
        "g:17:1: 'c.image' is an input; an output is needed here\n"
        "g:18:1: there is no pass 'every' (in 'every.x')\n");
}

TEST(GraphValidate, NamesUnconnectedInputsAndCyclesWithTheirPath) {
    EXPECT_EQ(validated(R"("a": {"type": "Blur"}, "b": {"type": "Blur"}, "c": {"type": "Blur"},
"d": {"type": "Blur"}, "e": {"type": "Blur"})",
                        R"(["a.result", "b.image"], ["b.result", "c.image"],
["c.result", "a.image"],
["d.result", "d.image"])",
                        ""),
              "g:3:24: the input 'e.image' (texture) is not connected\n"
              "g:6:1: the edges form a cycle: a.result -> b.result -> c.result -> a.result\n"
              "g:7:1: the edges form a cycle: d.result -> d.result\n");
}

TEST(GraphValidate, ALongCycleIsShortened) {
    std::string passes, edges;
    for (int i = 0; i < 500; ++i) {
        passes += fmt::format("{}\"p{}\": {{ \"type\": \"Blur\" }}", i > 0 ? "," : "", i);
        edges += fmt::format("{}[\"p{}.result\", \"p{}.image\"]", i > 0 ? "," : "", i, (i + 1) % 500);
    }
    const std::string text = validated(passes, edges, "\"p0.result\"");
    EXPECT_THAT(text, testing::HasSubstr("the edges form a cycle: p0.result -> p1.result -> p2.result"));
    EXPECT_THAT(text, testing::HasSubstr("p99.result -> (399 more) -> p499.result -> p0.result"));
}

TEST(GraphValidate, MistakesWithoutEndAreToldToAnEnd) {
    std::string passes, edges;
    for (size_t i = 0; i < maxGraphPasses; ++i)
        passes += fmt::format("{}\"p{}\": {{ \"type\": \"Blur\" }}", i > 0 ? "," : "", i);
    for (size_t i = 0; i < maxGraphEdges; ++i)
        edges += fmt::format("{}[\"q{}.x\", \"r.x\"]", i > 0 ? "," : "", i);
    const std::string text = validated(passes, edges, "");
    EXPECT_THAT(text, testing::HasSubstr("has more than 1000 mistakes; these are the first"));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1001);
}

TEST(GraphValidate, PassNamesBecomeFileNames) {
    for (const char* name : {"", "a__b", "a_", "_a", "1a", "ä", "a/b", "a b"})
        EXPECT_FALSE(isGraphName(name)) << name;
    for (const char* name : {"a", "a_b", "a1", "gbuffer"}) EXPECT_TRUE(isGraphName(name)) << name;
    EXPECT_FALSE(isGraphName(std::string(65, 'a')));
}

TEST(GraphSetting, SetsPropertiesByTheirKindAndMovesEdges) {
    const Registry registry = smallRegistry();
    Graph graph = parseGraph(R"({"kestrel": 1, "passes": {"s": {"type": "Source"}, "t": {"type": "Source"},
        "b": {"type": "Blur", "properties": {"radius": 1}}}, "edges": [["s.colour", "b.image"]]})",
                             "g");
    for (const char* setting : {"b.radius=4", "b.sigma=0.5", "b.wide=true", "b.method=fast", "b.note=a=b",
                                "b.tint=[1, 0,0.5]", "b.image=t.colour", "b.tracer=s.tracer"})
        applySetting(graph, registry, setting);
    EXPECT_THAT(
        saveGraph(graph),
        testing::HasSubstr(R"("b": { "type": "Blur", "properties": { "radius": 4, "sigma": 0.5, "wide": )"
                           R"(true, "method": "fast", "note": "a=b", "tint": [1, 0, 0.5] } })"));
    ASSERT_EQ(graph.edges.size(), 2u);
    EXPECT_EQ(graph.edges[0].from.text(), "t.colour");
    EXPECT_EQ(graph.edges[1].to.text(), "b.tracer");
    EXPECT_TRUE(validate(graph, registry).empty());
    applySetting(graph, registry, "b.tracer=");
    EXPECT_EQ(graph.edges.size(), 1u);

    const PassSet passes = makePasses(graph, registry);
    const auto& blur = dynamic_cast<const Blur&>(*passes.at("b"));
    EXPECT_EQ(blur.radius, 4);
    EXPECT_EQ(blur.sigma, 0.5f);
    EXPECT_TRUE(blur.wide);
    EXPECT_EQ(blur.method, Method::Fast);
    EXPECT_EQ(blur.tint, glm::vec3(1, 0, 0.5f));
}

const char* withVariables = R"({
  "kestrel": 1,
  "variables": { "reach": 3, "soft": 0.5, "unused": "x" },
  "passes": {
    "s": { "type": "Source" },
    "near": { "type": "Blur", "properties": { "radius": { "variable": "reach" }, "sigma": { "variable": "soft" } } },
    "far": { "type": "Blur", "properties": { "wide": true, "radius": { "variable": "reach" } }, "muted": true, )"
                            R"("position": [1, 2] }
  },
  "edges": [
    ["s.colour", "near.image", [[10, 20], [30.5, -4]]],
    ["near.result", "far.image"]
  ],
  "outputs": ["far.result"],
  "frames": [
    { "title": "Blurs", "passes": ["near", "far"] }
  ],
  "notes": [
    { "text": "Both \"the same\"", "position": [0, -50] }
  ]
}
)";

TEST(GraphVariables, AreReadFollowedAndSavedToTheByte) {
    const Registry registry = smallRegistry();
    Graph graph = parseGraph(withVariables, "g.json");
    EXPECT_EQ(saveGraph(graph), withVariables);
    EXPECT_TRUE(validate(graph, registry).empty());
    EXPECT_TRUE(graph.passes[2].muted);
    EXPECT_EQ(graph.edges[0].bends, (std::vector<glm::dvec2>{{10, 20}, {30.5, -4}}));
    EXPECT_EQ(graph.frames[0].passes, (std::vector<std::string>{"near", "far"}));

    applySetting(graph, registry, "reach=7");
    const PassSet passes = makePasses(graph, registry);
    EXPECT_EQ(dynamic_cast<const Blur&>(*passes.at("near")).radius, 7);
    EXPECT_EQ(dynamic_cast<const Blur&>(*passes.at("far")).radius, 7);
    // A value of its own leaves the variable to the others.
    applySetting(graph, registry, "far.radius=2");
    applySetting(graph, registry, "reach=4");
    EXPECT_EQ(std::get<std::int64_t>(graph.find("near")->properties[0].second), 4);
    EXPECT_EQ(std::get<std::int64_t>(graph.find("far")->properties[1].second), 2);
    EXPECT_THAT(saveGraph(graph), testing::HasSubstr(R"("far": { "type": "Blur", "properties": { "wide": )"
                                                     R"(true, "radius": 2 }, "muted": true,)"));
    EXPECT_EQ(messageOf([&] { applySetting(graph, registry, "reach=99"); }),
              "--set reach=99: property 'radius' of pass 'near' must be from 1 to 8 pixels, not 99");
    EXPECT_EQ(messageOf([&] { applySetting(graph, registry, "recah=1"); }),
              "--set recah=1: the graph has no variable 'recah' (did you mean 'reach'?)");
    EXPECT_EQ(messageOf([&] { applySetting(graph, registry, "unused=1"); }),
              "--set unused=1: no property follows the variable 'unused'");
}

TEST(GraphVariables, EveryMistakeOfTheCanvasAndOfVariablesHasItsPlace) {
    EXPECT_EQ(
        messageOf([] {
            parseGraph(R"({ "kestrel": 1, "variables": { "A": 1, "b": null, "reach": 2 }, "passes": {
"p": { "type": "T", "properties": { "x": { "variable": "raech" }, "y": { "var": 1 } }, "muted": 1 } },
"edges": [["p.a", "p.b", 3], ["p.a", "p.b", [[1]]], ["p.a", "p.b", [], 1]],
"frames": [{ "title": "f", "passes": ["q", 1] }, { "titel": "f", "passes": [] }],
"notes": [{ "text": "n", "position": [1, 2, 3] }] })",
                       "g");
        }),
        "g:1:32: the variable name 'A' must be like that of a pass: lower_case letters, digits and single "
        "underscores\n"
        "g:1:45: variable 'b' must be true or false, a number, a string or an array of up to 4 numbers, "
        "not null\n"
        "g:2:56: property 'x' of pass 'p' follows the variable 'raech', which the graph has not (did you "
        "mean 'reach'?)\n"
        "g:2:72: property 'y' of pass 'p' needs 'variable'\n"
        "g:2:74: property 'y' of pass 'p' has no key 'var'\n"
        "g:2:97: 'muted' of pass 'p' must be true or false, not a whole number\n"
        "g:3:26: the bends of an edge must be an array of points\n"
        "g:3:46: a bend of an edge must be an array of two numbers\n"
        "g:3:53: an edge must be an array of two strings, [\"pass.output\", \"pass.input\"], and where it "
        "bends on the canvas a list of points\n"
        "g:4:39: there is no pass 'q' (in frame 'f') (did you mean 'p'?)\n"
        "g:4:44: a pass of a frame must be a string, not a whole number\n"
        "g:4:50: a frame needs 'title'\n"
        "g:4:52: a frame has no key 'titel' (did you mean 'title'?)\n"
        "g:5:38: 'position' of a note must be an array of two numbers");
}

TEST(GraphSetting, RefusesWithASentence) {
    const Registry registry = smallRegistry();
    Graph graph = parseGraph(
        R"({"kestrel": 1, "passes": {"s": {"type": "Source"}, "blur": {"type": "Blur"}, "n": {"type": "None"}}})",
        "g");
    const auto refused = [&](const std::string& setting) {
        const std::string message = messageOf([&] { applySetting(graph, registry, setting); });
        const std::string place = "--set " + setting + ": ";
        EXPECT_TRUE(message.starts_with(place)) << message;
        return message.substr(std::min(place.size(), message.size()));
    };
    const std::string forms =
        "must be pass.property=value, variable=value, pass.input=pass.output or pass.input=";
    EXPECT_EQ(refused("blur.radius"), forms);
    EXPECT_EQ(refused("Radius=1"), forms);
    EXPECT_EQ(refused("radius=1"), "the graph has no variable 'radius'");
    EXPECT_EQ(refused("blurr.radius=1"), "there is no pass 'blurr' (did you mean 'blur'?)");
    EXPECT_EQ(refused("n.x=1"), "pass 'n' has the unknown type 'None'");
    EXPECT_EQ(refused("blur.radios=1"),
              "pass 'blur' (Blur) has no property or input 'radios' (did you mean 'radius'?)");
    EXPECT_EQ(refused("blur.result=s.colour"),
              "'blur.result' is an output; only properties and inputs can be set");
    EXPECT_EQ(refused("s.scratch=1"), "'s.scratch' is internal; only properties and inputs can be set");
    EXPECT_EQ(refused("blur.radius=1.5"),
              "property 'radius' of pass 'blur' must be a whole number, not '1.5'");
    EXPECT_EQ(refused("blur.radius=99"),
              "property 'radius' of pass 'blur' must be from 1 to 8 pixels, not 99");
    EXPECT_EQ(refused("blur.wide=1"), "property 'wide' of pass 'blur' must be true or false, not '1'");
    EXPECT_EQ(refused("blur.sigma=nan"), "property 'sigma' of pass 'blur' must be from 0 to 1, not nan");
    EXPECT_EQ(refused("blur.sigma="), "property 'sigma' of pass 'blur' must be a number, not ''");
    EXPECT_EQ(
        refused("blur.method=exat"),
        "property 'method' of pass 'blur' must be one of fast, exact, not 'exat' (did you mean 'exact'?)");
    EXPECT_EQ(refused("blur.tint=1,2"),
              "property 'tint' of pass 'blur' must be an array of 3 numbers, not of 2");
    EXPECT_EQ(refused("blur.tint=1,,2"),
              "property 'tint' of pass 'blur' must be an array of 3 numbers, not '1,,2'");
    EXPECT_EQ(refused("blur.image=colour"), "an input is fed by \"pass.output\", not by 'colour'");
    EXPECT_EQ(refused("blur.image=other.colour"), "there is no pass 'other'");
    EXPECT_EQ(refused("blur.image=s.color"),
              "pass 's' (Source) has no output 'color' (did you mean 'colour'?)");
    EXPECT_EQ(refused("blur.image=s.tracer"),
              "a tracer cannot feed a texture port: 's.tracer' -> 'blur.image'");
    EXPECT_TRUE(graph.edges.empty());
}

TEST(Registry, RefusesNamesTakenTwiceAndBadDefaults) {
    Registry registry = smallRegistry();
    PassType twin = mockType("Blur", {out("x")}, simple({}, {"x"}));
    twin.plugin = "twin.so";
    EXPECT_EQ(messageOf([&] { registry.add(twin); }),
              "pass type 'Blur' of plugin 'twin.so': the name is taken by Kestrel itself");
    PassType bad = mockType("Bad", {out("x"), in("x"), in("Y")}, simple({}, {"x"}));
    PropertyInfo property;
    property.name = "amount";
    property.maximum = 1;
    property.defaultValue = 2.0;
    bad.properties.push_back(property);
    EXPECT_EQ(
        messageOf([&] { registry.add(bad); }),
        "pass type 'Bad' of Kestrel itself: 'x' occurs twice among its ports and properties\n"
        "pass type 'Bad' of Kestrel itself: the port name 'Y' is not lower_case letters, digits and single "
        "underscores\n"
        "pass type 'Bad' of Kestrel itself: the default of 'amount' must be at most 1, not 2");
    EXPECT_THAT(registry.names(), ElementsAre("Blur", "Source"));
}

} // namespace
} // namespace kestrel
