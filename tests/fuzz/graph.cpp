// Graph files: form, names, settings, and the text that they are saved as.
#include "graph/graph.h"
#include "fuzz.h"
#include "unit/graph_mock.h"

namespace kestrel {
namespace {

// A type with every kind of port and property, named as the shipped graphs name theirs.
class Knobs final : public Pass {
public:
    enum class Method { Exact, Fast };
    Declaration declare(const World&, const Inputs&, const Demand&) const override { return {}; }
    void execute(const Step&, Commands&) override {}
    int directions = 16;
    float radius = 1;
    bool snap = false;
    Method method = Method::Exact;
    std::string label;
    glm::vec3 tint{1};
};

Registry makeRegistry() {
    using namespace test;
    Registry registry;
    registry.add(mockType("GBuffer", {out("depth"), out("tracer", PortKind::Tracer)},
                          simple({}, {"depth", "tracer"})));
    registry.add(mockType("Blur", {in("color"), opt("depth"), out("result")}, simple({"color"}, {"result"})));
    registry.add(Describe<Knobs>("Knobs", "A pass with every kind of property")
                     .input("depth", PortKind::Texture, "An input")
                     .optionalInput("tracer", PortKind::Tracer, "Another")
                     .output("result", PortKind::Texture, "An output")
                     .number("directions", &Knobs::directions, 1, 64, "", "A whole number")
                     .number("radius", &Knobs::radius, 0, 10, "", "A number")
                     .flag("snap", &Knobs::snap, "A flag")
                     .choice("method", &Knobs::method, {"exact", "fast"}, "A choice")
                     .text("label", &Knobs::label, "A text")
                     .vector("tint", &Knobs::tint, 0, 1, "", "A vector"));
    return registry;
}

} // namespace
} // namespace kestrel

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace kestrel;
    static const Registry registry = makeRegistry();
    Graph graph;
    if (!fuzz::taken([&] { graph = parseGraph(fuzz::textOf(data, size), "graph.json"); })) return 0;
    const std::string saved = saveGraph(graph);
    KESTREL_CHECK_EQ(saveGraph(parseGraph(saved, "graph.json")), saved);
    const bool valid = validate(graph, registry).empty();
    if (valid) makePasses(graph, registry);
    // The comment as a setting: whatever it says, the graph stays one that can be saved and read.
    if (fuzz::taken([&] { applySetting(graph, registry, graph.comment); })) {
        const std::string set = saveGraph(graph);
        KESTREL_CHECK_EQ(saveGraph(parseGraph(set, "graph.json")), set);
    }
    return 0;
}
