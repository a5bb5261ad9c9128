// `kestrel dot`: the graph as a picture, with what the scene leaves out drawn faded.
#include "commands.h"
#include "common.h"
#include "scene/facts.h"
#include <fmt/format.h>
#include <map>
#include <memory>
#include <optional>

namespace kestrel {

namespace {

std::string dotQuoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        if (c == '\n')
            result += "\\n";
        else
            result += c;
    }
    return result + "\"";
}

// What runs, if a scene is known.
std::optional<Plan> planFor(const GraphArguments& arguments, const Graph& graph, const Registry& registry) {
    if (arguments.scene.empty() && graph.sceneSource.empty()) return std::nullopt;
    World world;
    world.size = parseSize(arguments.size);
    world.facts = gatherFacts(openScene(arguments, graph));
    return compile(graph, registry, makePasses(graph, registry), world);
}

bool isModuleEdge(const Graph& graph, const Registry& registry, const GraphEdge& edge) {
    const GraphPass* pass = graph.find(edge.from.pass);
    const PassType* type = pass != nullptr ? registry.find(pass->type) : nullptr;
    const PortInfo* port = type != nullptr ? type->port(edge.from.port) : nullptr;
    return port != nullptr && isModule(port->kind);
}

int dot(const GraphArguments& arguments) {
    const Registry& registry = loadedRegistry();
    const Graph graph = openGraph(arguments, registry);
    const std::optional<Plan> plan = planFor(arguments, graph, registry);
    std::map<std::string, std::string> why;
    if (plan)
        for (const LeftOut& item : plan->leftOut) why[item.what] = item.why;
    // A pass without steps can still be there: its module is compiled into others.
    const auto leftOut = [&](const std::string& pass) { return why.contains(pass); };

    fmt::print("digraph {} {{\n", dotQuoted(graph.name));
    fmt::print("  rankdir=LR;\n  node [shape=box, style=rounded, fontname=\"sans-serif\"];\n"
               "  edge [fontname=\"sans-serif\", fontsize=10];\n");
    for (const GraphPass& pass : graph.passes) {
        const std::string label = dotQuoted(pass.name + "\n" + pass.type);
        if (leftOut(pass.name))
            fmt::print(
                "  {} [label={}, color=gray70, fontcolor=gray70, style=\"rounded,dashed\", tooltip={}];\n",
                dotQuoted(pass.name), label, dotQuoted(why[pass.name]));
        else
            fmt::print("  {} [label={}];\n", dotQuoted(pass.name), label);
    }
    for (const GraphEdge& edge : graph.edges) {
        const std::string label =
            edge.from.port == edge.to.port ? edge.from.port : edge.from.port + " → " + edge.to.port;
        const bool faded = leftOut(edge.from.pass) || leftOut(edge.to.pass);
        fmt::print("  {} -> {} [label={}{}{}];\n", dotQuoted(edge.from.pass), dotQuoted(edge.to.pass),
                   dotQuoted(label), isModuleEdge(graph, registry, edge) ? ", style=bold" : "",
                   faded ? ", color=gray70, fontcolor=gray70" : "");
    }
    for (const GraphOutput& output : graph.outputs)
        fmt::print("  {} [shape=note];\n  {} -> {} [label={}];\n", dotQuoted("out " + output.port.text()),
                   dotQuoted(output.port.pass), dotQuoted("out " + output.port.text()),
                   dotQuoted(output.port.port));
    fmt::print("}}\n");
    return static_cast<int>(ExitStatus::Done);
}

} // namespace

void addDotCommand(CLI::App& app, Run& run) {
    CLI::App* command =
        app.add_subcommand("dot", "Print the graph for Graphviz, with what the scene leaves out drawn faded");
    const auto arguments = std::make_shared<GraphArguments>();
    addGraphArguments(*command, *arguments);
    command->footer("Example:\n  kestrel dot graphs/ray_ao.json | dot -Tsvg > ray_ao.svg");
    command->callback([arguments, &run] { run = [arguments] { return dot(*arguments); }; });
}

} // namespace kestrel
