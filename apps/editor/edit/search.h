// Finding passes of a graph.
#pragma once
#include "graph/graph.h"
#include <string>
#include <vector>

namespace kestrel::edit {

struct Found {
    std::string pass;
    std::string why; // what of it matches: "name", "type Roma", "reads bom.grid", "angular = 4"
    friend bool operator==(const Found&, const Found&) = default;
};

// Passes that match every part of the query, in the order of the document; upper and lower case are alike.
// Parts are separated by blanks: a text that occurs in the name, the type, a port, the comment, a property's
// name or a value; `property=value`; or, as two words each, `reads X` and `writes X`, where X occurs in the
// name or the port of a pass that it reads from, or that reads it; or, where nothing is connected, in a port
// of its own. `muted` finds muted passes. An empty query finds nothing.
std::vector<Found> search(const Graph& graph, const Registry& registry, const std::string& query);

// Whether `text` contains `part`, or the letters of `part` in their order (so that "amoc" finds
// "AmbientOcclusion"): the smaller, the better; -1: not at all. For lists that a person narrows by typing.
int matchRank(const std::string& text, const std::string& part);

} // namespace kestrel::edit
