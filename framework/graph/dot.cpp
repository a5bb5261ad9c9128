// A graph for Graphviz.
#include "graph/report.h"
#include "graph/value_text.h"
#include <fmt/format.h>
#include <map>

namespace kestrel {
namespace {

bool isModuleEdge(const Graph& graph, const Registry& registry, const GraphEdge& edge) {
    const GraphPass* producer = graph.find(edge.from.pass);
    const PassType* type = producer == nullptr ? nullptr : registry.find(producer->type);
    const PortInfo* port = type == nullptr ? nullptr : type->port(edge.from.port);
    return port != nullptr && isModule(port->kind);
}

} // namespace

std::string dotText(const Graph& graph, const Registry& registry, const Plan* plan) {
    std::map<std::string, std::string> why; // of the passes that are left out
    if (plan != nullptr)
        for (const LeftOut& left : plan->leftOut)
            if (graph.find(left.what) != nullptr) why.emplace(left.what, left.why);
    std::string text = fmt::format(
        "digraph {} {{\n  rankdir=LR;\n  node [shape=box, style=rounded, fontname=\"sans-serif\"];\n"
        "  edge [fontname=\"sans-serif\", fontsize=10];\n",
        jsonText(graph.name.empty() ? std::string("graph") : graph.name));
    for (const GraphPass& pass : graph.passes) {
        const std::string label = jsonText(pass.name + "\n" + pass.type);
        const auto left = why.find(pass.name);
        text += left == why.end()
                    ? fmt::format("  {} [label={}];\n", jsonText(pass.name), label)
                    : fmt::format("  {} [label={}, color=gray70, fontcolor=gray70, "
                                  "style=\"rounded,dashed\", tooltip={}];\n",
                                  jsonText(pass.name), label, jsonText("left out: " + left->second));
    }
    for (const GraphEdge& edge : graph.edges) {
        const std::string label =
            edge.from.port == edge.to.port ? edge.from.port : edge.from.port + " → " + edge.to.port;
        const bool faded = why.contains(edge.from.pass) || why.contains(edge.to.pass);
        text += fmt::format("  {} -> {} [label={}{}{}];\n", jsonText(edge.from.pass), jsonText(edge.to.pass),
                            jsonText(label), isModuleEdge(graph, registry, edge) ? ", style=bold" : "",
                            faded ? ", color=gray70, fontcolor=gray70" : "");
    }
    for (const GraphOutput& output : graph.outputs) {
        const std::string name = jsonText("output " + output.port.text());
        text += fmt::format("  {} [label={}, shape=note];\n  {} -> {};\n", name, jsonText(output.port.port),
                            jsonText(output.port.pass), name);
    }
    return text + "}\n";
}

} // namespace kestrel
