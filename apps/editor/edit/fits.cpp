#include "edit/fits.h"
#include "edit/lookup.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::edit {
namespace {

struct Place {
    const PassType* type = nullptr;
    const PortInfo* port = nullptr;
};

Place placeOf(const Graph& graph, const Registry& registry, const PortRef& ref) {
    const GraphPass* pass = graph.find(ref.pass);
    const PassType* type = pass != nullptr ? registry.find(pass->type) : nullptr;
    const PortInfo* port = type != nullptr ? type->port(ref.port) : nullptr;
    if (port == nullptr || port->direction == PortDirection::Internal)
        refuse(fmt::format("'{}' is no port that an edge could have", ref.text()));
    return {type, port};
}

// Whether an edge could join the two, whichever is the output.
bool fits(const PortInfo& a, const PortInfo& b) {
    if (a.kind != b.kind || a.direction == b.direction) return false;
    if (a.direction == PortDirection::Internal || b.direction == PortDirection::Internal) return false;
    const bool out = a.direction == PortDirection::Output;
    return contentMistake(out ? a.content : b.content, out ? b.content : a.content).empty();
}

// Outputs of a pass that an edge or the graph's outputs read.
std::set<std::string> outputsRead(const Graph& graph, const std::string& pass) {
    std::set<std::string> ports;
    for (const GraphEdge& edge : graph.edges)
        if (edge.from.pass == pass) ports.insert(edge.from.port);
    for (const GraphOutput& output : graph.outputs)
        if (output.port.pass == pass) ports.insert(output.port.port);
    return ports;
}

// The output of `type` that serves who read `port`: of the same name and kind, else the first of the kind.
const PortInfo* substitute(const PassType& type, const PortInfo& port) {
    const auto serves = [&](const PortInfo& candidate) {
        return candidate.direction == PortDirection::Output && candidate.kind == port.kind &&
               contentMistake(candidate.content, port.content).empty();
    };
    if (const PortInfo* same = type.port(port.name); same != nullptr && serves(*same)) return same;
    // Textures and buffers of another name are something else; modules of a kind are what can be swapped.
    if (!isModule(port.kind)) return nullptr;
    const auto found = std::find_if(type.ports.begin(), type.ports.end(), serves);
    return found == type.ports.end() ? nullptr : &*found;
}

bool canReplace(const PassType& type, const PassType& old, const std::set<std::string>& read) {
    if (read.empty())
        return std::any_of(old.ports.begin(), old.ports.end(), [&](const PortInfo& port) {
            return port.direction == PortDirection::Output && isModule(port.kind) &&
                   substitute(type, port) != nullptr;
        });
    return std::all_of(read.begin(), read.end(), [&](const std::string& name) {
        const PortInfo* port = old.port(name);
        return port != nullptr && substitute(type, *port) != nullptr;
    });
}

std::string edgeText(const PortRef& from, const PortRef& to) { return from.text() + " -> " + to.text(); }

// Moves what reads `pass` to the outputs that serve it; of edges and of the graph's outputs.
void moveReaders(Graph& graph, const Registry& registry, const PassType& old, const std::string& pass,
                 const PassType& type, const std::string& rival, Swapped& swapped) {
    std::vector<GraphEdge> edges = std::move(graph.edges);
    graph.edges.clear();
    // What does not lead away from the pass stands first, so that a cycle is seen; the order of the file
    // stays.
    for (const GraphEdge& edge : edges)
        if (edge.from.pass != pass) graph.edges.push_back(edge);
    std::vector<GraphEdge> ordered;
    for (GraphEdge& edge : edges) {
        if (edge.from.pass != pass) {
            ordered.push_back(std::move(edge));
            continue;
        }
        const PortInfo* port = old.port(edge.from.port);
        const PortInfo* instead = port != nullptr ? substitute(type, *port) : nullptr;
        const PortRef from{rival, instead != nullptr ? instead->name : edge.from.port};
        const std::string why = instead == nullptr ? fmt::format("'{}' has no output of the kind", type.name)
                                                   : whyNot(graph, registry, from, edge.to);
        if (!why.empty()) {
            swapped.dropped.push_back(fmt::format("{}: {}", edgeText(edge.from, edge.to), why));
            continue;
        }
        edge.from = from;
        swapped.kept.push_back(edgeText(edge.from, edge.to));
        ordered.push_back(std::move(edge));
    }
    graph.edges = std::move(ordered);
    std::vector<GraphOutput> outputs;
    for (GraphOutput& output : graph.outputs) {
        if (output.port.pass == pass) {
            const PortInfo* port = old.port(output.port.port);
            const PortInfo* instead = port != nullptr ? substitute(type, *port) : nullptr;
            if (instead == nullptr) {
                swapped.dropped.push_back(fmt::format("the output {}: '{}' has none of the name and kind",
                                                      output.port.text(), type.name));
                continue;
            }
            output.port = {rival, instead->name};
        }
        if (std::none_of(outputs.begin(), outputs.end(),
                         [&](const GraphOutput& other) { return other.port == output.port; }))
            outputs.push_back(std::move(output));
    }
    graph.outputs = std::move(outputs);
}

void keepInputs(Graph& graph, const Registry& registry, const PassType& type, const std::string& pass,
                const std::vector<GraphEdge>& before, Swapped& swapped) {
    std::vector<const GraphEdge*> left;
    const auto take = [&](const GraphEdge& edge, const std::string& port) {
        GraphEdge kept = edge;
        kept.to.port = port;
        swapped.kept.push_back(edgeText(kept.from, kept.to));
        graph.edges.push_back(std::move(kept));
    };
    for (const GraphEdge& edge : before)
        if (type.port(edge.to.port) != nullptr && whyNot(graph, registry, edge.from, edge.to).empty())
            take(edge, edge.to.port);
        else
            left.push_back(&edge);
    for (const GraphEdge* edge : left) {
        std::string why = fmt::format("'{}' has no free input that fits", type.name);
        bool found = false;
        for (const std::string& input : type.portNames(PortDirection::Input)) {
            const PortRef to{pass, input};
            if (edgeInto(graph, to) != nullptr || !whyNot(graph, registry, edge->from, to).empty()) continue;
            // A texture goes to a port of another name only where both say that they carry the same.
            const Place from = placeOf(graph, registry, edge->from);
            const PortInfo* port = type.port(input);
            if (!isModule(port->kind) && (port->content == Content{} || port->content != from.port->content))
                continue;
            take(*edge, input);
            found = true;
            break;
        }
        if (!found) swapped.dropped.push_back(fmt::format("{}: {}", edgeText(edge->from, edge->to), why));
    }
}

} // namespace

std::vector<Offer> offersFor(const Graph& graph, const Registry& registry, const PortRef& port) {
    const Place place = placeOf(graph, registry, port);
    std::vector<Offer> offers;
    for (const PassType& type : registry.types())
        for (const PortInfo& candidate : type.ports)
            if (fits(*place.port, candidate)) {
                offers.push_back({type.name, candidate.name, type.description});
                break;
            }
    return offers;
}

std::optional<PortRef> fittingPort(const Graph& graph, const Registry& registry, const PortRef& port,
                                   const std::string& pass) {
    const Place place = placeOf(graph, registry, port);
    const GraphPass* target = graph.find(pass);
    const PassType* type = target != nullptr ? registry.find(target->type) : nullptr;
    if (type == nullptr) return {};
    const bool pulledOut = place.port->direction == PortDirection::Output;
    std::vector<const PortInfo*> found;
    for (const PortInfo& candidate : type->ports) {
        const PortRef other{pass, candidate.name};
        if (fits(*place.port, candidate) &&
            whyNot(graph, registry, pulledOut ? port : other, pulledOut ? other : port).empty())
            found.push_back(&candidate);
    }
    const auto narrow = [&](const auto& prefers) {
        std::vector<const PortInfo*> better;
        std::copy_if(found.begin(), found.end(), std::back_inserter(better), prefers);
        if (!better.empty()) found = std::move(better);
    };
    // A port of the same name is meant before all others.
    narrow([&](const PortInfo* candidate) { return candidate->name == port.port; });
    narrow([&](const PortInfo* candidate) {
        return !pulledOut || edgeInto(graph, {pass, candidate->name}) == nullptr;
    });
    narrow([&](const PortInfo* candidate) { return candidate->content == place.port->content; });
    narrow([&](const PortInfo* candidate) { return !pulledOut || !candidate->optional; });
    if (found.size() != 1) return {};
    return PortRef{pass, found.front()->name};
}

std::string addJoined(Graph& graph, const Registry& registry, const PortRef& port, const Offer& offer,
                      glm::dvec2 position) {
    const Place place = placeOf(graph, registry, port);
    Graph next = graph;
    std::string name = addPass(next, registry, offer.type, position);
    const PortRef other{name, offer.port};
    const bool pulledOut = place.port->direction == PortDirection::Output;
    connect(next, registry, pulledOut ? port : other, pulledOut ? other : port);
    graph = std::move(next);
    return name;
}

std::vector<std::string> rivalTypes(const Graph& graph, const Registry& registry, const std::string& pass) {
    const GraphPass* target = graph.find(pass);
    const PassType* old = target != nullptr ? registry.find(target->type) : nullptr;
    std::vector<std::string> names;
    if (old == nullptr) return names;
    const std::set<std::string> read = outputsRead(graph, pass);
    for (const PassType& type : registry.types())
        if (type.name != old->name && canReplace(type, *old, read)) names.push_back(type.name);
    return names;
}

std::vector<std::string> rivalPasses(const Graph& graph, const Registry& registry, const std::string& pass) {
    const GraphPass* target = graph.find(pass);
    const PassType* old = target != nullptr ? registry.find(target->type) : nullptr;
    std::vector<std::string> names;
    if (old == nullptr) return names;
    const std::set<std::string> read = outputsRead(graph, pass);
    for (const GraphPass& other : graph.passes) {
        const PassType* type = registry.find(other.type);
        if (other.name != pass && type != nullptr && !read.empty() && canReplace(*type, *old, read))
            names.push_back(other.name);
    }
    return names;
}

Swapped swapType(Graph& graph, const Registry& registry, const std::string& pass, const std::string& type) {
    const PassType& old = typeOf(graph, registry, pass);
    const PassType* now = registry.find(type);
    if (now == nullptr)
        refuse(fmt::format("there is no pass type '{}'{}", type, didYouMean(type, registry.names())));
    Swapped swapped;
    Graph next = graph;
    GraphPass& target = *next.find(pass);
    target.type = type;
    std::vector<std::pair<std::string, Value>> properties;
    for (auto& [name, value] : target.properties) {
        const PropertyInfo* info = now->property(name);
        const auto mistake = info != nullptr ? valueMistake(*info, value) : std::optional<std::string>();
        if (info != nullptr && !mistake) {
            properties.emplace_back(name, value);
            continue;
        }
        swapped.dropped.push_back(info == nullptr
                                      ? fmt::format("the property {}: '{}' has none of that name", name, type)
                                      : fmt::format("the property {}: it {}", name, *mistake));
        target.bound.erase(name);
    }
    target.properties = std::move(properties);
    target.propertyWhere.clear();

    std::vector<GraphEdge> into;
    std::vector<GraphEdge> others;
    for (GraphEdge& edge : next.edges) (edge.to.pass == pass ? into : others).push_back(std::move(edge));
    next.edges = std::move(others);
    keepInputs(next, registry, *now, pass, into, swapped);
    moveReaders(next, registry, old, pass, *now, pass, swapped);
    graph = std::move(next);
    return swapped;
}

Swapped useInstead(Graph& graph, const Registry& registry, const std::string& pass,
                   const std::string& rival) {
    const PassType& old = typeOf(graph, registry, pass);
    const PassType& type = typeOf(graph, registry, rival);
    if (pass == rival) refuse(fmt::format("'{}' is used already", pass));
    Swapped swapped;
    Graph next = graph;
    moveReaders(next, registry, old, pass, type, rival, swapped);
    graph = std::move(next);
    return swapped;
}

} // namespace kestrel::edit
