#include "measure/sweep_schema.h"
#include "measure/sweep_file.h"
#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using Out = nlohmann::ordered_json;

Out schemaText(const std::string& description) { return {{"type", "string"}, {"description", description}}; }

Out schemaName(const std::string& description) {
    return {{"type", "string"}, {"minLength", 1}, {"maxLength", maxSweepName}, {"description", description}};
}

Out schemaFlag(const std::string& description) {
    return {{"type", "boolean"}, {"default", false}, {"description", description}};
}

Out schemaWhole(int minimum, int maximum, const std::string& description) {
    return {{"type", "integer"}, {"minimum", minimum}, {"maximum", maximum}, {"description", description}};
}

Out schemaFrames(const std::string& description) { return schemaWhole(1, maxSweepFrames, description); }

Out schemaPort(const std::string& description) {
    return {{"$ref", "#/$defs/port"}, {"description", description}};
}

Out schemaList(Out items, int least = 0) {
    Out json = {{"type", "array"}, {"items", std::move(items)}};
    if (least > 0) json["minItems"] = least;
    return json;
}

Out schemaObject(Out properties, const std::vector<std::string>& required) {
    Out json = {{"type", "object"}};
    if (!required.empty()) json["required"] = required;
    json["properties"] = std::move(properties);
    json["additionalProperties"] = false;
    return json;
}

Out schemaMap(Out values) { return {{"type", "object"}, {"additionalProperties", std::move(values)}}; }

Out schemaSettings() { return {{"$ref", "#/$defs/settings"}}; }

Out sceneSchema() {
    const std::string source = "\"builtin:NAME\", or a file in the folder of the sweep file";
    return {{"anyOf",
             {schemaText(source), schemaObject({{"source", schemaText(source)},
                                                {"camera", schemaText("A camera of the scene by its name")},
                                                {"name", schemaName("Of plots and files")}},
                                               {"source"})}}};
}

Out referenceSchema() {
    return schemaObject({{"graph", schemaText("A graph file")},
                         {"output", schemaPort("The picture")},
                         {"mask", schemaPort("Pixels count where it is greater than 0.5")},
                         {"set", schemaSettings()},
                         {"frames", schemaFrames("After which the picture is taken; 1 by default")}},
                        {"graph", "output"});
}

Out raysSchema() {
    return schemaObject({{"graph", schemaText("A graph file")},
                         {"hits", schemaPort("What the variants' hits are held against")},
                         {"rays", schemaPort("The rays that all variants trace")},
                         {"set", schemaSettings()},
                         {"frames", schemaFrames("Those of the last one count; 1 by default")}},
                        {"graph", "hits", "rays"});
}

Out axisSchema() {
    const Out value = {{"anyOf",
                        {{{"$ref", "#/$defs/scalar"}},
                         schemaObject({{"label", schemaName("Of the value")}, {"set", schemaSettings()}},
                                      {"label", "set"})}}};
    Out templates = schemaList({{"type", "string"}, {"pattern", "\\{\\}"}});
    templates["description"] = "Settings with {} for the value";
    return {{"anyOf",
             {schemaList(value, 1),
              schemaObject({{"set", std::move(templates)}, {"values", schemaList(value, 1)}},
                           {"set", "values"})}}};
}

Out variantSchema() {
    Out exclusion = schemaMap({{"$ref", "#/$defs/scalar"}});
    exclusion["minProperties"] = 1;
    Out json = schemaObject({{"name", schemaName("Unique")},
                             {"comment", schemaText("For the reader")},
                             {"graph", schemaText("A graph file")},
                             {"output", schemaPort("The picture that is held against the reference")},
                             {"hits", schemaPort("Of RayQuery, held against the hits of 'rays'")},
                             {"set", schemaSettings()},
                             {"axes", schemaMap({{"$ref", "#/$defs/axis"}})},
                             {"exclude", schemaList(std::move(exclusion))},
                             {"series", schemaText("Points of one are joined; {axis} stands for its label")},
                             {"along", schemaText("The axis along which they are joined")},
                             {"plot", schemaName("Which plot of the scene")},
                             {"frames", schemaFrames("Instead of the sweep's")}},
                            {"name", "graph"});
    json["oneOf"] = {{{"required", {"output"}}}, {{"required", {"hits"}}}};
    return json;
}

} // namespace

std::string sweepSchema() {
    const Sweep standard;
    const auto with = [](Out schema, Out value) {
        schema["default"] = std::move(value);
        return schema;
    };
    Out size = schemaList({{"type", "integer"}, {"minimum", 1}, {"maximum", maxSweepSide}}, 2);
    size["maxItems"] = 2;
    size["default"] = {standard.size.width, standard.size.height};
    Out times = schemaMap(schemaList({{"type", "string"}, {"pattern", "^(-.+|[^-].*)$"}}, 1));
    times["propertyNames"] = {{"not", {{"enum", {"total", "frame"}}}}};
    times["description"] = "Each the sum of groups and passes, those with '-' before them subtracted";
    Out json = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "A Kestrel sweep"}};
    json.update(schemaObject(
        {{"kestrel_sweep", {{"const", 1}}},
         {"title", schemaText("Of the page")},
         {"comment", schemaText("For the reader")},
         {"size", std::move(size)},
         {"frames", with(schemaFrames("After which the picture is taken"), standard.frames)},
         {"warm_up", with(schemaWhole(0, maxSweepFrames, "Frames before each repetition that are not timed"),
                          standard.warmUp)},
         {"repeats", with(schemaWhole(1, maxSweepRepeats, "Repetitions of each variant, round-robin"),
                          standard.repeats)},
         {"timed_frames", with(schemaFrames("A repetition"), standard.timedFrames)},
         {"seed", with(schemaWhole(0, maxSweepSeed, "Of all random numbers"), standard.seed)},
         {"moving", schemaFlag("Scenes move on from frame to frame")},
         {"rebuild", schemaFlag("Everything is made anew in each timed frame")},
         {"hdr", schemaFlag("Pictures hold linear light without upper limit")},
         {"times", std::move(times)},
         {"plot", schemaObject({{"time", with(schemaText("\"total\", \"frame\" or one of 'times'"),
                                              standard.plotTime)},
                                {"error", {{"enum", sweepErrors()}}}},
                               {})},
         {"scenes", schemaList(sceneSchema(), 1)},
         {"reference", referenceSchema()},
         {"rays", raysSchema()},
         {"variants", schemaList({{"$ref", "#/$defs/variant"}}, 1)}},
        {"kestrel_sweep", "scenes", "variants"}));
    Out settings = schemaList({{"type", "string"}});
    settings["description"] = "As --set takes them: pass.property=value, or pass.input=pass.output";
    json["$defs"] = {{"port", {{"type", "string"}, {"pattern", "^[a-z][a-z0-9_]*\\.[a-z][a-z0-9_]*$"}}},
                     {"settings", std::move(settings)},
                     {"scalar", {{"type", {"string", "number", "boolean"}}}},
                     {"axis", axisSchema()},
                     {"variant", variantSchema()}};
    return json.dump(2) + "\n";
}

} // namespace kestrel
