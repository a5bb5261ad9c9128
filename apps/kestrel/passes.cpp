// `kestrel passes`: the table of pass types, for people, machines and editors of graph files.
#include "commands.h"
#include "common.h"
#include "core/files.h"
#include "graph/fact_effects.h"
#include "graph/report.h"
#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace kestrel {

namespace {

struct PassesArguments {
    std::string name;
    bool json = false, schema = false, facts = false, markdown = false;
};

// Every pass stands in some graph that comes with Kestrel. Those that this build has no passes for are left
// out.
std::vector<Graph> shippedGraphs(const Registry& registry) {
    std::vector<std::filesystem::path> files;
    for (const char* folder : {"graphs", "graphs/sweeps/graphs"})
        for (const auto& entry : std::filesystem::directory_iterator(shareFolder() / folder))
            if (entry.path().extension() == ".json" && entry.path().stem() != "schema")
                files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<Graph> graphs;
    for (const std::filesystem::path& file : files)
        if (Graph graph = loadGraph(file); validate(graph, registry).empty())
            graphs.push_back(std::move(graph));
    return graphs;
}

int facts(const PassesArguments& arguments) {
    const Registry& registry = loadedRegistry();
    std::vector<Graph> graphs;
    if (arguments.name.empty()) {
        graphs = shippedGraphs(registry);
    } else {
        GraphArguments one;
        one.graph = arguments.name;
        graphs.push_back(openGraph(one, registry));
    }
    const std::vector<FactEffect> effects = factEffects(registry, graphs);
    fmt::print("{}", arguments.json       ? factsJson(effects)
                     : arguments.markdown ? factsMarkdown(effects)
                                          : factsText(effects));
    return 0;
}

int passes(const PassesArguments& arguments) {
    if (arguments.facts) return facts(arguments);
    const Registry& registry = loadedRegistry();
    if (arguments.schema) {
        fmt::print("{}", graphSchema(registry));
        return 0;
    }
    std::vector<const PassType*> types;
    for (const PassType& type : registry.types())
        if (arguments.name.empty() || type.name == arguments.name) types.push_back(&type);
    if (types.empty() && !arguments.name.empty())
        throw InputError(fmt::format("there is no pass type '{}'{}", arguments.name,
                                     didYouMean(arguments.name, registry.names())));
    if (arguments.json)
        fmt::print("{}", passesJson(types));
    else
        fmt::print("{}", arguments.name.empty() ? passListText(registry) : passTypeText(*types.front()));
    return 0;
}

} // namespace

void addPassesCommand(CLI::App& app, Run& run) {
    CLI::App* command =
        app.add_subcommand("passes", "List the pass types, or tell one's ports and properties");
    const auto arguments = std::make_shared<PassesArguments>();
    command->add_option("NAME", arguments->name, "A pass type; with --facts a graph");
    CLI::Option* json = command->add_flag("--json", arguments->json, "Print JSON");
    command->add_flag("--schema", arguments->schema, "Print the JSON schema of graph files")->excludes(json);
    CLI::Option* facts = command->add_flag(
        "--facts", arguments->facts,
        "Tell what each fact of a scene leaves out of each pass, wherever it stands in the graphs that come "
        "with Kestrel, or in one graph");
    command->add_flag("--markdown", arguments->markdown, "Of --facts: a table")->needs(facts)->excludes(json);
    command->footer("Examples:\n"
                    "  kestrel passes\n"
                    "  kestrel passes Roma\n"
                    "  kestrel passes --facts my_graph.json\n"
                    "  kestrel passes --schema > graphs/schema.json");
    command->callback([arguments, &run] { run = [arguments] { return passes(*arguments); }; });
}

} // namespace kestrel
