// Which pass or edge of the canvas a mistake belongs to.
#pragma once
#include "graph/graph.h"
#include <optional>
#include <string>
#include <vector>

namespace kestrel::edit {

struct Marked {
    std::string message;
    std::string pass;             // that it concerns; empty: the graph as a whole
    std::optional<PortRef> input; // of an edge: the input that it feeds
    std::string property;         // of the pass; empty: none
    friend bool operator==(const Marked&, const Marked&) = default;
};

// The graph read again from its text, so that every part knows its line, and mistakes can be laid at its
// door.
Graph locatedGraph(const Graph& graph, const std::string& text);

// Problems of validate(), compile() or a frame, each at its place. `located` is what was validated or
// compiled. A problem without a place (a shader's) belongs to the pass that its message quotes first, if it
// quotes one.
std::vector<Marked> mark(const Graph& located, const std::vector<Problem>& problems);

} // namespace kestrel::edit
