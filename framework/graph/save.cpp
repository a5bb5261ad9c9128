// The canonical text of a graph.
#include "graph/graph.h"
#include "graph/value_text.h"
#include "scene/setup_keys.h"
#include <fmt/format.h>

namespace kestrel {
namespace {

// Collects `"key": value` members and joins them.
class Members {
public:
    void add(const std::string& key, const std::string& value) {
        items_.push_back(jsonText(key) + ": " + value);
    }
    [[nodiscard]] bool empty() const { return items_.empty(); }
    [[nodiscard]] std::string inOneLine() const { return fmt::format("{{ {} }}", fmt::join(items_, ", ")); }
    [[nodiscard]] std::string inLines(const std::string& indent) const {
        if (items_.empty()) return "{}";
        return fmt::format("{{\n{0}  {1}\n{0}}}", indent, fmt::join(items_, ",\n  " + indent));
    }

private:
    std::vector<std::string> items_;
};

std::string arrayInLines(const std::vector<std::string>& items) {
    if (items.empty()) return "[]";
    return fmt::format("[\n    {}\n  ]", fmt::join(items, ",\n    "));
}

std::string pointText(const glm::dvec2& point) {
    return jsonText(Value(std::vector<double>{point.x, point.y}));
}

std::string passText(const GraphPass& pass) {
    Members members;
    members.add("type", jsonText(pass.type));
    Members properties;
    for (const auto& [name, value] : pass.properties) {
        const auto follows = pass.bound.find(name);
        properties.add(name, follows == pass.bound.end()
                                 ? jsonText(value)
                                 : fmt::format("{{ \"variable\": {} }}", jsonText(follows->second)));
    }
    if (!properties.empty()) members.add("properties", properties.inOneLine());
    if (pass.muted) members.add("muted", "true");
    if (pass.position) members.add("position", pointText(*pass.position));
    if (!pass.comment.empty()) members.add("comment", jsonText(pass.comment));
    return members.inOneLine();
}

std::string edgeText(const GraphEdge& edge) {
    std::string text = fmt::format("[{}, {}", jsonText(edge.from.text()), jsonText(edge.to.text()));
    if (!edge.bends.empty()) {
        std::vector<std::string> points;
        for (const glm::dvec2& point : edge.bends) points.push_back(pointText(point));
        text += fmt::format(", [{}]", fmt::join(points, ", "));
    }
    return text + "]";
}

std::string frameText(const GraphFrame& frame) {
    std::vector<std::string> passes;
    for (const std::string& pass : frame.passes) passes.push_back(jsonText(pass));
    return fmt::format("{{ \"title\": {}, \"passes\": [{}] }}", jsonText(frame.title),
                       fmt::join(passes, ", "));
}

} // namespace

std::string saveGraph(const Graph& graph) {
    Members root;
    root.add("kestrel", "1");
    if (!graph.name.empty()) root.add("name", jsonText(graph.name));
    if (!graph.comment.empty()) root.add("comment", jsonText(graph.comment));
    Members scene;
    if (!graph.sceneSource.empty()) scene.add("source", jsonText(graph.sceneSource));
    for (const auto& [key, value] : sceneSetupKeys().members(graph.sceneSetup)) scene.add(key, value);
    if (!scene.empty()) root.add("scene", scene.inOneLine());

    Members variables;
    for (const GraphVariable& variable : graph.variables)
        variables.add(variable.name, jsonText(variable.value));
    if (!variables.empty()) root.add("variables", variables.inOneLine());

    Members passes;
    for (const GraphPass& pass : graph.passes) passes.add(pass.name, passText(pass));
    root.add("passes", passes.inLines("  "));

    std::vector<std::string> edges;
    for (const GraphEdge& edge : graph.edges) edges.push_back(edgeText(edge));
    root.add("edges", arrayInLines(edges));

    std::vector<std::string> outputs;
    for (const GraphOutput& output : graph.outputs) outputs.push_back(jsonText(output.port.text()));
    root.add("outputs", fmt::format("[{}]", fmt::join(outputs, ", ")));

    std::vector<std::string> frames, notes;
    for (const GraphFrame& frame : graph.frames) frames.push_back(frameText(frame));
    for (const GraphNote& note : graph.notes)
        notes.push_back(fmt::format("{{ \"text\": {}, \"position\": {} }}", jsonText(note.text),
                                    pointText(note.position)));
    if (!frames.empty()) root.add("frames", arrayInLines(frames));
    if (!notes.empty()) root.add("notes", arrayInLines(notes));
    return root.inLines("") + "\n";
}

} // namespace kestrel
