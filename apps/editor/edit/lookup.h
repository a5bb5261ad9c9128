// Finding things that a person named, for the commands: what is not there is an InputError with near names.
#pragma once
#include "graph/graph.h"
#include <string>

namespace kestrel::edit {

[[noreturn]] void refuse(const std::string& message);

GraphPass& passOf(Graph& graph, const std::string& name);
const PassType& typeOf(const Graph& graph, const Registry& registry, const std::string& pass);
const PropertyInfo& propertyOf(const Registry& registry, const GraphPass& pass, const std::string& property);
// The edge that feeds an input; nullptr if none does.
GraphEdge* edgeInto(Graph& graph, const PortRef& input);
const GraphEdge* edgeInto(const Graph& graph, const PortRef& input);

} // namespace kestrel::edit
