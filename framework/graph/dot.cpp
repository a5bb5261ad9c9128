// A graph for Graphviz.
#include "graph/report.h"
#include "graph/value_text.h"
#include <fmt/format.h>
#include <set>

namespace kestrel {
namespace {

// What an edge of this kind looks like: modules stand out.
std::string edgeStyle(const Graph& graph, const Registry& registry, const GraphEdge& edge, bool faded) {
    const GraphPass* producer = graph.find(edge.from.pass);
    const PassType* type = producer == nullptr ? nullptr : registry.find(producer->type);
    const PortInfo* port = type == nullptr ? nullptr : type->port(edge.from.port);
    const bool module = port != nullptr && isModule(port->kind);
    return fmt::format("label={}, color={}, fontcolor={}{}", jsonText(edge.from.port + " > " + edge.to.port),
                       faded    ? "gray75"
                       : module ? "blue3"
                                : "black",
                       faded ? "gray75" : "black", module ? ", style=bold" : "");
}

} // namespace

std::string dotText(const Graph& graph, const Registry& registry, const Plan& plan) {
    std::set<std::string> running;
    for (const PlanPass& pass : plan.passes) running.insert(pass.name);
    std::string text =
        fmt::format("digraph {} {{\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\"];\n"
                    "  edge [fontname=\"sans-serif\", fontsize=10];\n",
                    jsonText(graph.name.empty() ? std::string("graph") : graph.name));
    for (const GraphPass& pass : graph.passes) {
        std::string why;
        for (const LeftOut& left : plan.leftOut)
            if (left.what == pass.name) why = left.why;
        text +=
            fmt::format("  {} [label={}{}];\n", jsonText(pass.name), jsonText(pass.name + "\n" + pass.type),
                        running.contains(pass.name)
                            ? std::string()
                            : fmt::format(", style=dashed, color=gray75, fontcolor=gray60, tooltip={}",
                                          jsonText("left out: " + why)));
    }
    for (const GraphEdge& edge : graph.edges) {
        const bool faded = !running.contains(edge.from.pass) || !running.contains(edge.to.pass);
        text += fmt::format("  {} -> {} [{}];\n", jsonText(edge.from.pass), jsonText(edge.to.pass),
                            edgeStyle(graph, registry, edge, faded));
    }
    for (const GraphOutput& output : graph.outputs) {
        const std::string name = "output " + output.port.text();
        text += fmt::format("  {} [label={}, shape=plaintext];\n  {} -> {};\n", jsonText(name),
                            jsonText(output.port.port), jsonText(output.port.pass), jsonText(name));
    }
    return text + "}\n";
}

} // namespace kestrel
