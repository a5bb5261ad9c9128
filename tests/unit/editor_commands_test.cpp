#include "edit/clipboard.h"
#include "edit/fits.h"
#include "edit/layout.h"
#include "edit/properties.h"
#include "edit/search.h"
#include "editor_fixture.h"

namespace kestrel::edit {
namespace {

using namespace test;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class EditorCommands : public testing::Test {
protected:
    const Registry registry = editorRegistry();
    Graph graph = editedGraph();
    void TearDown() override { expectWhole(graph); }
};

TEST_F(EditorCommands, NewPassesHaveNamesOfTheirTypes) {
    EXPECT_EQ(freshName(graph, "RayAmbientOcclusion"), "ray_ambient_occlusion");
    EXPECT_EQ(freshName(graph, "GBuffer"), "gbuffer_2");
    EXPECT_EQ(freshName(graph, "RSMGather"), "rsm_gather");
    EXPECT_EQ(freshName(graph, "TemporalAA"), "temporal_aa");
    EXPECT_EQ(freshName(graph, "9"), "pass");
    EXPECT_EQ(addPass(graph, registry, "Blur", {1, 2}), "blur_2");
    EXPECT_EQ(addPass(graph, registry, "Blur", {1, 2}), "blur_3");
    EXPECT_EQ(freshName(graph, "blur_3"), "blur_4");
    EXPECT_EQ(refusal([&] { addPass(graph, registry, "Blurr", {}); }),
              "there is no pass type 'Blurr' (did you mean 'Blur'?)");
}

TEST_F(EditorCommands, ConnectingReplacesAndRefusesWithASentence) {
    connect(graph, registry, {"bvh", "tracer"}, {"ao", "tracer"});
    EXPECT_EQ(edgesOf(graph)[1], "bvh.tracer -> ao.tracer");
    EXPECT_TRUE(graph.edges[1].bends.empty());
    EXPECT_EQ(graph.edges.size(), 5u);
    EXPECT_EQ(refusal([&] {
                  connect(graph, registry, {"bvh", "tracer"}, {"ao", "depth"});
              }),
              "a tracer cannot feed a texture port");
    EXPECT_EQ(refusal([&] {
                  connect(graph, registry, {"blur", "result"}, {"ao", "depth"});
              }),
              "'blur' needs what 'ao' makes: the edge would close a cycle");
    EXPECT_EQ(refusal([&] {
                  connect(graph, registry, {"blur", "result"}, {"blur", "guide"});
              }),
              "'blur' needs what 'blur' makes: the edge would close a cycle");
    EXPECT_EQ(refusal([&] {
                  connect(graph, registry, {"ao", "depth"}, {"blur", "guide"});
              }),
              "'ao.depth' is no output");
    disconnect(graph, {{"ao", "normal"}, {"blur", "signal"}});
    EXPECT_EQ(graph.edges.size(), 3u);
    EXPECT_EQ(refusal([&] { disconnect(graph, {{"ao", "normal"}}); }), "nothing feeds 'ao.normal'");
}

TEST_F(EditorCommands, DeletingCanReconnect) {
    Graph cut = graph;
    removePasses(cut, registry, {"ao", "roma"}, false);
    EXPECT_THAT(edgesOf(cut), IsEmpty());
    EXPECT_EQ(cut.frames[0].passes, std::vector<std::string>{"map"});

    // ao's visibility is stood in for by its depth: what blurs it, blurs that.
    removePasses(graph, registry, {"ao"}, true);
    EXPECT_THAT(edgesOf(graph),
                ElementsAre("map.occupancy -> roma.occupancy", "gbuffer.depth -> blur.signal"));
    removePasses(graph, registry, {"blur"}, true);
    EXPECT_TRUE(graph.outputs.empty());
    removePasses(graph, registry, {"map", "roma"}, false);
    EXPECT_TRUE(graph.frames.empty());
}

TEST_F(EditorCommands, ANameIsChangedWhereverItStands) {
    renamePass(graph, "roma", "rotated");
    EXPECT_EQ(edgesOf(graph)[1], "rotated.tracer -> ao.tracer");
    EXPECT_EQ(graph.frames[0].passes[1], "rotated");
    renamePass(graph, "blur", "soft");
    EXPECT_EQ(graph.outputs[0].port.text(), "soft.result");
    EXPECT_EQ(refusal([&] { renamePass(graph, "soft", "ao"); }), "there is a pass 'ao' already");
    EXPECT_THAT(refusal([&] { renamePass(graph, "soft", "Soft"); }),
                HasSubstr("'Soft' is no name of a pass"));
    EXPECT_EQ(refusal([&] { renamePass(graph, "sotf", "x"); }),
              "there is no pass 'sotf' (did you mean 'soft'?)");
}

TEST_F(EditorCommands, CopiesKeepTheirEdgesAndOnRequestTheirInputs) {
    EXPECT_THAT(duplicatePasses(graph, {"roma", "ao"}, false, {10, 10}), ElementsAre("roma_2", "ao_2"));
    EXPECT_THAT(edgesOf(graph), Contains("roma_2.tracer -> ao_2.tracer"));
    EXPECT_EQ(graph.edges.size(), 6u);
    EXPECT_EQ(graph.find("ao_2")->position, glm::dvec2(410, 110));
    EXPECT_EQ(graph.find("ao_2")->bound.at("radius"), "reach");
    duplicatePasses(graph, {"ao"}, true, {0, 0});
    EXPECT_THAT(edgesOf(graph), Contains("gbuffer.depth -> ao_3.depth"));
    EXPECT_THAT(edgesOf(graph), Contains("roma.tracer -> ao_3.tracer"));
}

// (1) Copy puts text on the clipboard that pastes anywhere, with inputs kept on request.
TEST_F(EditorCommands, CopiedTextPastesIntoAnyGraph) {
    const std::string text = copyText(graph, {"map", "roma", "ao"}, true);
    EXPECT_NO_THROW(parseGraph(text, "mail"));
    Graph other = parseGraph(R"({"kestrel": 1, "variables": {"reach": 2}, "passes": {"ao": {"type": "Blur"},
        "gbuffer": {"type": "GBuffer"}}})",
                             "o.json");
    const Pasted pasted = pasteText(other, registry, text, {1000, 0});
    EXPECT_THAT(pasted.passes, ElementsAre("map", "roma", "ao_2"));
    EXPECT_THAT(pasted.remarks, IsEmpty());
    EXPECT_THAT(edgesOf(other), ElementsAre("map.occupancy -> roma.occupancy", "roma.tracer -> ao_2.tracer",
                                            "gbuffer.depth -> ao_2.depth", "gbuffer.normal -> ao_2.normal"));
    // Another value under the same name stays apart; the same one is shared.
    EXPECT_EQ(other.find("ao_2")->bound.at("radius"), "reach_2");
    EXPECT_EQ(pasteText(other, registry, text, {}).passes.size(), 3u);
    EXPECT_EQ(other.variables.size(), 2u);
    EXPECT_EQ(other.frames[0].passes, (std::vector<std::string>{"map", "roma"}));
    EXPECT_EQ(other.find("roma")->position, glm::dvec2(1000, 50)); // the middle of the three is (200, 150)
    expectWhole(other);

    Graph empty;
    const Pasted alone = pasteText(empty, registry, text, {});
    EXPECT_THAT(alone.remarks,
                ElementsAre("'ao.depth' is not fed by 'gbuffer.depth': 'gbuffer.depth' is no output",
                            "'ao.normal' is not fed by 'gbuffer.normal': 'gbuffer.normal' is no output"));
    EXPECT_THAT(copyText(graph, {"ao"}, false), Not(HasSubstr("gbuffer")));
    const std::string before = saveGraph(empty);
    EXPECT_THAT(refusal([&] { pasteText(empty, registry, "Dear all", {}); }),
                HasSubstr("the clipboard:1:1: "));
    EXPECT_EQ(saveGraph(empty), before);
}

// (2) A pass dropped on a wire is inserted; wires are cut by a stroke (disconnect of several).
TEST_F(EditorCommands, APassIsPutIntoAWire) {
    const std::string name = addPass(graph, registry, "Blur", {});
    insertOnEdge(graph, registry, {"blur", "signal"}, name);
    EXPECT_THAT(edgesOf(graph), Contains("ao.visibility -> blur_2.signal"));
    EXPECT_THAT(edgesOf(graph), Contains("blur_2.result -> blur.signal"));
    EXPECT_EQ(refusal([&] {
                  insertOnEdge(graph, registry, {"ao", "tracer"}, name);
              }),
              "no free input and output of 'blur_2' fit between 'roma.tracer' and 'ao.tracer'");
    EXPECT_EQ(refusal([&] {
                  insertOnEdge(graph, registry, {"blur", "signal"}, "blur");
              }),
              "the edge is one of 'blur' already");
}

// (3) A wire pulled out of an output or an input is offered what fits; dropped on a pass it takes the one
// port.
TEST_F(EditorCommands, AWireIntoTheEmptyOffersWhatFits) {
    const auto types = [](const std::vector<Offer>& offers) {
        std::vector<std::string> texts;
        for (const Offer& offer : offers) texts.push_back(offer.type + "." + offer.port);
        return texts;
    };
    EXPECT_THAT(types(offersFor(graph, registry, {"bvh", "tracer"})),
                ElementsAre("RayOcclusion.tracer", "WideOcclusion.tracer"));
    EXPECT_THAT(types(offersFor(graph, registry, {"ao", "tracer"})),
                ElementsAre("Bvh.tracer", "Field.tracer", "Roma.tracer"));
    const Offer field{"Field", "tracer", ""};
    EXPECT_EQ(addJoined(graph, registry, {"ao", "tracer"}, field, {}), "field");
    EXPECT_THAT(edgesOf(graph), Contains("field.tracer -> ao.tracer"));
    EXPECT_THAT(edgesOf(graph), Not(Contains("roma.tracer -> ao.tracer")));
    EXPECT_THAT(refusal([&] {
                    offersFor(graph, registry, {"ao", "rays"});
                }),
                HasSubstr("'ao.rays' is no port"));

    EXPECT_EQ(fittingPort(graph, registry, {"bvh", "tracer"}, "ao"), (PortRef{"ao", "tracer"}));
    EXPECT_EQ(fittingPort(graph, registry, {"gbuffer", "normal"}, "ao"),
              (PortRef{"ao", "normal"})); // by name
    EXPECT_EQ(fittingPort(graph, registry, {"gbuffer", "colour"}, "blur"),
              (PortRef{"blur", "guide"})); // the free one
    EXPECT_EQ(fittingPort(graph, registry, {"ao", "depth"}, "gbuffer"), (PortRef{"gbuffer", "depth"}));
    EXPECT_EQ(fittingPort(graph, registry, {"bvh", "tracer"}, "blur"), std::nullopt);
    EXPECT_EQ(fittingPort(graph, registry, {"blur", "signal"}, "gbuffer"), std::nullopt); // three would do
}

// (4) Either end of a wire is moved or copied.
TEST_F(EditorCommands, EitherEndOfAWireMoves) {
    moveEdgeBegin(graph, registry, {"ao", "tracer"}, {"bvh", "tracer"});
    EXPECT_EQ(edgesOf(graph)[1], "bvh.tracer -> ao.tracer");
    const std::string wide = addPass(graph, registry, "WideOcclusion", {});
    moveEdgeEnd(graph, registry, {"ao", "tracer"}, {wide, "tracer"}, true);
    EXPECT_EQ(graph.edges.size(), 6u);
    moveEdgeEnd(graph, registry, {"ao", "depth"}, {wide, "depth"}, false);
    EXPECT_THAT(edgesOf(graph), Contains("gbuffer.depth -> wide_occlusion.depth"));
    EXPECT_THAT(edgesOf(graph), Not(Contains("gbuffer.depth -> ao.depth")));
    EXPECT_THAT(refusal([&] {
                    moveEdgeEnd(graph, registry, {"ao", "tracer"}, {wide, "depth"}, false);
                }),
                HasSubstr("a tracer cannot feed a texture port"));
}

// (5) Mute is the document's.
TEST_F(EditorCommands, MutingIsSaved) {
    setMuted(graph, {"blur"}, true);
    EXPECT_THAT(saveGraph(graph), HasSubstr(R"("blur": { "type": "Blur", "muted": true,)"));
}

TEST_F(EditorCommands, ASwapKeepsWhatFitsAndSaysWhatDoesNot) {
    EXPECT_THAT(rivalTypes(graph, registry, "roma"), ElementsAre("Bvh", "Field"));
    EXPECT_THAT(rivalTypes(graph, registry, "ao"), ElementsAre("WideOcclusion"));
    EXPECT_THAT(rivalPasses(graph, registry, "roma"), ElementsAre("bvh"));
    EXPECT_THAT(rivalTypes(graph, registry, "bvh"), ElementsAre("Field", "Roma")); // nobody reads it

    const Swapped field = swapType(graph, registry, "roma", "Field");
    EXPECT_THAT(field.kept, ElementsAre("map.occupancy -> roma.occupancy", "roma.tracer -> ao.tracer"));
    EXPECT_THAT(field.dropped, IsEmpty());
    const Swapped bvh = swapType(graph, registry, "roma", "Bvh");
    EXPECT_THAT(bvh.dropped,
                ElementsAre("map.occupancy -> roma.occupancy: 'Bvh' has no free input that fits"));
    EXPECT_EQ(graph.find("roma")->position, glm::dvec2(200, 200));

    setProperty(graph, registry, "ao", "snap", true);
    const Swapped wide = swapType(graph, registry, "ao", "WideOcclusion");
    EXPECT_THAT(wide.dropped,
                ElementsAre("the property rays: 'WideOcclusion' has none of that name",
                            "the property radius: it must be from 1 to 100 scene units, not 0.5",
                            "the property snap: 'WideOcclusion' has none of that name",
                            "gbuffer.normal -> ao.normal: 'WideOcclusion' has no free input that fits"));
    EXPECT_TRUE(graph.find("ao")->properties.empty());
    EXPECT_TRUE(graph.find("ao")->bound.empty());
    EXPECT_THAT(edgesOf(graph), Contains("ao.visibility -> blur.signal"));
}

TEST_F(EditorCommands, ARivalInTheGraphTakesTheReaders) {
    const Swapped swapped = useInstead(graph, registry, "roma", "bvh");
    EXPECT_THAT(swapped.kept, ElementsAre("bvh.tracer -> ao.tracer"));
    EXPECT_THAT(edgesOf(graph), Contains("map.occupancy -> roma.occupancy")); // stays, for the way back
    const std::string other = addPass(graph, registry, "Blur", {});
    useInstead(graph, registry, "blur", other);
    EXPECT_EQ(graph.outputs[0].port.text(), "blur_2.result");
}

TEST_F(EditorCommands, OutputsAreTexturesAndBuffers) {
    setOutput(graph, registry, {"ao", "visibility"}, true);
    setOutput(graph, registry, {"ao", "visibility"}, true);
    EXPECT_EQ(graph.outputs.size(), 2u);
    setOutput(graph, registry, {"blur", "result"}, false);
    EXPECT_EQ(graph.outputs.size(), 1u);
    EXPECT_EQ(refusal([&] {
                  setOutput(graph, registry, {"bvh", "tracer"}, true);
              }),
              "'bvh.tracer' is no texture or buffer that a pass gives out");
}

TEST_F(EditorCommands, FramesCarryPassesAndAPassLiesInOne) {
    addFrame(graph, "Look", {"ao", "roma"});
    EXPECT_EQ(graph.frames[0].passes, std::vector<std::string>{"map"});
    EXPECT_EQ(graph.frames[1].passes, (std::vector<std::string>{"roma", "ao"}));
    movePasses(graph, {"roma", "ao"}, {5, 5});
    EXPECT_EQ(graph.edges[1].bends[0], glm::dvec2(305, 155));
    EXPECT_EQ(graph.find("roma")->position, glm::dvec2(205, 205));
    renameFrame(graph, 1, "See");
    removeFrame(graph, 0);
    EXPECT_EQ(graph.frames[0].title, "See");
    addNote(graph, "More", {1, 1});
    setNote(graph, 1, "Less", {2, 2});
    removeNote(graph, 0);
    EXPECT_EQ(graph.notes[0].text, "Less");
    EXPECT_THROW(removeNote(graph, 1), InputError);
}

TEST_F(EditorCommands, PropertiesFollowVariables) {
    const std::string wide = addPass(graph, registry, "WideOcclusion", {});
    EXPECT_EQ(refusal([&] { followVariable(graph, registry, wide, "radius", "reach"); }),
              "property 'radius' of pass 'wide_occlusion' must be from 1 to 100 scene units, not 0.5");
    followVariable(graph, registry, "ao", "rays", "quality");
    EXPECT_EQ(std::get<std::int64_t>(graph.variable("quality")->value), 4);
    setProperty(graph, registry, "ao", "radius", 2.0);
    EXPECT_EQ(std::get<double>(graph.variable("reach")->value), 2.0);
    followVariable(graph, registry, wide, "radius", "reach");
    // One that follows cannot have it: nobody gets it.
    EXPECT_EQ(refusal([&] { setProperty(graph, registry, "ao", "radius", 0.25); }),
              "property 'radius' of pass 'wide_occlusion' must be from 1 to 100 scene units, not 0.25");
    renameVariable(graph, "reach", "distance");
    EXPECT_EQ(graph.find(wide)->bound.at("radius"), "distance");
    removeVariable(graph, "distance");
    EXPECT_TRUE(graph.find(wide)->bound.empty());
    EXPECT_EQ(std::get<double>(
                  propertyValue(*graph.find(wide), *registry.find("WideOcclusion")->property("radius"))),
              2.0);
    resetProperty(graph, "ao", "rays");
    EXPECT_FALSE(isGiven(*graph.find("ao"), "rays"));
    EXPECT_TRUE(graph.find("ao")->bound.empty());
}

// (8) Search by name, type, port, value, what is read and written.
TEST_F(EditorCommands, SearchFindsByAllThatOneRemembers) {
    const auto found = [&](const std::string& query) {
        std::vector<std::string> texts;
        for (const Found& each : search(graph, registry, query)) texts.push_back(each.pass + ": " + each.why);
        return texts;
    };
    EXPECT_THAT(found("ROMA"), ElementsAre("roma: name"));
    EXPECT_THAT(found("rayocc"), ElementsAre("ao: type RayOcclusion"));
    EXPECT_THAT(found("tracer"), ElementsAre("roma: port tracer", "bvh: port tracer", "ao: port tracer"));
    EXPECT_THAT(found("rays=4"), ElementsAre("ao: rays = 4"));
    EXPECT_THAT(found("snap=false"), ElementsAre("ao: snap = false")); // a default is a value too
    EXPECT_THAT(found("reads roma"), ElementsAre("ao: reads roma.tracer"));
    EXPECT_THAT(found("writes blur"), ElementsAre("ao: writes blur.signal"));
    EXPECT_THAT(found("reads depth blur"), IsEmpty());
    EXPECT_THAT(found("reads gbuffer writes blur"),
                ElementsAre("ao: reads gbuffer.depth, writes blur.signal"));
    EXPECT_THAT(found(" "), IsEmpty());
    setMuted(graph, {"blur"}, true);
    EXPECT_THAT(found("muted"), ElementsAre("blur: muted"));

    EXPECT_LT(matchRank("AmbientOcclusionFirst", "amb"), matchRank("RayAmbientOcclusion", "amb"));
    EXPECT_EQ(matchRank("RayAmbientOcclusion", "rao"), 1'000); // first letters of words: no gap
    EXPECT_GT(matchRank("Strange", "sre"), 1'000);
    EXPECT_EQ(matchRank("Roma", "xyz"), -1);
}

// (10) Layout moves only what it is asked to.
TEST_F(EditorCommands, LayoutLeavesWhatAPersonPlaced) {
    const std::string name = addPass(graph, registry, "Blur", {});
    graph.find(name)->position.reset();
    const Graph before = graph;
    EXPECT_TRUE(placeMissing(graph, {}));
    for (const GraphPass& pass : before.passes)
        if (pass.position) {
            EXPECT_EQ(graph.find(pass.name)->position, pass.position) << pass.name;
        }
    EXPECT_GT(graph.find(name)->position->y, 400 + 100); // below the lowest box
    EXPECT_FALSE(placeMissing(graph, {}));

    arrange(graph, {"map", "roma", "ao"}, {});
    EXPECT_EQ(graph.find("gbuffer")->position, glm::dvec2(0, 0));
    EXPECT_EQ(graph.find("map")->position->x, 0); // the corner of the three stays
    EXPECT_LT(graph.find("map")->position->x, graph.find("roma")->position->x);
    EXPECT_LT(graph.find("roma")->position->x, graph.find("ao")->position->x);
    EXPECT_TRUE(graph.edges[1].bends.empty());
}

TEST(EditorLayout, BoxesDoNotOverlapAndEdgesLeadRight) {
    const Registry registry = editorRegistry();
    // A chain of blurs with edges over many columns, and pairs whose order must turn to cross nothing.
    Graph graph;
    Names all;
    const auto add = [&](const char* type) { return *all.insert(addPass(graph, registry, type, {})).first; };
    const std::string g = add("GBuffer");
    std::string last = g;
    for (int i = 0; i < 20; ++i) {
        const std::string blur = add("Blur");
        connect(graph, registry, {last, last == g ? "depth" : "result"}, {blur, "signal"});
        connect(graph, registry, {g, "normal"}, {blur, "guide"});
        last = blur;
    }
    std::vector<std::string> sources, readers;
    for (int i = 0; i < 6; ++i) sources.push_back(add("GBuffer"));
    for (int i = 0; i < 6; ++i) readers.push_back(add("Blur"));
    for (size_t i = 0; i < 6; ++i)
        connect(graph, registry, {sources[i], "depth"}, {readers[5 - i], "signal"});
    Sizes sizes;
    double tall = 40;
    for (const std::string& pass : all) sizes[pass] = {150, tall = tall > 300 ? 40 : tall + 37};
    arrange(graph, all, sizes);
    for (const GraphEdge& edge : graph.edges) {
        const GraphPass& from = *graph.find(edge.from.pass);
        EXPECT_LE(from.position->x + sizes.at(from.name).x, graph.find(edge.to.pass)->position->x)
            << edge.to.text();
    }
    for (const GraphPass& a : graph.passes)
        for (const GraphPass& b : graph.passes) {
            if (&a == &b) continue;
            const glm::dvec2 as = sizes.at(a.name), bs = sizes.at(b.name);
            EXPECT_TRUE(a.position->x + as.x <= b.position->x || b.position->x + bs.x <= a.position->x ||
                        a.position->y + as.y <= b.position->y || b.position->y + bs.y <= a.position->y)
                << a.name << " over " << b.name;
        }
    Names pairs(sources.begin(), sources.end());
    pairs.insert(readers.begin(), readers.end());
    EXPECT_EQ(crossings(graph, pairs), 0u);
    const std::string once = saveGraph(graph);
    arrange(graph, all, sizes);
    EXPECT_EQ(saveGraph(graph), once);
}

} // namespace
} // namespace kestrel::edit
