// A graph that is being edited: what can be undone, and whether it is saved. No GL, no window.
#pragma once
#include "graph/graph.h"
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace kestrel::edit {

// Every change is a named step. A step is kept as what of the graph's canonical text was another, so that
// undoing gives back every byte whatever a command did, and a long day's steps take little.
class Document {
public:
    explicit Document(Graph graph = {});

    [[nodiscard]] const Graph& graph() const { return graph_; }
    [[nodiscard]] const std::string& text() const { return text_; } // saveGraph(graph())
    // Goes up with every change, undone and redone ones too: who draws or renders compares it.
    [[nodiscard]] std::uint64_t revision() const { return revision_; }

    // Lets `change` edit a copy. If it throws, nothing has happened; if it changes no byte, no step is made.
    // Changes of one gesture (a drag of a slider: any number but 0) that follow each other are one step,
    // named as the first. True if something changed.
    bool apply(const std::string& name, const std::function<void(Graph&)>& change, std::uint64_t gesture = 0);

    bool undo(); // false: there is nothing to undo
    bool redo();
    // Names of the steps that undo() and redo() would take; empty: none.
    [[nodiscard]] std::string undoName() const;
    [[nodiscard]] std::string redoName() const;
    [[nodiscard]] std::vector<std::string> history() const; // oldest first
    // Steps that are kept at most, and bytes of their texts; the oldest go first.
    static constexpr size_t maxSteps = 100'000, maxBytes = size_t{256} << 20;

    // Another graph in its place, as one step: a file that changed on the disk.
    bool replace(const std::string& name, Graph graph);
    // Another document: nothing of the one before can be undone.
    void open(Graph graph);

    [[nodiscard]] bool modified() const { return text_ != saved_; }
    void markSaved(const std::filesystem::path& file);

private:
    // The text on the other side: that on this side, but between its first `begin` and its last `end` bytes.
    struct Step {
        std::string name;
        size_t begin = 0, end = 0;
        std::string middle;
        std::uint64_t gesture = 0;
        [[nodiscard]] std::string from(const std::string& here) const;
    };
    static Step stepTo(const std::string& there, const std::string& here, std::string name,
                       std::uint64_t gesture);
    void take(std::string text);
    void forgetOldest();

    Graph graph_;
    std::string text_, saved_;
    std::vector<Step> undo_, redo_;
    size_t bytes_ = 0; // of the middles in undo_
    std::uint64_t revision_ = 1;
};

} // namespace kestrel::edit
