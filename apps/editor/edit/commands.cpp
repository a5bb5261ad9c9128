#include "edit/commands.h"
#include "edit/lookup.h"
#include "graph/muted.h"
#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace kestrel::edit {
namespace {

GraphEdge& needEdge(Graph& graph, const PortRef& to) {
    GraphEdge* edge = edgeInto(graph, to);
    if (edge == nullptr) refuse(fmt::format("nothing feeds '{}'", to.text()));
    return *edge;
}

// Whether data flows from one pass to another, over one edge or many.
bool leadsTo(const Graph& graph, const std::string& from, const std::string& to) {
    Names seen;
    std::vector<std::string> open = {from};
    while (!open.empty()) {
        const std::string pass = std::move(open.back());
        open.pop_back();
        if (pass == to) return true;
        if (!seen.insert(pass).second) continue;
        for (const GraphEdge& edge : graph.edges)
            if (edge.from.pass == pass) open.push_back(edge.to.pass);
    }
    return false;
}

// What comes out at `from` when the pass is taken away: what feeds the input that stands for it, if anything.
std::optional<PortRef> behind(const Graph& graph, const Registry& registry, const PortRef& from) {
    const GraphPass* pass = graph.find(from.pass);
    const PassType* type = pass != nullptr ? registry.find(pass->type) : nullptr;
    const PortInfo* port = type != nullptr ? type->port(from.port) : nullptr;
    if (port == nullptr) return {};
    const PortInfo* input = standIn(*type, *port, [&](const std::string& name) {
        return edgeInto(graph, {from.pass, name}) != nullptr;
    });
    if (input == nullptr) return {};
    return edgeInto(graph, {from.pass, input->name})->from;
}

GraphFrame& frameOf(Graph& graph, size_t frame) {
    if (frame >= graph.frames.size()) refuse("there is no such frame");
    return graph.frames[frame];
}

GraphNote& noteOf(Graph& graph, size_t note) {
    if (note >= graph.notes.size()) refuse("there is no such note");
    return graph.notes[note];
}

} // namespace

std::string freshName(const Graph& graph, const std::string& wanted) {
    // "RayAmbientOcclusion" as a name: a word begins at a capital after a small letter, or before one.
    std::string base;
    for (size_t i = 0; i < wanted.size(); ++i) {
        const auto at = [&](size_t k) {
            return k < wanted.size() ? static_cast<unsigned char>(wanted[k]) : 0;
        };
        const unsigned char c = at(i);
        const bool begins =
            std::isupper(c) != 0 && i > 0 &&
            (std::islower(at(i - 1)) != 0 || std::isdigit(at(i - 1)) != 0 || std::islower(at(i + 1)) != 0);
        // A letter by itself stays with what follows: GBuffer is "gbuffer".
        if (begins && base.size() - (base.rfind('_') + 1) > 1) base += '_';
        if (std::isalnum(c) != 0)
            base += static_cast<char>(std::tolower(c));
        else if (!base.empty() && base.back() != '_')
            base += '_';
    }
    while (base.ends_with('_')) base.pop_back();
    if (!isGraphName(base)) base = "pass";
    // A number that is there already counts on.
    size_t digits = base.size();
    while (digits > 0 && std::isdigit(static_cast<unsigned char>(base[digits - 1])) != 0) --digits;
    const bool numbered = digits < base.size() && digits > 1 && base[digits - 1] == '_';
    const std::string stem = numbered ? base.substr(0, digits - 1) : base;
    std::string name = base.substr(0, 56);
    for (int number = 2; graph.find(name) != nullptr; ++number)
        name = fmt::format("{}_{}", stem.substr(0, 56), number);
    return name;
}

std::string addPass(Graph& graph, const Registry& registry, const std::string& type, glm::dvec2 position) {
    if (registry.find(type) == nullptr)
        refuse(fmt::format("there is no pass type '{}'{}", type, didYouMean(type, registry.names())));
    if (graph.passes.size() >= maxGraphPasses)
        refuse(fmt::format("the graph has {} passes; it may have no more", maxGraphPasses));
    GraphPass pass;
    pass.name = freshName(graph, type);
    pass.type = type;
    pass.position = position;
    graph.passes.push_back(pass);
    return pass.name;
}

void removePasses(Graph& graph, const Registry& registry, const Names& passes, bool reconnect) {
    for (const std::string& name : passes) {
        passOf(graph, name);
        if (reconnect)
            for (GraphEdge& edge : graph.edges)
                if (edge.from.pass == name && edge.to.pass != name)
                    if (const auto source = behind(graph, registry, edge.from)) edge.from = *source;
        std::erase_if(graph.edges,
                      [&](const GraphEdge& edge) { return edge.from.pass == name || edge.to.pass == name; });
        std::erase_if(graph.outputs, [&](const GraphOutput& output) { return output.port.pass == name; });
        for (GraphFrame& frame : graph.frames) std::erase(frame.passes, name);
        std::erase_if(graph.passes, [&](const GraphPass& pass) { return pass.name == name; });
    }
    std::erase_if(graph.frames, [](const GraphFrame& frame) { return frame.passes.empty(); });
}

void renamePass(Graph& graph, const std::string& from, const std::string& to) {
    GraphPass& pass = passOf(graph, from);
    if (from == to) return;
    if (!isGraphName(to))
        refuse(fmt::format(
            "'{}' is no name of a pass: lower_case letters, digits and single underscores, at most "
            "64, a letter first",
            to));
    if (graph.find(to) != nullptr) refuse(fmt::format("there is a pass '{}' already", to));
    pass.name = to;
    for (GraphEdge& edge : graph.edges) {
        if (edge.from.pass == from) edge.from.pass = to;
        if (edge.to.pass == from) edge.to.pass = to;
    }
    for (GraphOutput& output : graph.outputs)
        if (output.port.pass == from) output.port.pass = to;
    for (GraphFrame& frame : graph.frames) std::replace(frame.passes.begin(), frame.passes.end(), from, to);
}

std::vector<std::string> duplicatePasses(Graph& graph, const Names& passes, bool keepInputs,
                                         glm::dvec2 offset) {
    std::map<std::string, std::string> copies;
    std::vector<std::string> names;
    for (const std::string& name : passes) passOf(graph, name);
    const size_t before = graph.passes.size(), edges = graph.edges.size();
    for (size_t i = 0; i < before; ++i) {
        if (!passes.contains(graph.passes[i].name)) continue;
        GraphPass copy = graph.passes[i];
        copy.name = freshName(graph, copy.name);
        if (copy.position) *copy.position += offset;
        copies.emplace(graph.passes[i].name, copy.name);
        names.push_back(copy.name);
        graph.passes.push_back(std::move(copy));
    }
    for (size_t i = 0; i < edges; ++i) {
        GraphEdge edge = graph.edges[i];
        const auto to = copies.find(edge.to.pass), from = copies.find(edge.from.pass);
        if (to == copies.end() || (from == copies.end() && !keepInputs)) continue;
        edge.to.pass = to->second;
        if (from != copies.end()) edge.from.pass = from->second;
        edge.bends.clear();
        graph.edges.push_back(std::move(edge));
    }
    return names;
}

void setMuted(Graph& graph, const Names& passes, bool muted) {
    for (const std::string& name : passes) passOf(graph, name).muted = muted;
}

void movePasses(Graph& graph, const Names& passes, glm::dvec2 by) {
    for (const std::string& name : passes) {
        GraphPass& pass = passOf(graph, name);
        pass.position = pass.position.value_or(glm::dvec2(0)) + by;
    }
    for (GraphEdge& edge : graph.edges)
        if (passes.contains(edge.from.pass) && passes.contains(edge.to.pass))
            for (glm::dvec2& bend : edge.bends) bend += by;
}

void setComment(Graph& graph, const std::string& pass, const std::string& comment) {
    if (comment.size() > maxGraphText) refuse(fmt::format("a comment has at most {} bytes", maxGraphText));
    passOf(graph, pass).comment = comment;
}

std::string whyNot(const Graph& graph, const Registry& registry, const PortRef& from, const PortRef& to) {
    const auto find = [&](const PortRef& ref, PortDirection wanted) -> const PortInfo* {
        const GraphPass* pass = graph.find(ref.pass);
        const PassType* type = pass != nullptr ? registry.find(pass->type) : nullptr;
        const PortInfo* port = type != nullptr ? type->port(ref.port) : nullptr;
        return port != nullptr && port->direction == wanted ? port : nullptr;
    };
    const PortInfo* output = find(from, PortDirection::Output);
    const PortInfo* input = find(to, PortDirection::Input);
    if (output == nullptr) return fmt::format("'{}' is no output", from.text());
    if (input == nullptr) return fmt::format("'{}' is no input", to.text());
    if (output->kind != input->kind)
        return fmt::format("a {} cannot feed a {} port", portKindName(output->kind),
                           portKindName(input->kind));
    if (const std::string mistake = contentMistake(output->content, input->content); !mistake.empty())
        return fmt::format("'{}' carries {}", from.text(), mistake);
    if (leadsTo(graph, to.pass, from.pass))
        return fmt::format("'{}' needs what '{}' makes: the edge would close a cycle", from.pass, to.pass);
    return {};
}

void connect(Graph& graph, const Registry& registry, const PortRef& from, const PortRef& to) {
    if (const std::string why = whyNot(graph, registry, from, to); !why.empty()) refuse(why);
    if (GraphEdge* edge = edgeInto(graph, to)) {
        if (edge->from != from) *edge = {from, to, {}};
        return;
    }
    if (graph.edges.size() >= maxGraphEdges)
        refuse(fmt::format("the graph has {} edges; it may have no more", maxGraphEdges));
    graph.edges.push_back({from, to, {}});
}

void disconnect(Graph& graph, const std::vector<PortRef>& inputs) {
    for (const PortRef& input : inputs) needEdge(graph, input);
    std::erase_if(graph.edges, [&](const GraphEdge& edge) {
        return std::find(inputs.begin(), inputs.end(), edge.to) != inputs.end();
    });
}

void moveEdgeBegin(Graph& graph, const Registry& registry, const PortRef& to, const PortRef& newFrom) {
    needEdge(graph, to);
    connect(graph, registry, newFrom, to);
}

void moveEdgeEnd(Graph& graph, const Registry& registry, const PortRef& to, const PortRef& newTo, bool copy) {
    const PortRef from = needEdge(graph, to).from;
    if (newTo == to) return;
    // Without the old edge: a cycle that only it would close is none.
    Graph without = graph;
    if (!copy) std::erase_if(without.edges, [&](const GraphEdge& edge) { return edge.to == to; });
    connect(without, registry, from, newTo);
    graph.edges = std::move(without.edges);
}

void insertOnEdge(Graph& graph, const Registry& registry, const PortRef& to, const std::string& pass) {
    const PortRef from = needEdge(graph, to).from;
    if (from.pass == pass || to.pass == pass) refuse(fmt::format("the edge is one of '{}' already", pass));
    const PassType& type = typeOf(graph, registry, pass);
    Graph without = graph;
    std::erase_if(without.edges, [&](const GraphEdge& edge) { return edge.to == to; });
    for (const std::string& input : type.portNames(PortDirection::Input)) {
        if (edgeInto(without, {pass, input}) != nullptr ||
            !whyNot(without, registry, from, {pass, input}).empty())
            continue;
        for (const std::string& output : type.portNames(PortDirection::Output)) {
            Graph trial = without;
            connect(trial, registry, from, {pass, input});
            if (!whyNot(trial, registry, {pass, output}, to).empty()) continue;
            connect(trial, registry, {pass, output}, to);
            graph.edges = std::move(trial.edges);
            return;
        }
    }
    refuse(fmt::format("no free input and output of '{}' fit between '{}' and '{}'", pass, from.text(),
                       to.text()));
}

void setBends(Graph& graph, const PortRef& to, std::vector<glm::dvec2> bends) {
    if (bends.size() > maxEdgeBends) refuse(fmt::format("an edge bends at most {} times", maxEdgeBends));
    needEdge(graph, to).bends = std::move(bends);
}

void setOutput(Graph& graph, const Registry& registry, const PortRef& port, bool isOutput) {
    const PortInfo* info = typeOf(graph, registry, port.pass).port(port.port);
    if (info == nullptr || info->direction != PortDirection::Output || isModule(info->kind))
        refuse(fmt::format("'{}' is no texture or buffer that a pass gives out", port.text()));
    const auto found = std::find_if(graph.outputs.begin(), graph.outputs.end(),
                                    [&](const GraphOutput& output) { return output.port == port; });
    if (isOutput && found == graph.outputs.end()) graph.outputs.push_back({port, {}});
    if (!isOutput && found != graph.outputs.end()) graph.outputs.erase(found);
}

void addFrame(Graph& graph, const std::string& title, const Names& passes) {
    if (passes.empty()) refuse("a frame goes around passes: select some");
    GraphFrame frame{.title = title, .passes = {}, .where = {}};
    for (const std::string& name : passes) passOf(graph, name);
    for (const GraphPass& pass : graph.passes)
        if (passes.contains(pass.name)) frame.passes.push_back(pass.name);
    // A pass lies in one frame.
    for (GraphFrame& other : graph.frames)
        std::erase_if(other.passes, [&](const std::string& pass) { return passes.contains(pass); });
    std::erase_if(graph.frames, [](const GraphFrame& other) { return other.passes.empty(); });
    graph.frames.push_back(std::move(frame));
}

void renameFrame(Graph& graph, size_t frame, const std::string& title) {
    frameOf(graph, frame).title = title;
}

void removeFrame(Graph& graph, size_t frame) {
    frameOf(graph, frame);
    graph.frames.erase(graph.frames.begin() + static_cast<std::ptrdiff_t>(frame));
}

void addNote(Graph& graph, const std::string& text, glm::dvec2 position) {
    graph.notes.push_back({text, position});
}

void setNote(Graph& graph, size_t note, const std::string& text, glm::dvec2 position) {
    noteOf(graph, note) = {text, position};
}

void removeNote(Graph& graph, size_t note) {
    noteOf(graph, note);
    graph.notes.erase(graph.notes.begin() + static_cast<std::ptrdiff_t>(note));
}

} // namespace kestrel::edit
