#include "core/files.h"
#include "core/json.h"
#include "graph/report.h"
#include "graph_mock.h"
#include "support/folders.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using namespace test;
using testing::HasSubstr;

enum class Mode { One, Two };
class Tuned final : public Pass {
public:
    int count = 4;
    float amount = 0.1f;
    bool on = true;
    Mode mode = Mode::Two;
    std::string label = "a \"b\"";
    glm::vec2 offset{0.5f, 0};
    Declaration declare(const World&, const Inputs& in, const Demand& demand) const override {
        return simple({"x"}, {"r"})({}, in, demand);
    }
    void execute(const Step&, Commands&) override {}
};

Registry reportRegistry() {
    Registry registry;
    registry.add(mockType("Source", {out("a"), out("b")}, simple({}, {"a", "b"})));
    PassType tuned =
        Describe<Tuned>("Tuned", "Does something")
            .optionalInput("x", PortKind::Texture, "What to change")
            .output("r", PortKind::Texture, "The change")
            .number("count", &Tuned::count, 1, 9, "times", "How often")
            .number("amount", &Tuned::amount, 0, std::numeric_limits<double>::infinity(), "", "How much")
            .flag("on", &Tuned::on, "Whether")
            .choice("mode", &Tuned::mode, {"one", "two"}, "Which")
            .text("label", &Tuned::label, "Name")
            .vector("offset", &Tuned::offset, -1, 1, "", "Where");
    tuned.plugin = "tuned.so";
    registry.add(tuned);
    return registry;
}

const std::string text =
    R"({"kestrel": 1, "name": "A \"graph\"", "passes": {"s": {"type": "Source"}, "t": {"type": "Tuned"},
    "rival": {"type": "Tuned"}, "u": {"type": "Tuned"}},
    "edges": [["s.a", "t.x"], ["s.a", "rival.x"], ["t.r", "u.x"]], "outputs": ["u.r"]})";

TEST(Report, APlanAsText) {
    EXPECT_EQ(planText(compileText(text, reportRegistry())),
              R"(size: 640x360
order: 3 passes, 3 steps, 1 programs
  s (Source)
    only  [mock.comp]  after barrier ShaderImage
  t (Tuned)
    only  [mock.comp]  after barrier TextureFetch
  u (Tuned)
    only  [mock.comp]  after barrier TextureFetch
resources: 3 in 3 objects
  object 0: rgba16f 16x16, 2048 bytes
    s.a: steps 0 to 1
  object 1: rgba16f 16x16, 2048 bytes
    u.r: persistent
  object 2: rgba16f 16x16, 2048 bytes
    t.r: steps 1 to 2
memory: 4 KiB shared by lifetime (unshared 4 KiB), 2 KiB that stays
left out: s.b, because nobody reads it
left out: rival, because nobody reads 'rival.r'
)");
}

TEST(Report, APlanAsJson) {
    const Json json = Json::parse(planJson(compileText(text, reportRegistry())), "plan");
    EXPECT_EQ(json.find("passes")->items.size(), 3u);
    EXPECT_EQ(json.find("left_out")->items[1].find("why")->text, "nobody reads 'rival.r'");
    EXPECT_EQ(json.find("memory")->find("transient")->integer, 4096);
    EXPECT_EQ(json.find("passes")->items[1].find("steps")->items[0].text, "only");
    const Json& step = json.find("steps")->items[1];
    EXPECT_EQ(step.find("pass")->text, "t");
    EXPECT_EQ(step.find("barrier")->text, "TextureFetch");
    EXPECT_EQ(step.find("bindings")->items[0].find("name")->text, "x");
    EXPECT_EQ(json.find("programs")->items[0].find("files")->items[0].text, "mock.comp");
    EXPECT_EQ(planJson(compileText(text, reportRegistry())), planJson(compileText(text, reportRegistry())));
}

TEST(Report, NothingLeftOutIsSaidToo) {
    CompileOptions keep;
    keep.keepAll = true;
    EXPECT_THAT(planText(compileText(text, reportRegistry(), keep)),
                testing::EndsWith("left out: nothing\n"));
}

TEST(Report, AGraphForGraphviz) {
    const Registry registry = reportRegistry();
    const Graph graph = parseGraph(text, "g.json");
    const Plan plan = compile(graph, registry, makePasses(graph, registry), {});
    const std::string dot = dotText(graph, registry, &plan);
    EXPECT_THAT(dot, HasSubstr("digraph \"A \\\"graph\\\"\" {"));
    EXPECT_THAT(dot, HasSubstr("\"t\" [label=\"t\\nTuned\"];"));
    EXPECT_THAT(dot, HasSubstr("\"rival\" [label=\"rival\\nTuned\", color=gray70, fontcolor=gray70, "
                               "style=\"rounded,dashed\", tooltip=\"left out: nobody reads 'rival.r'\"];"));
    EXPECT_THAT(dot, HasSubstr("\"s\" -> \"t\" [label=\"a → x\"];"));
    EXPECT_THAT(dot, HasSubstr("\"s\" -> \"rival\" [label=\"a → x\", color=gray70, fontcolor=gray70];"));
    EXPECT_THAT(dot, HasSubstr("\"u\" -> \"output u.r\";"));
    EXPECT_THAT(dotText(graph, registry, nullptr), HasSubstr("\"rival\" [label=\"rival\\nTuned\"];"));
}

TEST(Report, PassTypesAsTextAndJson) {
    const Registry registry = reportRegistry();
    EXPECT_EQ(passListText(registry), "Source  A pass for tests\nTuned   Does something\n");
    EXPECT_EQ(passTypeText(*registry.find("Tuned")), R"(Tuned: Does something
  from tuned.so
  input x (texture, optional): What to change
  output r (texture): The change
  property count = 4 (int 1 to 9 times): How often
  property amount = 0.1 (float at least 0): How much
  property on = true (bool): Whether
  property mode = "two" (one | two): Which
  property label = "a \"b\"" (text): Name
  property offset = [0.5, 0] (vector2 -1 to 1): Where
)");
    const Json json = Json::parse(passesJson({registry.find("Source"), registry.find("Tuned")}), "passes");
    const Json& tuned = json.find("passes")->items[1];
    EXPECT_EQ(tuned.find("plugin")->text, "tuned.so");
    EXPECT_EQ(tuned.find("ports")->items[0].find("kind")->text, "texture");
    const Json& amount = tuned.find("properties")->items[1];
    EXPECT_EQ(amount.find("default")->number, 0.1);
    EXPECT_EQ(amount.find("maximum"), nullptr);
}

TEST(Report, TheSchemaComesFromTheTables) {
    const Json schema = Json::parse(graphSchema(reportRegistry()), "schema");
    EXPECT_EQ(schema.find("$schema")->text, "https://json-schema.org/draft/2020-12/schema");
    ASSERT_EQ(schema.find("required")->items.size(), 2u);
    const Json* definitions = schema.find("$defs");
    const Json* pass = definitions->find("pass");
    EXPECT_EQ(pass->find("required")->items[0].text, "type");
    EXPECT_EQ(pass->find("properties")->find("type")->find("enum")->items[1].text, "Tuned");
    EXPECT_EQ(pass->find("allOf")
                  ->items[1]
                  .find("then")
                  ->find("properties")
                  ->find("properties")
                  ->find("$ref")
                  ->text,
              "#/$defs/Tuned");
    const Json* properties = definitions->find("Tuned")->find("properties");
    // A value, or a variable that the property follows.
    const auto valueOf = [&](const char* name) { return &properties->find(name)->find("anyOf")->items[0]; };
    EXPECT_EQ(properties->find("count")->find("anyOf")->items[1].find("$ref")->text, "#/$defs/follows");
    EXPECT_EQ(valueOf("count")->find("type")->text, "integer");
    EXPECT_EQ(valueOf("count")->find("maximum")->integer, 9);
    EXPECT_EQ(properties->find("count")->find("description")->text, "How often (times)");
    EXPECT_EQ(valueOf("mode")->find("enum")->items[0].text, "one");
    EXPECT_EQ(valueOf("offset")->find("minItems")->integer, 2);
    EXPECT_EQ(properties->find("label")->find("default")->text, "a \"b\"");
    EXPECT_FALSE(definitions->find("Tuned")->find("additionalProperties")->boolean);
}

TEST(Report, ShippedGraphsAreInCanonicalForm) {
    int seen = 0;
    for (const auto& entry : std::filesystem::directory_iterator(test::sourceFolder() / "graphs")) {
        if (entry.path().extension() != ".json" || entry.path().filename() == "schema.json") continue;
        EXPECT_EQ(saveGraph(loadGraph(entry.path())), readText(entry.path())) << entry.path();
        ++seen;
    }
    EXPECT_GT(seen, 0);
}

} // namespace
} // namespace kestrel
