// The graph document: what a graph file says. Plain data; loading, editing, comparing and saving need no GL.
#pragma once
#include "core/error.h"
#include "graph/registry.h"
#include "scene/setup.h"
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

struct PortRef {
    std::string pass, port;
    [[nodiscard]] std::string text() const { return pass + "." + port; }
    friend bool operator==(const PortRef&, const PortRef&) = default;
    friend auto operator<=>(const PortRef&, const PortRef&) = default;
};

// "pass.port"; nothing if the text is not of that form.
std::optional<PortRef> parsePortRef(std::string_view text);

struct GraphPass {
    std::string name, type;
    std::vector<std::pair<std::string, Value>> properties; // those that the file gives, in its order
    // Properties that follow a variable of the graph: property -> variable. Their values above are the
    // variable's.
    std::map<std::string, std::string> bound;
    bool muted = false; // does nothing: each output is the first connected input that can stand for it
    std::optional<glm::dvec2> position; // on the editor's canvas
    std::string comment;
    Location where;
    std::map<std::string, Location> propertyWhere;
};

struct GraphEdge {
    PortRef from, to; // an output, an input
    Location where;
    Location fromWhere = {}, toWhere = {};
    std::vector<glm::dvec2> bends = {}; // on the editor's canvas, from the output on
};

// A named value that properties of several passes follow.
struct GraphVariable {
    std::string name;
    Value value;
    Location where;
};

// A box on the editor's canvas that carries passes along.
struct GraphFrame {
    std::string title;
    std::vector<std::string> passes;
    Location where;
};

// A remark on the editor's canvas.
struct GraphNote {
    std::string text;
    glm::dvec2 position;
};

struct GraphOutput {
    PortRef port;
    Location where;
};

struct Graph {
    std::string name, comment;
    // "builtin:NAME" or a file, relative to the folder of `file`; empty: the file names none.
    std::string sceneSource;
    SceneSetup sceneSetup; // what the file chooses of the scene and adds to it
    std::vector<GraphVariable> variables;
    std::vector<GraphPass> passes;
    std::vector<GraphEdge> edges;
    std::vector<GraphOutput> outputs;
    std::vector<GraphFrame> frames;
    std::vector<GraphNote> notes;
    std::filesystem::path file; // where it was loaded from; a relative scene is relative to its folder

    [[nodiscard]] const GraphPass* find(std::string_view pass) const;
    [[nodiscard]] GraphPass* find(std::string_view pass);
    [[nodiscard]] const GraphVariable* variable(std::string_view variableName) const;
    // Gives a variable that stands there, and every property that follows it, this value.
    void setVariable(std::string_view variableName, const Value& value);
};

// A graph file may have at most so many of each; a text (comment, property) at most so many bytes.
inline constexpr size_t maxGraphPasses = 10'000, maxGraphEdges = 100'000, maxGraphOutputs = 10'000,
                        maxGraphVariables = 10'000, maxGraphFrames = 10'000, maxGraphNotes = 10'000,
                        maxEdgeBends = 1'000, maxGraphText = 65'536;

// Reads the JSON form ("kestrel": 1). Throws InputError with every mistake of form (unknown key, wrong kind,
// missing key), each with file:line:column. Names are not resolved here (see validate).
Graph loadGraph(const std::filesystem::path& file);
Graph parseGraph(std::string_view text, const std::string& file);

// The canonical text: keys in fixed order, one line a pass and an edge. parse and save again give the same
// bytes.
std::string saveGraph(const Graph& graph);

// Everything that is wrong with the graph against the registry: unknown types, ports, properties (near
// names), wrong kinds, values out of range, inputs connected twice or not at all, cycles with their path,
// outputs that are none. Errors come in the order of the file. Empty: valid.
std::vector<Problem> validate(const Graph& graph, const Registry& registry);

// `--set` in its forms: "pass.property=value" sets a property (which follows no variable any more),
// "variable=value" a variable with all that follows it, "pass.input=pass.output" moves (or adds) an edge,
// "pass.input=" removes it. Throws InputError naming what is unknown with its near name.
void applySetting(Graph& graph, const Registry& registry, const std::string& setting);

// JSON schema (draft 2020-12) of graph files, generated from the registry's tables.
std::string graphSchema(const Registry& registry);

} // namespace kestrel
