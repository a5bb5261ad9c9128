// Reading a graph file: its form only; names are resolved by validate().
#include "core/files.h"
#include "core/json.h"
#include "core/problems.h"
#include "graph/graph.h"
#include "scene/setup_keys.h"
#include <algorithm>
#include <fmt/format.h>
#include <unordered_map>
#include <unordered_set>

namespace kestrel {
namespace {

using Kind = Json::Kind;

class Loader {
public:
    explicit Loader(std::vector<Problem>& problems)
        : problems_(problems) {}

    Graph read(const Json& root) {
        Graph graph;
        JsonFields fields(root, "the graph", problems_);
        if (root.kind != Kind::Object) return graph;
        if (const Json* version = fields.required("kestrel", Kind::Int); version && version->integer != 1)
            note(version->where,
                 fmt::format("'kestrel' (the version of the format) must be 1, not {}", version->integer));
        graph.name = text(fields.optional("name", Kind::String));
        graph.comment = text(fields.optional("comment", Kind::String));
        if (const Json* scene = fields.optional("scene")) readScene(*scene, graph);
        // Before the passes, whose properties name them.
        if (const Json* variables = fields.optional("variables", Kind::Object))
            readVariables(*variables, graph);
        if (const Json* passes = fields.required("passes", Kind::Object)) readPasses(*passes, graph);
        if (const Json* edges = list(fields.optional("edges", Kind::Array), "edges", maxGraphEdges))
            for (const Json& edge : edges->items) readEdge(edge, graph);
        if (const Json* outputs = list(fields.optional("outputs", Kind::Array), "outputs", maxGraphOutputs))
            for (const Json& output : outputs->items)
                if (const auto port = portRef(output, "an output"))
                    graph.outputs.push_back({*port, output.where});
        if (const Json* frames = list(fields.optional("frames", Kind::Array), "frames", maxGraphFrames))
            for (const Json& frame : frames->items) readFrame(frame, graph);
        if (const Json* notes = list(fields.optional("notes", Kind::Array), "notes", maxGraphNotes))
            for (const Json& remark : notes->items) readNote(remark, graph);
        fields.refuseOthers();
        return graph;
    }

private:
    void note(const Location& where, std::string message) {
        noteProblem(problems_, where, std::move(message));
    }

    std::string text(const Json* value) {
        if (value == nullptr) return {};
        if (value->text.size() <= maxGraphText) return value->text;
        note(value->where,
             fmt::format("a text of {} bytes; at most {} are read", value->text.size(), maxGraphText));
        return {};
    }

    const Json* list(const Json* value, const char* what, size_t limit) {
        if (value == nullptr || value->items.size() <= limit) return value;
        note(value->where, fmt::format("{} {}; at most {} are read", value->items.size(), what, limit));
        return nullptr;
    }

    void readScene(const Json& scene, Graph& graph) {
        JsonFields fields(scene, "the scene", problems_);
        if (scene.kind != Kind::Object) return;
        graph.sceneSource = text(fields.optional("source", Kind::String));
        sceneSetupKeys().readFields(problems_, fields, scene, graph.sceneSetup);
        fields.refuseOthers();
    }

    void readVariables(const Json& variables, Graph& graph) {
        if (variables.members.size() > maxGraphVariables) {
            note(variables.where, fmt::format("{} variables; at most {} are read", variables.members.size(),
                                              maxGraphVariables));
            return;
        }
        for (const Json::Member& member : variables.members) {
            GraphVariable variable{.name = member.key, .value = {}, .where = member.where};
            if (!isGraphName(member.key))
                note(member.where,
                     fmt::format("the variable name '{}' must be like that of a pass: lower_case "
                                 "letters, digits and single underscores",
                                 member.key));
            if (auto value = readValue(member.value, fmt::format("variable '{}'", member.key))) {
                variable.value = std::move(*value);
                variables_.emplace(variable.name, graph.variables.size());
                graph.variables.push_back(std::move(variable));
            }
        }
    }

    // A point of the canvas; notes what else stands there.
    std::optional<glm::dvec2> readPoint(const Json& json, const std::string& what) {
        if (json.kind == Kind::Array && json.items.size() == 2 && json.items[0].isNumber() &&
            json.items[1].isNumber())
            return glm::dvec2(json.items[0].number, json.items[1].number);
        note(json.where, fmt::format("{} must be an array of two numbers", what));
        return {};
    }

    void readFrame(const Json& frame, Graph& graph) {
        JsonFields fields(frame, "a frame", problems_);
        if (frame.kind != Kind::Object) return;
        GraphFrame made{
            .title = text(fields.required("title", Kind::String)), .passes = {}, .where = frame.where};
        if (const Json* passes =
                list(fields.required("passes", Kind::Array), "passes of a frame", maxGraphPasses))
            for (const Json& pass : passes->items) {
                if (pass.kind != Kind::String)
                    note(pass.where,
                         fmt::format("a pass of a frame must be a string, not {}", pass.kindName()));
                else if (!passes_.contains(pass.text))
                    note(pass.where, fmt::format("there is no pass '{}' (in frame '{}'){}", pass.text,
                                                 made.title, didYouMean(pass.text, passNames(graph))));
                else
                    made.passes.push_back(pass.text);
            }
        fields.refuseOthers();
        graph.frames.push_back(std::move(made));
    }

    static std::vector<std::string> passNames(const Graph& graph) {
        std::vector<std::string> names;
        for (const GraphPass& pass : graph.passes) names.push_back(pass.name);
        return names;
    }

    void readNote(const Json& json, Graph& graph) {
        JsonFields fields(json, "a note", problems_);
        if (json.kind != Kind::Object) return;
        GraphNote made{.text = text(fields.required("text", Kind::String)), .position = {}};
        if (const Json* position = fields.required("position", Kind::Array))
            if (const auto point = readPoint(*position, "'position' of a note")) made.position = *point;
        fields.refuseOthers();
        graph.notes.push_back(std::move(made));
    }

    void readPasses(const Json& passes, Graph& graph) {
        if (passes.members.size() > maxGraphPasses) {
            note(passes.where,
                 fmt::format("{} passes; at most {} are read", passes.members.size(), maxGraphPasses));
            return;
        }
        for (const Json::Member& member : passes.members) readPass(member, graph);
        for (const GraphPass& pass : graph.passes) passes_.insert(pass.name);
    }

    void readPass(const Json::Member& member, Graph& graph) {
        GraphPass pass;
        pass.name = member.key;
        pass.where = member.where;
        JsonFields fields(member.value, fmt::format("pass '{}'", member.key), problems_);
        if (member.value.kind != Kind::Object) return;
        pass.type = text(fields.required("type", Kind::String));
        if (const Json* properties = fields.optional("properties", Kind::Object))
            for (const Json::Member& property : properties->members) readProperty(property, pass, graph);
        if (const Json* muted = fields.optional("muted", Kind::Bool)) pass.muted = muted->boolean;
        if (const Json* position = fields.optional("position", Kind::Array))
            pass.position = readPoint(*position, fmt::format("'position' of pass '{}'", pass.name));
        pass.comment = text(fields.optional("comment", Kind::String));
        fields.refuseOthers();
        graph.passes.push_back(std::move(pass));
    }

    void readProperty(const Json::Member& property, GraphPass& pass, const Graph& graph) {
        const std::string what = fmt::format("property '{}' of pass '{}'", property.key, pass.name);
        pass.propertyWhere[property.key] = property.where;
        if (property.value.kind == Kind::Object) {
            followVariable(property, what, pass, graph);
        } else if (auto value = readValue(property.value, what)) {
            pass.properties.emplace_back(property.key, std::move(*value));
        }
    }

    // { "variable": "NAME" } in the place of a value.
    void followVariable(const Json::Member& property, const std::string& what, GraphPass& pass,
                        const Graph& graph) {
        JsonFields fields(property.value, what, problems_);
        const Json* name = fields.required("variable", Kind::String);
        fields.refuseOthers();
        if (name == nullptr) return;
        if (const auto found = variables_.find(name->text); found != variables_.end()) {
            pass.properties.emplace_back(property.key, graph.variables[found->second].value);
            pass.bound[property.key] = found->first;
            return;
        }
        std::vector<std::string> names;
        for (const GraphVariable& candidate : graph.variables) names.push_back(candidate.name);
        note(name->where, fmt::format("{} follows the variable '{}', which the graph has not{}", what,
                                      text(name), didYouMean(name->text, names)));
    }

    std::optional<Value> readValue(const Json& json, const std::string& what) {
        const bool numbers = json.kind == Kind::Array && !json.items.empty() && json.items.size() <= 4 &&
                             std::all_of(json.items.begin(), json.items.end(),
                                         [](const Json& item) { return item.isNumber(); });
        if (json.kind == Kind::Bool) return json.boolean;
        if (json.kind == Kind::Int) return json.integer;
        if (json.kind == Kind::Float) return json.number;
        if (json.kind == Kind::String) return text(&json);
        if (numbers) {
            std::vector<double> vector;
            for (const Json& item : json.items) vector.push_back(item.number);
            return vector;
        }
        note(json.where, fmt::format("{} must be true or false, a number, a string or an array of up to 4 "
                                     "numbers, not {}",
                                     what, json.kind == Kind::Array ? "another array" : json.kindName()));
        return {};
    }

    void readEdge(const Json& edge, Graph& graph) {
        if (edge.kind != Kind::Array || (edge.items.size() != 2 && edge.items.size() != 3)) {
            note(edge.where,
                 "an edge must be an array of two strings, [\"pass.output\", \"pass.input\"], and "
                 "where it bends on the canvas a list of points");
            return;
        }
        const auto from = portRef(edge.items[0], "the begin of an edge");
        const auto to = portRef(edge.items[1], "the end of an edge");
        std::vector<glm::dvec2> bends;
        if (edge.items.size() == 3) {
            if (edge.items[2].kind != Kind::Array)
                note(edge.items[2].where, "the bends of an edge must be an array of points");
            else if (const Json* points = list(&edge.items[2], "bends of an edge", maxEdgeBends))
                for (const Json& point : points->items)
                    if (const auto read = readPoint(point, "a bend of an edge")) bends.push_back(*read);
        }
        if (from && to)
            graph.edges.push_back(
                {*from, *to, edge.where, edge.items[0].where, edge.items[1].where, std::move(bends)});
    }

    std::optional<PortRef> portRef(const Json& json, const char* what) {
        if (json.kind != Kind::String) {
            note(json.where, fmt::format("{} must be a string \"pass.port\", not {}", what, json.kindName()));
            return {};
        }
        auto port = parsePortRef(json.text);
        if (!port) note(json.where, fmt::format("{} must be \"pass.port\", not '{}'", what, text(&json)));
        return port;
    }

    std::vector<Problem>& problems_;
    std::unordered_set<std::string> passes_;            // names
    std::unordered_map<std::string, size_t> variables_; // name -> index
};

} // namespace

std::optional<PortRef> parsePortRef(std::string_view text) {
    const size_t dot = text.find('.');
    if (dot == std::string_view::npos || dot == 0 || dot + 1 == text.size()) return {};
    if (text.find('.', dot + 1) != std::string_view::npos) return {};
    return PortRef{std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

Graph parseGraph(std::string_view text, const std::string& file) {
    std::vector<Problem> problems;
    Graph graph = Loader(problems).read(Json::parse(text, file));
    if (!problems.empty()) throw InputError(std::move(problems));
    graph.file = file;
    return graph;
}

Graph loadGraph(const std::filesystem::path& file) {
    Graph graph = parseGraph(readGivenText(file), file.string());
    // What comes through a pipe lies nowhere: scenes are named from the working folder.
    if (isStream(file)) graph.file = file.filename();
    return graph;
}

const GraphPass* Graph::find(std::string_view pass) const {
    const auto found = std::find_if(passes.begin(), passes.end(),
                                    [&](const GraphPass& candidate) { return candidate.name == pass; });
    return found == passes.end() ? nullptr : &*found;
}

const GraphVariable* Graph::variable(std::string_view variableName) const {
    const auto found = std::find_if(variables.begin(), variables.end(), [&](const GraphVariable& candidate) {
        return candidate.name == variableName;
    });
    return found == variables.end() ? nullptr : &*found;
}

void Graph::setVariable(std::string_view variableName, const Value& value) {
    for (GraphVariable& variable : variables)
        if (variable.name == variableName) variable.value = value;
    for (GraphPass& pass : passes)
        for (auto& [property, held] : pass.properties)
            if (const auto follows = pass.bound.find(property);
                follows != pass.bound.end() && follows->second == variableName)
                held = value;
}

GraphPass* Graph::find(std::string_view pass) {
    return const_cast<GraphPass*>(std::as_const(*this).find(pass));
}

} // namespace kestrel
