// What `kestrel check`, `passes` and `dot` print: a plan and the table of pass types as text and as JSON.
#pragma once
#include "graph/plan.h"
#include <string>

namespace kestrel {

// What a plan's memory comes to, in one line: "1.5 MiB shared by lifetime (unshared 4 MiB), 12 KiB that
// stays".
std::string memoryText(const MemoryReport& memory);
// A line each, "left out: WHAT, because WHY"; "left out: nothing" if there is none.
std::string leftOutText(const std::vector<LeftOut>& leftOut);

// The plan for people: order with steps, programs and barriers; objects and who lies in them; memory with and
// without sharing; what is left out, and why.
std::string planText(const Plan& plan);

// The plan for machines. Keys are only ever added:
// {"size":[w,h],"passes":[{"name","type","every_frame","inputs",
// "ports","steps":[name]}],"steps":[{"pass","name","group","barrier","program","bindings":[…],
// "copies":[[from,to]]}],"resources":[{"port","description","bytes","transient","constant","history","object",
// "offset","first_step","last_step"}],"objects":[{"description","bytes","label"}],"programs":[{"files","defines",
// "modules"}],"outputs":[{"port","resource","preview"}],"left_out":[{"what","why"}],"memory":{"transient",
// "unshared","persistent"}}. Bytes; `inputs`, `program`, `resource` and `object` are indices.
std::string planJson(const Plan& plan);

// The graph for Graphviz: passes as boxes, edges with the ports that they join (modules bold), outputs; what
// the plan leaves out is drawn faded, with its reason as tooltip. Without a plan nothing is.
std::string dotText(const Graph& graph, const Registry& registry, const Plan* plan);

// All pass types, one line each, or one type with its ports and properties (kind, range, default, unit).
std::string passListText(const Registry& registry);
std::string passTypeText(const PassType& type);

// {"passes":[{"name","description","plugin","ports":[{"name","kind","direction","optional","description",
// and where stated "structure","channels","space","same_extent_as","minimum","maximum"}],
// "properties":[{"name","kind","default","minimum","maximum","choices","components","unit","description"}]}]}
std::string passesJson(const std::vector<const PassType*>& types);

} // namespace kestrel
