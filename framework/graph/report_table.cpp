// The table of pass types as text and JSON, and the JSON schema made from it.
#include "graph/report.h"
#include "graph/value_text.h"
#include "scene/setup_keys.h"
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using Out = nlohmann::ordered_json;

std::string_view kindName(PropertyKind kind) {
    constexpr std::array<std::string_view, 6> names = {"bool", "int", "float", "choice", "text", "vector"};
    return names.at(static_cast<size_t>(kind));
}

std::string_view directionName(PortDirection direction) {
    constexpr std::array<std::string_view, 3> names = {"input", "output", "internal"};
    return names.at(static_cast<size_t>(direction));
}

// A number as JSON has it, whole where it is whole, short where it is a float.
Out number(double value) { return Out::parse(numberText(value)); }

Out defaultOf(const PropertyInfo& property) { return Out::parse(jsonText(property.defaultValue)); }

Out propertyJson(const PropertyInfo& property) {
    Out json = {{"name", property.name}, {"kind", kindName(property.kind)}, {"default", defaultOf(property)}};
    if (std::isfinite(property.minimum)) json["minimum"] = number(property.minimum);
    if (std::isfinite(property.maximum)) json["maximum"] = number(property.maximum);
    if (!property.choices.empty()) json["choices"] = property.choices;
    if (property.components > 0) json["components"] = property.components;
    json["unit"] = property.unit;
    json["description"] = property.description;
    return json;
}

// "texture, optional, 3 channels, render space, extent of depth".
std::string portFacts(const PortInfo& port) {
    std::string text(portKindName(port.kind));
    if (port.optional) text += ", optional";
    if (const std::string carried = describe(port.content); !carried.empty()) text += ", " + carried;
    if (!port.sameExtentAs.empty()) text += ", extent of " + port.sameExtentAs;
    return text;
}

// What is stated of a port; keys that are not say nothing.
Out portJson(const PortInfo& port) {
    Out json = {{"name", port.name},
                {"kind", portKindName(port.kind)},
                {"direction", directionName(port.direction)},
                {"optional", port.optional},
                {"description", port.description}};
    if (!port.content.structure.empty()) json["structure"] = port.content.structure;
    if (port.content.channels > 0) json["channels"] = port.content.channels;
    if (port.content.space != Space::Any) json["space"] = spaceName(port.content.space);
    if (!port.sameExtentAs.empty()) json["same_extent_as"] = port.sameExtentAs;
    if (std::isfinite(port.minimum)) json["minimum"] = number(port.minimum);
    if (std::isfinite(port.maximum)) json["maximum"] = number(port.maximum);
    return json;
}

Out portsJson(const PassType& type) {
    Out ports = Out::array();
    for (const PortInfo& port : type.ports) ports.push_back(portJson(port));
    return ports;
}

std::string rangeText(const PropertyInfo& property) {
    if (property.kind == PropertyKind::Choice) return fmt::format("{}", fmt::join(property.choices, " | "));
    const bool below = std::isfinite(property.minimum), above = std::isfinite(property.maximum);
    std::string text(kindName(property.kind));
    if (property.components > 0) text += std::to_string(property.components);
    if (below && above)
        text += fmt::format(" {} to {}", numberText(property.minimum), numberText(property.maximum));
    else if (below)
        text += fmt::format(" at least {}", numberText(property.minimum));
    else if (above)
        text += fmt::format(" at most {}", numberText(property.maximum));
    return property.unit.empty() ? text : text + " " + property.unit;
}

// ---- schema

Out rangeSchema(const PropertyInfo& property, const char* type) {
    Out json = {{"type", type}};
    if (std::isfinite(property.minimum)) json["minimum"] = number(property.minimum);
    if (std::isfinite(property.maximum)) json["maximum"] = number(property.maximum);
    return json;
}

Out valueSchema(const PropertyInfo& property) {
    switch (property.kind) {
    case PropertyKind::Bool:
        return {{"type", "boolean"}};
    case PropertyKind::Int:
        return rangeSchema(property, "integer");
    case PropertyKind::Float:
        return rangeSchema(property, "number");
    case PropertyKind::Choice:
        return {{"enum", property.choices}};
    case PropertyKind::Text:
        return {{"type", "string"}};
    case PropertyKind::Vector:
        return {{"type", "array"},
                {"items", rangeSchema(property, "number")},
                {"minItems", property.components},
                {"maxItems", property.components}};
    }
    return Out::object();
}

Out propertiesSchema(const PassType& type) {
    Out properties = Out::object();
    for (const PropertyInfo& property : type.properties) {
        Out schema = {{"anyOf", {valueSchema(property), {{"$ref", "#/$defs/follows"}}}}};
        schema["description"] =
            property.unit.empty() ? property.description : property.description + " (" + property.unit + ")";
        schema["default"] = defaultOf(property);
        properties[property.name] = std::move(schema);
    }
    // "ports" is an annotation, for editors of graph files: what can be joined to what.
    return {{"type", "object"},
            {"description", type.description},
            {"properties", std::move(properties)},
            {"additionalProperties", false},
            {"ports", portsJson(type)}};
}

Out passSchema(const Registry& registry) {
    Out choices = Out::array();
    for (const PassType& type : registry.types())
        choices.push_back({{"if", {{"properties", {{"type", {{"const", type.name}}}}}}},
                           {"then", {{"properties", {{"properties", {{"$ref", "#/$defs/" + type.name}}}}}}}});
    Out json = {{"type", "object"},
                {"required", {"type"}},
                {"properties",
                 {{"type", {{"enum", registry.names()}}},
                  {"properties", {{"type", "object"}}},
                  {"muted", {{"type", "boolean"}}},
                  {"position", {{"$ref", "#/$defs/point"}}},
                  {"comment", {{"type", "string"}}}}},
                {"additionalProperties", false}};
    if (!choices.empty()) json["allOf"] = std::move(choices);
    return json;
}

Out sceneSchema() {
    Out schema = sceneSetupKeys().schema();
    Out properties = {{"source", {{"type", "string"}}}};
    properties.update(schema["properties"]);
    schema["properties"] = std::move(properties);
    return schema;
}

} // namespace

std::string passListText(const Registry& registry) {
    size_t width = 0;
    for (const PassType& type : registry.types()) width = std::max(width, type.name.size());
    std::string text;
    for (const PassType& type : registry.types())
        text += fmt::format("{:{}}  {}\n", type.name, width, type.description);
    return text;
}

std::string passTypeText(const PassType& type) {
    std::string text = fmt::format("{}: {}\n", type.name, type.description);
    if (!type.plugin.empty()) text += fmt::format("  from {}\n", type.plugin);
    for (const PortDirection direction :
         {PortDirection::Input, PortDirection::Output, PortDirection::Internal})
        for (const PortInfo& port : type.ports)
            if (port.direction == direction)
                text += fmt::format("  {} {} ({}): {}\n", directionName(direction), port.name,
                                    portFacts(port), port.description);
    for (const PropertyInfo& property : type.properties)
        text += fmt::format("  property {} = {} ({}): {}\n", property.name, jsonText(property.defaultValue),
                            rangeText(property), property.description);
    return text;
}

std::string passesJson(const std::vector<const PassType*>& types) {
    Out passes = Out::array();
    for (const PassType* each : types) {
        const PassType& type = *each;
        Out properties = Out::array();
        for (const PropertyInfo& property : type.properties) properties.push_back(propertyJson(property));
        passes.push_back({{"name", type.name},
                          {"description", type.description},
                          {"plugin", type.plugin},
                          {"ports", portsJson(type)},
                          {"properties", std::move(properties)}});
    }
    return Out{{"passes", std::move(passes)}}.dump(2, ' ', false, Out::error_handler_t::replace) + "\n";
}

std::string graphSchema(const Registry& registry) {
    const std::string portPattern = "^[a-z][a-z0-9_]*\\.[a-z][a-z0-9_]*$";
    const Out port = {{"type", "string"}, {"pattern", portPattern}};
    Out definitions = Out::object();
    definitions["pass"] = passSchema(registry);
    definitions["port"] = port;
    definitions["point"] = {
        {"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 2}, {"maxItems", 2}};
    definitions["follows"] = {{"type", "object"},
                              {"description", "The value of a variable of the graph"},
                              {"properties", {{"variable", {{"type", "string"}}}}},
                              {"required", {"variable"}},
                              {"additionalProperties", false}};
    for (const PassType& type : registry.types()) definitions[type.name] = propertiesSchema(type);
    const Out text = {{"type", "string"}};
    const Out points = {{"type", "array"}, {"items", {{"$ref", "#/$defs/point"}}}};
    Out json;
    json["$schema"] = "https://json-schema.org/draft/2020-12/schema";
    json["title"] = "A Kestrel graph";
    json["type"] = "object";
    json["required"] = {"kestrel", "passes"};
    json["properties"] = {
        {"kestrel", {{"const", 1}}},
        {"name", text},
        {"comment", text},
        {"scene", sceneSchema()},
        {"variables",
         {{"type", "object"},
          {"propertyNames", {{"pattern", "^[a-z][a-z0-9_]*$"}}},
          {"additionalProperties", {{"type", {"boolean", "number", "string", "array"}}}}}},
        {"passes",
         {{"type", "object"},
          {"propertyNames", {{"pattern", "^[a-z][a-z0-9_]*$"}}},
          {"additionalProperties", {{"$ref", "#/$defs/pass"}}}}},
        {"edges",
         {{"type", "array"},
          {"items",
           {{"type", "array"},
            {"prefixItems", {{{"$ref", "#/$defs/port"}}, {{"$ref", "#/$defs/port"}}, points}},
            {"minItems", 2},
            {"maxItems", 3}}}}},
        {"outputs", {{"type", "array"}, {"items", {{"$ref", "#/$defs/port"}}}}},
        {"frames",
         {{"type", "array"},
          {"items",
           {{"type", "object"},
            {"properties", {{"title", text}, {"passes", {{"type", "array"}, {"items", text}}}}},
            {"required", {"title", "passes"}},
            {"additionalProperties", false}}}}},
        {"notes",
         {{"type", "array"},
          {"items",
           {{"type", "object"},
            {"properties", {{"text", text}, {"position", {{"$ref", "#/$defs/point"}}}}},
            {"required", {"text", "position"}},
            {"additionalProperties", false}}}}}};
    json["additionalProperties"] = false;
    json["$defs"] = std::move(definitions);
    return json.dump(2) + "\n";
}

} // namespace kestrel
