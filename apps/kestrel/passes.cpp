// `kestrel passes`: the table of pass types, for people, machines and editors of graph files.
#include "commands.h"
#include "common.h"
#include "graph/report.h"
#include <fmt/format.h>
#include <memory>

namespace kestrel {

namespace {

struct PassesArguments {
    std::string name;
    bool json = false, schema = false;
};

int passes(const PassesArguments& arguments) {
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
    command->add_option("NAME", arguments->name, "A pass type");
    CLI::Option* json = command->add_flag("--json", arguments->json, "Print JSON");
    command->add_flag("--schema", arguments->schema, "Print the JSON schema of graph files")->excludes(json);
    command->footer("Examples:\n"
                    "  kestrel passes\n"
                    "  kestrel passes Roma\n"
                    "  kestrel passes --schema > graphs/schema.json");
    command->callback([arguments, &run] { run = [arguments] { return passes(*arguments); }; });
}

} // namespace kestrel
