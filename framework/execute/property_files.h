// The files that the properties of a graph's passes name (of unit "file"), and whether they changed since.
#pragma once
#include "core/file_state.h"
#include "graph/plan.h"
#include "graph/registry.h"
#include <filesystem>
#include <map>
#include <optional>

namespace kestrel {

// By path; no state: there was no such file.
using PropertyFiles = std::map<std::filesystem::path, std::optional<FileState>>;

// The file that a property of a pass names; empty if it is none or names none.
std::filesystem::path propertyFile(const PropertyInfo& property, const Pass& pass);

// Those of a whole graph as they are now. Every pass of it is in `passes`, and its type is registered.
PropertyFiles propertyFiles(const PassSet& passes, const Graph& graph, const Registry& registry);

// Whether one of them is not as it was.
bool changed(const PropertyFiles& files);

} // namespace kestrel
