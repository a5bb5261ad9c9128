// What a fact leaves out of a pass, found by asking it.
#include "core/json.h"
#include "graph/fact_effects.h"
#include "graph_mock.h"
#include "scene/fact_list.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

// Makes its picture of the emission of the scene, of its textures or of nothing; with a switch that asks for
// vertex colours.
class Emissive final : public Pass {
public:
    bool colours = false;
    Declaration declare(const World& world, const Inputs&, const Demand&) const override {
        Declaration declaration;
        declaration.outputs.push_back(output("x"));
        declaration.depends = Causes::Geometry | Causes::Properties;
        if (!world.facts.hasEmission) {
            declaration.outputs.back().constant = glm::vec4(0);
            declaration.leftOut.push_back({"light", "nothing shines"});
            return declaration;
        }
        Step draw = step("draw", {writes("x")});
        if (world.facts.hasTextures) draw.defines.emplace("TEXTURES", "1");
        if (colours && world.facts.hasVertexColours) draw.defines.emplace("COLOURS", "1");
        declaration.steps.push_back(draw);
        return declaration;
    }
    void execute(const Step&, Commands&) override {}
};

Registry factRegistry() {
    Registry registry;
    registry.add(Describe<Emissive>("Emissive", "Of the emission")
                     .output("x", PortKind::Texture, "Light")
                     .flag("colours", &Emissive::colours, "Of the vertices"));
    registry.add(
        mockType("Reader", {in("x"), out("y")}, [](const World&, const Inputs& inputs, const Demand&) {
            Declaration declaration;
            declaration.outputs.push_back(output("y"));
            if (inputs["x"].constant)
                declaration.outputs.back().constant = glm::vec4(0);
            else
                declaration.steps.push_back(step("read", {reads("x"), writes("y")}));
            return declaration;
        }));
    return registry;
}

std::vector<FactEffect> effectsOf(const std::string& graph) {
    const Registry registry = factRegistry();
    const Graph parsed = parseGraph(graph, "g.json");
    return factEffects(registry, std::span(&parsed, 1));
}

const std::string pairText =
    R"({"kestrel": 1, "passes": {"e": {"type": "Emissive"}, "r": {"type": "Reader"}}, "edges": [["e.x", "r.x"]],
        "outputs": ["r.y"]})";

const FactEffect* effectOf(const std::vector<FactEffect>& effects, std::string_view fact,
                           std::string_view pass) {
    for (const FactEffect& effect : effects)
        if (effect.fact == fact && effect.pass == pass) return &effect;
    return nullptr;
}

TEST(Facts, AreFoundByWhatIsDeclaredLess) {
    const std::vector<FactEffect> effects = effectsOf(pairText);
    const FactEffect* dark = effectOf(effects, "no emission", "Emissive");
    ASSERT_NE(dark, nullptr);
    EXPECT_TRUE(dark->nothingRuns);
    EXPECT_THAT(dark->steps, ElementsAre("draw"));
    EXPECT_THAT(dark->constants, ElementsAre("x"));
    EXPECT_EQ(dark->leftOut.at("light"), "nothing shines");
    const FactEffect* plain = effectOf(effects, "no texture", "Emissive");
    ASSERT_NE(plain, nullptr);
    EXPECT_THAT(plain->defines, ElementsAre("TEXTURES"));
    EXPECT_TRUE(plain->isLess() && !plain->nothingRuns && plain->constants.empty());
    EXPECT_EQ(effectOf(effects, "no normal map", "Emissive"), nullptr);
}

TEST(Facts, ReachReadersThroughWhatIsConstant) {
    const std::vector<FactEffect> effects = effectsOf(pairText);
    const FactEffect* reader = effectOf(effects, "no emission", "Reader");
    ASSERT_NE(reader, nullptr);
    EXPECT_TRUE(reader->nothingRuns);
    EXPECT_EQ(effectOf(effects, "no texture", "Reader"), nullptr);
}

TEST(Facts, AreAskedForAtEachSettingOfASwitch) {
    const std::vector<FactEffect> effects = effectsOf(pairText);
    const FactEffect* uncoloured = effectOf(effects, "no vertex colour", "Emissive");
    ASSERT_NE(uncoloured, nullptr);
    EXPECT_THAT(uncoloured->defines, ElementsAre("COLOURS"));
}

TEST(Facts, OfMotionSayWhatRunsOnce) {
    const std::vector<FactEffect> effects = effectsOf(pairText);
    const FactEffect* still = effectOf(effects, "geometry at rest", "Emissive");
    ASSERT_NE(still, nullptr);
    EXPECT_TRUE(still->once);
    EXPECT_EQ(still->causes, Causes::Geometry);
    EXPECT_EQ(effectOf(effects, "cameras at rest", "Emissive"), nullptr);
    EXPECT_TRUE(effectOf(effects, "geometry at rest", "Reader")->once) << "what it reads does not change";
}

TEST(Facts, AsTextTableAndJson) {
    const std::vector<FactEffect> effects = effectsOf(pairText);
    EXPECT_THAT(factsMarkdown(effects),
                HasSubstr("| no triangle; no emission | every step: `Emissive`, `Reader` |\n"));
    EXPECT_THAT(
        factsMarkdown(effects),
        HasSubstr(
            "| geometry at rest; everything at rest | all frames but the first: `Emissive`, `Reader` |\n"));
    EXPECT_THAT(factsMarkdown(effects), HasSubstr("no area light; "));
    EXPECT_THAT(factsMarkdown(effects), HasSubstr(" | nothing |\n"));
    EXPECT_THAT(factsText(effects), HasSubstr("light: nothing shines"));
    const Json json = Json::parse(factsJson(effects), "facts");
    const Json* facts = json.find("facts");
    ASSERT_NE(facts, nullptr);
    const auto found = std::ranges::find_if(
        facts->items, [](const Json& fact) { return fact.find("fact")->text == "no texture"; });
    ASSERT_NE(found, facts->items.end());
    EXPECT_EQ(found->find("passes")->items[0].find("defines")->items[0].text, "TEXTURES");
}

// What the list does not hold could never be told, and --keep-all must promise none of it.
TEST(Facts, OfTheListAreNoneInARichScene) {
    SceneFacts none = richFacts();
    for (const SceneFact& fact : sceneFactList()) fact.hold(none);
    EXPECT_FALSE(none.hasMasked || none.hasBlend || none.hasDoubleSided || none.hasSingleSided);
    EXPECT_FALSE(none.hasTextures || none.hasNormalMaps || none.hasTiledTextures || none.hasVertexColours);
    EXPECT_FALSE(none.hasEmission || none.hasTransmission || none.hasUnlit);
    EXPECT_FALSE(none.geometryMoves || none.geometryDeforms || none.cameraMoves || none.lightsMove);
    EXPECT_EQ(none.triangles + none.lights() + none.wideSpotLights, 0u);
    const SceneFacts kept = withoutPromises(none);
    EXPECT_TRUE(kept.hasMasked && kept.hasBlend && kept.hasDoubleSided && kept.hasSingleSided);
    EXPECT_TRUE(kept.hasTextures && kept.hasNormalMaps && kept.hasVertexColours && kept.hasEmission);
    EXPECT_TRUE(kept.hasTransmission && kept.hasUnlit && kept.geometryMoves && kept.geometryDeforms);
    EXPECT_TRUE(kept.cameraMoves && kept.lightsMove);
}

} // namespace
} // namespace kestrel
