#include "edit/document.h"

namespace kestrel::edit {

Document::Document(Graph graph) { open(std::move(graph)); }

void Document::open(Graph graph) {
    graph_ = std::move(graph);
    text_ = saved_ = saveGraph(graph_);
    undo_.clear();
    redo_.clear();
    bytes_ = 0;
    ++revision_;
}

bool Document::apply(const std::string& name, const std::function<void(Graph&)>& change,
                     std::uint64_t gesture) {
    Graph next = graph_;
    change(next);
    std::string text = saveGraph(next);
    if (text == text_) return false;
    redo_.clear();
    const bool joins = gesture != 0 && !undo_.empty() && undo_.back().gesture == gesture;
    if (!joins) {
        bytes_ += text_.size();
        undo_.push_back({name, text_, gesture});
        forgetOldest();
    }
    graph_ = std::move(next);
    text_ = std::move(text);
    ++revision_;
    // A gesture that came back to where it began is none.
    if (joins && undo_.back().text == text_) {
        bytes_ -= undo_.back().text.size();
        undo_.pop_back();
    }
    return true;
}

bool Document::replace(const std::string& name, Graph graph) {
    return apply(name, [&](Graph& held) { held = std::move(graph); });
}

void Document::take(const std::string& text) {
    const std::filesystem::path file = graph_.file;
    graph_ = parseGraph(text, file.string());
    graph_.file = file;
    text_ = text;
    ++revision_;
}

bool Document::undo() {
    if (undo_.empty()) return false;
    Step step = std::move(undo_.back());
    undo_.pop_back();
    bytes_ -= step.text.size();
    redo_.push_back({step.name, text_, 0});
    take(step.text);
    return true;
}

bool Document::redo() {
    if (redo_.empty()) return false;
    Step step = std::move(redo_.back());
    redo_.pop_back();
    bytes_ += text_.size();
    undo_.push_back({step.name, text_, 0});
    take(step.text);
    return true;
}

std::string Document::undoName() const { return undo_.empty() ? std::string() : undo_.back().name; }
std::string Document::redoName() const { return redo_.empty() ? std::string() : redo_.back().name; }

std::vector<std::string> Document::history() const {
    std::vector<std::string> names;
    for (const Step& step : undo_) names.push_back(step.name);
    return names;
}

void Document::markSaved(const std::filesystem::path& file) {
    graph_.file = file;
    saved_ = text_;
}

void Document::forgetOldest() {
    size_t gone = 0;
    while (undo_.size() - gone > maxSteps || (bytes_ > maxBytes && undo_.size() - gone > 1))
        bytes_ -= undo_[gone++].text.size();
    undo_.erase(undo_.begin(), undo_.begin() + static_cast<std::ptrdiff_t>(gone));
}

} // namespace kestrel::edit
