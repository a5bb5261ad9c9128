// Reading a graph file: its form only; names are resolved by validate().
#include "core/files.h"
#include "core/json.h"
#include "graph/graph.h"
#include "scene/setup_keys.h"
#include <algorithm>
#include <fmt/format.h>

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
        if (const Json* passes = fields.required("passes", Kind::Object)) readPasses(*passes, graph);
        if (const Json* edges = list(fields.optional("edges", Kind::Array), "edges", maxGraphEdges))
            for (const Json& edge : edges->items) readEdge(edge, graph);
        if (const Json* outputs = list(fields.optional("outputs", Kind::Array), "outputs", maxGraphOutputs))
            for (const Json& output : outputs->items)
                if (const auto port = portRef(output, "an output"))
                    graph.outputs.push_back({*port, output.where});
        fields.refuseOthers();
        return graph;
    }

private:
    void note(const Location& where, std::string message) {
        problems_.push_back({where, std::move(message)});
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

    void readPasses(const Json& passes, Graph& graph) {
        if (passes.members.size() > maxGraphPasses) {
            note(passes.where,
                 fmt::format("{} passes; at most {} are read", passes.members.size(), maxGraphPasses));
            return;
        }
        for (const Json::Member& member : passes.members) readPass(member, graph);
    }

    void readPass(const Json::Member& member, Graph& graph) {
        GraphPass pass;
        pass.name = member.key;
        pass.where = member.where;
        JsonFields fields(member.value, fmt::format("pass '{}'", member.key), problems_);
        if (member.value.kind != Kind::Object) return;
        pass.type = text(fields.required("type", Kind::String));
        if (const Json* properties = fields.optional("properties", Kind::Object))
            for (const Json::Member& property : properties->members) readProperty(property, pass);
        if (const Json* position = fields.optional("position", Kind::Array)) {
            if (position->items.size() == 2 && position->items[0].isNumber() && position->items[1].isNumber())
                pass.position = glm::dvec2(position->items[0].number, position->items[1].number);
            else
                note(position->where,
                     fmt::format("'position' of pass '{}' must be an array of two numbers", pass.name));
        }
        pass.comment = text(fields.optional("comment", Kind::String));
        fields.refuseOthers();
        graph.passes.push_back(std::move(pass));
    }

    void readProperty(const Json::Member& property, GraphPass& pass) {
        const Json& json = property.value;
        const bool numbers = json.kind == Kind::Array && !json.items.empty() && json.items.size() <= 4 &&
                             std::all_of(json.items.begin(), json.items.end(),
                                         [](const Json& item) { return item.isNumber(); });
        Value value;
        if (json.kind == Kind::Bool)
            value = json.boolean;
        else if (json.kind == Kind::Int)
            value = json.integer;
        else if (json.kind == Kind::Float)
            value = json.number;
        else if (json.kind == Kind::String)
            value = text(&json);
        else if (numbers) {
            std::vector<double> vector;
            for (const Json& item : json.items) vector.push_back(item.number);
            value = std::move(vector);
        } else {
            note(json.where,
                 fmt::format("property '{}' of pass '{}' must be true or false, a number, a string or an "
                             "array of up to 4 numbers, not {}",
                             property.key, pass.name,
                             json.kind == Kind::Array ? "another array" : json.kindName()));
            return;
        }
        pass.properties.emplace_back(property.key, std::move(value));
        pass.propertyWhere[property.key] = property.where;
    }

    void readEdge(const Json& edge, Graph& graph) {
        if (edge.kind != Kind::Array || edge.items.size() != 2) {
            note(edge.where, "an edge must be an array of two strings, [\"pass.output\", \"pass.input\"]");
            return;
        }
        const auto from = portRef(edge.items[0], "the begin of an edge");
        const auto to = portRef(edge.items[1], "the end of an edge");
        if (from && to)
            graph.edges.push_back({*from, *to, edge.where, edge.items[0].where, edge.items[1].where});
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

GraphPass* Graph::find(std::string_view pass) {
    return const_cast<GraphPass*>(std::as_const(*this).find(pass));
}

} // namespace kestrel
