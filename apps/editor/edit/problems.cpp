#include "edit/problems.h"

namespace kestrel::edit {
namespace {

bool at(const Location& place, const Location& where) {
    return place.line > 0 && place.line == where.line && place.column == where.column &&
           place.file == where.file;
}

// The first 'name' in a message that is a pass, also of 'name.port'.
std::string quotedPass(const Graph& graph, const std::string& message) {
    for (size_t begin = message.find('\''); begin != std::string::npos;
         begin = message.find('\'', begin + 1)) {
        const size_t end = message.find_first_of("'.", begin + 1);
        if (end == std::string::npos) break;
        const std::string name = message.substr(begin + 1, end - begin - 1);
        if (graph.find(name) != nullptr) return name;
    }
    return {};
}

Marked markOne(const Graph& located, const Problem& problem) {
    Marked marked{.message = problem.message, .pass = {}, .input = {}, .property = {}};
    for (const GraphPass& pass : located.passes) {
        if (at(pass.where, problem.where)) {
            marked.pass = pass.name;
            return marked;
        }
        for (const auto& [property, where] : pass.propertyWhere)
            if (at(where, problem.where)) {
                marked.pass = pass.name;
                marked.property = property;
                return marked;
            }
    }
    for (const GraphEdge& edge : located.edges)
        if (at(edge.where, problem.where) || at(edge.fromWhere, problem.where) ||
            at(edge.toWhere, problem.where)) {
            marked.pass = edge.to.pass;
            marked.input = edge.to;
            return marked;
        }
    for (const GraphOutput& output : located.outputs)
        if (at(output.where, problem.where)) {
            marked.pass = output.port.pass;
            return marked;
        }
    marked.pass = quotedPass(located, problem.message);
    return marked;
}

} // namespace

Graph locatedGraph(const Graph& graph, const std::string& text) {
    Graph located = parseGraph(text, graph.file.string());
    located.file = graph.file;
    return located;
}

std::vector<Marked> mark(const Graph& located, const std::vector<Problem>& problems) {
    std::vector<Marked> marked;
    for (const Problem& problem : problems) marked.push_back(markOne(located, problem));
    return marked;
}

} // namespace kestrel::edit
