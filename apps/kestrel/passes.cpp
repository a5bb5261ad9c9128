// `kestrel passes`: the table of pass types, for people, machines and editors of graph files.
#include "commands.h"
#include "common.h"
#include "graph/value_text.h"
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace kestrel {

namespace {

using Json = nlohmann::ordered_json;

const char* directionText(PortDirection direction) {
    switch (direction) {
    case PortDirection::Input:
        return "input";
    case PortDirection::Output:
        return "output";
    case PortDirection::Internal:
        return "internal";
    }
    return "";
}

const char* kindText(PropertyKind kind) {
    switch (kind) {
    case PropertyKind::Bool:
        return "bool";
    case PropertyKind::Int:
        return "int";
    case PropertyKind::Float:
        return "float";
    case PropertyKind::Choice:
        return "choice";
    case PropertyKind::Text:
        return "text";
    case PropertyKind::Vector:
        return "vector";
    }
    return "";
}

std::string rangeText(const PropertyInfo& property) {
    if (property.kind == PropertyKind::Choice) return fmt::format("{}", fmt::join(property.choices, " | "));
    if (!std::isfinite(property.minimum) && !std::isfinite(property.maximum)) return kindText(property.kind);
    return fmt::format("{} to {}", numberText(property.minimum), numberText(property.maximum));
}

void printType(const PassType& type) {
    fmt::print("{}: {}\n", type.name, type.sentence);
    for (const PortDirection direction :
         {PortDirection::Input, PortDirection::Output, PortDirection::Internal}) {
        bool first = true;
        for (const PortInfo& port : type.ports) {
            if (port.direction != direction) continue;
            if (std::exchange(first, false)) fmt::print("{} ports:\n", directionText(direction));
            fmt::print("  {:<16} {:<8} {}{}\n", port.name, portKindName(port.kind),
                       port.optional ? "(optional) " : "", port.sentence);
        }
    }
    if (!type.properties.empty()) fmt::print("properties:\n");
    for (const PropertyInfo& property : type.properties)
        fmt::print("  {:<16} {} (default {}{}{}; {})\n", property.name, property.sentence,
                   jsonText(property.standard), property.unit.empty() ? "" : " ", property.unit,
                   rangeText(property));
    if (!type.plugin.empty()) fmt::print("plugin: {}\n", type.plugin);
}

// The text of a value is JSON already.
Json valueJson(const Value& value) { return Json::parse(jsonText(value)); }

Json typeJson(const PassType& type) {
    Json ports = Json::array(), properties = Json::array();
    for (const PortInfo& port : type.ports)
        ports.push_back({{"name", port.name},
                         {"direction", directionText(port.direction)},
                         {"kind", portKindName(port.kind)},
                         {"optional", port.optional},
                         {"sentence", port.sentence}});
    for (const PropertyInfo& property : type.properties) {
        Json item = {{"name", property.name},
                     {"kind", kindText(property.kind)},
                     {"default", valueJson(property.standard)},
                     {"unit", property.unit},
                     {"sentence", property.sentence}};
        if (std::isfinite(property.minimum)) item["minimum"] = property.minimum;
        if (std::isfinite(property.maximum)) item["maximum"] = property.maximum;
        if (!property.choices.empty()) item["choices"] = property.choices;
        if (property.components > 0) item["components"] = property.components;
        properties.push_back(std::move(item));
    }
    return {{"name", type.name},
            {"sentence", type.sentence},
            {"plugin", type.plugin},
            {"ports", ports},
            {"properties", properties}};
}

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
    const PassType* only = nullptr;
    if (!arguments.name.empty()) {
        only = registry.find(arguments.name);
        if (only == nullptr)
            throw InputError(fmt::format("there is no pass type '{}'{}", arguments.name,
                                         didYouMean(arguments.name, registry.names())));
    }
    if (arguments.json) {
        Json all = Json::array();
        for (const PassType& type : registry.types())
            if (only == nullptr || only == &type) all.push_back(typeJson(type));
        fmt::print("{}\n", Json{{"passes", all}}.dump(2, ' ', false, Json::error_handler_t::replace));
        return 0;
    }
    if (only != nullptr) {
        printType(*only);
        return 0;
    }
    for (const PassType& type : registry.types()) fmt::print("{:<26} {}\n", type.name, type.sentence);
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
