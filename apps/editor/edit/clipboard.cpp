#include "edit/clipboard.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::edit {
namespace {

// The names of what is pasted, and of its variables, in the graph that takes it.
struct Taken {
    std::map<std::string, std::string> passes, variables;
};

void pasteVariables(Graph& graph, const Graph& piece, Taken& taken) {
    for (const GraphVariable& variable : piece.variables) {
        std::string name = variable.name;
        const auto text = [](const Value& value) {
            GraphPass held;
            held.properties.emplace_back("value", value);
            Graph alone;
            alone.passes.push_back(std::move(held));
            return saveGraph(alone);
        };
        for (int number = 2;; ++number) {
            const GraphVariable* held = graph.variable(name);
            if (held == nullptr) graph.variables.push_back({name, variable.value, {}});
            if (held == nullptr || text(held->value) == text(variable.value)) break;
            name = fmt::format("{}_{}", variable.name.substr(0, 56), number);
        }
        taken.variables.emplace(variable.name, name);
    }
}

glm::dvec2 middleOf(const Graph& piece) {
    std::optional<glm::dvec2> low, high;
    for (const GraphPass& pass : piece.passes) {
        if (!pass.position) continue;
        low = low ? glm::min(*low, *pass.position) : *pass.position;
        high = high ? glm::max(*high, *pass.position) : *pass.position;
    }
    return low ? (*low + *high) * 0.5 : glm::dvec2(0);
}

void pasteEdges(Graph& graph, const Registry& registry, const Graph& piece, const Taken& taken,
                glm::dvec2 moved, Pasted& pasted) {
    for (GraphEdge edge : piece.edges) {
        const auto to = taken.passes.find(edge.to.pass), from = taken.passes.find(edge.from.pass);
        if (to == taken.passes.end()) continue; // leads to a pass that was not copied
        edge.to.pass = to->second;
        edge.where = edge.fromWhere = edge.toWhere = {};
        if (from != taken.passes.end()) {
            edge.from.pass = from->second;
            for (glm::dvec2& bend : edge.bends) bend += moved;
            graph.edges.push_back(std::move(edge));
            continue;
        }
        edge.bends.clear();
        if (const std::string why = whyNot(graph, registry, edge.from, edge.to); why.empty())
            graph.edges.push_back(std::move(edge));
        else
            pasted.remarks.push_back(
                fmt::format("'{}' is not fed by '{}': {}", edge.to.text(), edge.from.text(), why));
    }
}

} // namespace

std::string copyText(const Graph& graph, const Names& passes, bool keepInputs) {
    Graph piece;
    Names variables;
    for (const GraphPass& pass : graph.passes) {
        if (!passes.contains(pass.name)) continue;
        piece.passes.push_back(pass);
        for (const auto& [property, variable] : pass.bound) variables.insert(variable);
    }
    for (const GraphVariable& variable : graph.variables)
        if (variables.contains(variable.name)) piece.variables.push_back(variable);
    for (const GraphEdge& edge : graph.edges)
        if (passes.contains(edge.to.pass) && (keepInputs || passes.contains(edge.from.pass)))
            piece.edges.push_back(edge);
    for (const GraphFrame& frame : graph.frames)
        if (std::all_of(frame.passes.begin(), frame.passes.end(),
                        [&](const std::string& pass) { return passes.contains(pass); }))
            piece.frames.push_back(frame);
    return saveGraph(piece);
}

Pasted pasteText(Graph& graph, const Registry& registry, const std::string& text, glm::dvec2 middle) {
    const Graph piece = parseGraph(text, "the clipboard");
    if (graph.passes.size() + piece.passes.size() > maxGraphPasses ||
        graph.edges.size() + piece.edges.size() > maxGraphEdges)
        throw InputError(Location{}, fmt::format("the graph would have more than {} passes or {} edges",
                                                 maxGraphPasses, maxGraphEdges));
    Graph next = graph;
    Taken taken;
    Pasted pasted;
    pasteVariables(next, piece, taken);
    const glm::dvec2 moved = middle - middleOf(piece);
    for (GraphPass pass : piece.passes) {
        const std::string name = freshName(next, pass.name);
        taken.passes.emplace(pass.name, name);
        pasted.passes.push_back(name);
        pass.name = name;
        pass.where = {};
        pass.propertyWhere.clear();
        if (pass.position) *pass.position += moved;
        for (auto& [property, variable] : pass.bound) variable = taken.variables.at(variable);
        next.passes.push_back(std::move(pass));
    }
    pasteEdges(next, registry, piece, taken, moved, pasted);
    for (GraphFrame frame : piece.frames) {
        for (std::string& pass : frame.passes) pass = taken.passes.at(pass);
        next.frames.push_back(std::move(frame));
    }
    for (GraphNote note : piece.notes) {
        note.position += moved;
        next.notes.push_back(std::move(note));
    }
    graph = std::move(next);
    return pasted;
}

} // namespace kestrel::edit
