// `kestrel dot`: the graph as a picture, with what the scene leaves out drawn faded.
#include "commands.h"
#include "common.h"
#include "graph/report.h"
#include "scene/facts.h"
#include <fmt/format.h>
#include <memory>
#include <optional>

namespace kestrel {

namespace {

// What runs, if a scene is known; a drawing needs no device, so none limits it.
std::optional<Plan> planFor(const GraphArguments& arguments, const Graph& graph, const Registry& registry) {
    if (arguments.scene.empty() && graph.sceneSource.empty()) return std::nullopt;
    World world;
    world.size = parseSize(arguments.size);
    world.facts = gatherFacts(openScene(arguments, graph));
    world.capabilities = Capabilities::unlimited();
    return compile(graph, registry, makePasses(graph, registry), world);
}

int dot(const GraphArguments& arguments) {
    const Registry& registry = loadedRegistry();
    const Graph graph = openGraph(arguments, registry);
    const std::optional<Plan> plan = planFor(arguments, graph, registry);
    fmt::print("{}", dotText(graph, registry, plan ? &*plan : nullptr));
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
