// What a person does to a graph, as functions on the document. Each leaves a graph that can be saved and read
// again. Mistakes are InputErrors with a sentence for the person.
#pragma once
#include "graph/graph.h"
#include <set>
#include <string>
#include <vector>

namespace kestrel::edit {

using Names = std::set<std::string>; // of passes

// ---- passes
// A name for a pass of this type that the graph does not have yet: "ray_ambient_occlusion", "…_2".
std::string freshName(const Graph& graph, const std::string& wanted);
// Adds a pass of a type of the registry; its name.
std::string addPass(Graph& graph, const Registry& registry, const std::string& type, glm::dvec2 position);
// Removes passes with their edges, outputs and places in frames. With `reconnect` who read an output of one
// is fed by what stood in for that output, were the pass muted (graph/muted.h).
void removePasses(Graph& graph, const Registry& registry, const Names& passes, bool reconnect);
void renamePass(Graph& graph, const std::string& from, const std::string& to);
// The names of the copies, in the order of the document. Edges between copies are copied; those that come
// from outside with `keepInputs`.
std::vector<std::string> duplicatePasses(Graph& graph, const Names& passes, bool keepInputs,
                                         glm::dvec2 offset);
void setMuted(Graph& graph, const Names& passes, bool muted);
void movePasses(Graph& graph, const Names& passes, glm::dvec2 by);
void setComment(Graph& graph, const std::string& pass, const std::string& comment);

// ---- edges; an edge is known by the input that it feeds
// Why `from` cannot feed `to`: unknown, of another kind or content, a cycle; empty if it can.
std::string whyNot(const Graph& graph, const Registry& registry, const PortRef& from, const PortRef& to);
// Feeds an input, which whatever fed it before does no more.
void connect(Graph& graph, const Registry& registry, const PortRef& from, const PortRef& to);
void disconnect(Graph& graph, const std::vector<PortRef>& inputs);
// The edge into `to` comes from another output, or (`toInput`) leads to another input; with `copy` the old
// one stays.
void moveEdgeBegin(Graph& graph, const Registry& registry, const PortRef& to, const PortRef& newFrom);
void moveEdgeEnd(Graph& graph, const Registry& registry, const PortRef& to, const PortRef& newTo, bool copy);
// Puts a pass into the edge that feeds `to`: the first input that the edge's begin can feed, the first output
// that can feed its end. Refused where there is none.
void insertOnEdge(Graph& graph, const Registry& registry, const PortRef& to, const std::string& pass);
void setBends(Graph& graph, const PortRef& to, std::vector<glm::dvec2> bends);

// ---- outputs of the graph
void setOutput(Graph& graph, const Registry& registry, const PortRef& port, bool isOutput);

// ---- frames and notes
void addFrame(Graph& graph, const std::string& title, const Names& passes);
void renameFrame(Graph& graph, size_t frame, const std::string& title);
void removeFrame(Graph& graph, size_t frame);
void addNote(Graph& graph, const std::string& text, glm::dvec2 position);
void setNote(Graph& graph, size_t note, const std::string& text, glm::dvec2 position);
void removeNote(Graph& graph, size_t note);

} // namespace kestrel::edit
