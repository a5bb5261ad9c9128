// Where passes stand on the canvas: a layered layout, and what is left alone.
#pragma once
#include "edit/commands.h"

namespace kestrel::edit {

// Sizes of the boxes, canvas units; by pass.
using Sizes = std::map<std::string, glm::dvec2, std::less<>>;

struct LayoutGaps {
    double between = 60; // columns
    double beneath = 24; // boxes of a column
};

// Arranges the passes of `which` in columns: each to the right of all that it reads, next to its nearest
// reader; within a column in the order that crosses fewest edges, found by medians swept to and fro. The left
// upper corner of what is arranged stays where it was; no other pass is moved, and bends of edges within the
// arranged go. The same graph gives the same layout.
void arrange(Graph& graph, const Names& which, const Sizes& sizes, const LayoutGaps& gaps = {});

// Places only those passes that have no position yet: arranged among themselves, below all that have one.
// True if there were any.
bool placeMissing(Graph& graph, const Sizes& sizes, const LayoutGaps& gaps = {});

// Where passes are drawn that the document gives no place.
using Places = std::map<std::string, glm::dvec2, std::less<>>;

// Once one pass has a place, all are to have one, or those without would be arranged around it: gives them
// the places at which they are drawn. A graph in which nobody placed anything stays without positions.
void keepPlaces(Graph& graph, const Places& drawn);

// Edges that cross, of straight edges between the columns' boxes: for tests and for choosing among layouts.
size_t crossings(const Graph& graph, const Names& which);

} // namespace kestrel::edit
