#include "edit/lookup.h"
#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace kestrel::edit {

void refuse(const std::string& message) { throw InputError(Location{}, message); }

GraphPass& passOf(Graph& graph, const std::string& name) {
    if (GraphPass* pass = graph.find(name)) return *pass;
    std::vector<std::string> names;
    for (const GraphPass& pass : graph.passes) names.push_back(pass.name);
    refuse(fmt::format("there is no pass '{}'{}", name, didYouMean(name, names)));
}

const PassType& typeOf(const Graph& graph, const Registry& registry, const std::string& pass) {
    const GraphPass& found = passOf(const_cast<Graph&>(graph), pass);
    const PassType* type = registry.find(found.type);
    if (type == nullptr) refuse(fmt::format("pass '{}' has the unknown type '{}'", pass, found.type));
    return *type;
}

const PropertyInfo& propertyOf(const Registry& registry, const GraphPass& pass, const std::string& property) {
    const PassType* type = registry.find(pass.type);
    const PropertyInfo* info = type != nullptr ? type->property(property) : nullptr;
    if (info == nullptr)
        refuse(fmt::format("pass '{}' ({}) has no property '{}'{}", pass.name, pass.type, property,
                           type != nullptr ? didYouMean(property, type->propertyNames()) : ""));
    return *info;
}

const GraphEdge* edgeInto(const Graph& graph, const PortRef& input) {
    const auto found = std::find_if(graph.edges.begin(), graph.edges.end(),
                                    [&](const GraphEdge& edge) { return edge.to == input; });
    return found == graph.edges.end() ? nullptr : &*found;
}

GraphEdge* edgeInto(Graph& graph, const PortRef& input) {
    return const_cast<GraphEdge*>(edgeInto(std::as_const(graph), input));
}

} // namespace kestrel::edit
