// Leaving out what a scene does not need changes no picture: shipped graphs in pairs with scenes, lighting,
// filters and properties. KESTREL_ALL_PAIRS=1 has every pair of a graph and a scene too, which takes minutes.
#include "leaving_out.h"
#include "scene/edit.h"
#include "shipped_fixture.h"
#include <cstdlib>
#include <set>
#include <utility>

namespace kestrel::test {
namespace {

// Every kind of light, material and motion, small; glass; nothing at all.
const std::vector<std::string> worlds = {
    "builtin:blob?detail=0.02",  "builtin:hall?detail=0.05",    "builtin:cornell",
    "builtin:grove?detail=0.01", "builtin:skinned?detail=0.05", "builtin:pool?detail=0.05",
    "builtin:morph?detail=0.05", "builtin:tower?detail=0.02",   "builtin:cornell?blended=0.5",
    "builtin:stress_empty"};

// What it is lit by: as the scene has it, nothing, one sun, a lamp and an area light.
SceneEdit lighting(size_t level) {
    switch (level) {
    case 1:
        return {.dropLights = true};
    case 2:
        return {.dropLights = true, .lights = {{.kind = LightKind::Directional, .place = {0.4, 0.9, 0.3}}}};
    case 3:
        return {.dropLights = true,
                .lights = {{.kind = LightKind::Point, .place = {0.5, 0.5, 0.4}},
                           {.kind = LightKind::Rectangle, .place = {-0.4, 0.7, 0.5}}}};
    default:
        return {};
    }
}

constexpr size_t lightings = 4, filters = 3, properties = 4;
constexpr size_t allRows = 1000; // as many as meet a new pair

// Whether this context can do what is chosen.
bool isHere(const std::string& choice) {
    const Capabilities& here = context().capabilities();
    if (choice == "interlock") return here.has("GL_ARB_fragment_shader_interlock");
    if (choice == "framebuffer_fetch") return here.has("GL_EXT_shader_framebuffer_fetch");
    return true;
}

// What the graph's switches can be set to: those of filters, or those of the other passes, and which of the
// tracers and layers that stand in the graph is used.
std::vector<std::string> settingsOf(const Graph& graph, bool ofFilters) {
    std::vector<std::string> settings;
    for (const GraphPass& pass : graph.passes) {
        const PassType* type = shipped().find(pass.type);
        if (type == nullptr || type->plugin.ends_with("filter.so") != ofFilters) continue;
        for (const PropertyInfo& property : type->properties) {
            Value value = property.defaultValue;
            for (const auto& [name, given] : pass.properties)
                if (name == property.name) value = given;
            if (const bool* on = std::get_if<bool>(&value))
                settings.push_back(fmt::format("{}.{}={}", pass.name, property.name, !*on));
            for (const std::string& choice : property.choices)
                if (property.kind == PropertyKind::Choice && choice != std::get<std::string>(value) &&
                    isHere(choice))
                    settings.push_back(fmt::format("{}.{}={}", pass.name, property.name, choice));
        }
    }
    for (const GraphEdge& edge : graph.edges) {
        if (ofFilters) break;
        const PassType* type = shipped().find(graph.find(edge.from.pass)->type);
        const PortInfo* port = type != nullptr ? type->port(edge.from.port) : nullptr;
        if (port == nullptr || (port->kind != PortKind::Tracer && port->kind != PortKind::Layers)) continue;
        for (const GraphPass& other : graph.passes)
            if (const PassType* rival = shipped().find(other.type);
                rival != nullptr && other.name != edge.from.pass && other.name != edge.to.pass)
                if (const PortInfo* same = rival->port(edge.from.port);
                    same != nullptr && same->kind == port->kind && same->direction == PortDirection::Output)
                    settings.push_back(fmt::format("{}={}.{}", edge.to.text(), other.name, same->name));
    }
    return settings;
}

// One level of each factor: graph, scene, lighting, filter, property. Level k > 0 of the last two is one of
// the graph's own settings, another one in each row.
using Row = std::array<size_t, 5>;
std::array<size_t, 5> levels() {
    return {shippedGraphNames().size(), worlds.size(), lightings, filters, properties};
}

using Pair = std::array<size_t, 4>; // factor, level, factor, level
std::vector<Pair> pairsOf(const Row& row) {
    std::vector<Pair> pairs;
    for (size_t i = 0; i < row.size(); ++i)
        for (size_t k = i + 1; k < row.size(); ++k) pairs.push_back({i, row[i], k, row[k]});
    return pairs;
}

// Of each graph at most so many rows, each the one that meets most pairs that none met before.
std::vector<Row> rows(size_t ofEach) {
    const auto all = levels();
    std::set<Pair> met;
    std::vector<Row> chosen;
    for (size_t round = 0, before = 0; round < ofEach; ++round) {
        for (size_t graph = 0; graph < all[0]; ++graph) {
            Row best{};
            size_t most = 0;
            for (size_t s = 0; s < all[1]; ++s)
                for (size_t l = 0; l < all[2]; ++l)
                    for (size_t f = 0; f < all[3]; ++f)
                        for (size_t p = 0; p < all[4]; ++p) {
                            const Row row{graph, (s + graph) % all[1], (l + graph) % all[2], f, p};
                            size_t fresh = 0;
                            for (const Pair& pair : pairsOf(row)) fresh += met.contains(pair) ? 0 : 1;
                            if (fresh > most) {
                                most = fresh;
                                best = row;
                            }
                        }
            if (most == 0) continue;
            for (const Pair& pair : pairsOf(best)) met.insert(pair);
            chosen.push_back(best);
        }
        if (chosen.size() == std::exchange(before, chosen.size())) break;
    }
    return chosen;
}

bool everyPair() { return std::getenv("KESTREL_ALL_PAIRS") != nullptr; }
std::vector<Row> rowsHere() { return rows(everyPair() ? allRows : 3); }

// Of all pairs, or of those without a graph, how many no row meets.
size_t unmet(const std::vector<Row>& chosen, bool withGraphs) {
    std::set<Pair> met;
    for (const Row& row : chosen)
        for (const Pair& pair : pairsOf(row)) met.insert(pair);
    const auto all = levels();
    size_t missing = 0;
    for (size_t i = withGraphs ? 0 : 1; i < all.size(); ++i)
        for (size_t k = i + 1; k < all.size(); ++k)
            for (size_t a = 0; a < all[i]; ++a)
                for (size_t b = 0; b < all[k]; ++b) missing += met.contains({i, a, k, b}) ? 0 : 1;
    return missing;
}

TEST(LeavingOutPairs, MeetEachOther) {
    EXPECT_EQ(unmet(rows(3), false), 0u) << "of scene, lighting, filter and property every two meet";
    EXPECT_EQ(unmet(rows(allRows), true), 0u) << "with KESTREL_ALL_PAIRS every two meet, graphs too";
}

struct LeavingOutTest : ShippedTest, testing::WithParamInterface<std::string> {};

// The graph of a row, with what it is set to in words.
Graph graphOf(const Row& row, size_t turn, std::string& what) {
    const std::string name = shippedGraphNames()[row[0]];
    Graph graph = lightened(shippedGraph(name));
    what = fmt::format("{} {} lighting {}", name, worlds[row[1]], row[2]);
    for (const bool ofFilters : {true, false}) {
        const std::vector<std::string> settings = settingsOf(graph, ofFilters);
        const size_t level = ofFilters ? row[3] : row[4];
        if (level == 0 || settings.empty()) continue;
        // Rows of one graph go on where those before ended.
        const std::string& setting =
            settings[(level - 1 + turn * (ofFilters ? filters - 1 : properties - 1)) % settings.size()];
        Graph changed = graph;
        applySetting(changed, shipped(), setting);
        if (!validate(changed, shipped()).empty()) continue;
        graph = std::move(changed);
        what += " " + setting;
    }
    return graph;
}

TEST_P(LeavingOutTest, ChangesNoImage) {
    for (const GraphPass& pass : shippedGraph(GetParam()).passes)
        if (shipped().find(pass.type) == nullptr) GTEST_SKIP() << "this build has no " << pass.type;
    size_t turn = 0;
    for (const Row& row : rowsHere()) {
        if (shippedGraphNames()[row[0]] != GetParam()) continue;
        std::string what;
        const Graph graph = graphOf(row, turn++, what);
        SCOPED_TRACE(what);
        Scene scene = loadScene(worlds[row[1]]);
        editScene(scene, lighting(row[2]));
        const LeavingOut found = leavingOut(graph, shipped(), scene, context().capabilities(), {48, 27, 1});
        EXPECT_GT(found.equal + found.close, 0);
        for (const std::string& mistake : found.mistakes) ADD_FAILURE() << mistake;
        fmt::print(
            "{}: {} of {}, {:.3g} of {:.3g} ms; {} outputs to the bit, {} within {:.2g} % of the pixels, "
            "root mean square {:.2g}\n",
            what, bytesText(found.bytes), bytesText(found.bytesKept), found.ms, found.msKept, found.equal,
            found.close, 100 * found.pixels, found.rms);
    }
}

INSTANTIATE_TEST_SUITE_P(Graphs, LeavingOutTest, testing::ValuesIn(shippedGraphNames()),
                         [](const auto& of) { return of.param; });

} // namespace
} // namespace kestrel::test
