// What `kestrel check`, `passes` and `dot` print: a plan and the table of pass types as text and as JSON.
#pragma once
#include "graph/plan.h"
#include <string>

namespace kestrel {

// The plan for people: order with steps, barriers and programs; memory with and without sharing, object by
// object; what is left out, and why ("nothing" if so).
std::string planText(const Plan& plan);

// The plan for machines. Keys are only ever added: {"size":[w,h],"passes":[{"name","type","steps":[{"name",
// "barrier","program","bindings":[…],"copies":[[from,to]]}]}],"resources":[{"port","desc","bytes","transient",
// "history","object","first_step","last_step"}],"objects":[{"desc","bytes","label"}],"programs":[{"files",
// "defines","modules"}],"outputs":[{"port","resource"}],"left_out":[{"what","why"}],"memory":{"transient",
// "unshared","persistent"}}. Bytes; `resource` and `object` are indices.
std::string planJson(const Plan& plan);

// The graph for Graphviz: passes as boxes, edges with the ports they join, outputs; what the plan leaves out
// is drawn faded.
std::string dotText(const Graph& graph, const Registry& registry, const Plan& plan);

// All pass types, one line each, or one type with its ports and properties (kind, range, default, unit).
std::string passListText(const Registry& registry);
std::string passTypeText(const PassType& type);

// {"passes":[{"name","description","plugin","ports":[{"name","kind","direction","optional","description"}],
// "properties":[{"name","kind","default","minimum","maximum","choices","components","unit","description"}]}]}
std::string passesJson(const std::vector<const PassType*>& types);

} // namespace kestrel
