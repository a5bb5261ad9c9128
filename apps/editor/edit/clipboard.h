// Copied passes as text: the JSON of a graph, which can be pasted from a file, a mail, another editor.
#pragma once
#include "edit/commands.h"

namespace kestrel::edit {

// The selected passes, the edges between them, the frames that lie wholly among them, the variables that they
// follow; with `keepInputs` also the edges that come from other passes.
std::string copyText(const Graph& graph, const Names& passes, bool keepInputs);

struct Pasted {
    std::vector<std::string> passes;  // their names here
    std::vector<std::string> remarks; // edges from outside that could not be kept, and why
};
// Adds what the text holds; names that are taken get a number. Positions are moved so that the middle of what
// is pasted lies at `middle`. An edge that comes from outside is kept where the graph has that output and it
// fits. A variable of a name and value that the graph has is that one; of another value it gets a new name.
// Throws InputError if the text is no graph, with every mistake and its place.
Pasted pasteText(Graph& graph, const Registry& registry, const std::string& text, glm::dvec2 middle);

} // namespace kestrel::edit
