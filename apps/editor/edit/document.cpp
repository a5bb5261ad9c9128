#include "edit/document.h"
#include <algorithm>

namespace kestrel::edit {

std::string Document::Step::from(const std::string& here) const {
    return here.substr(0, begin) + middle + here.substr(here.size() - end);
}

Document::Step Document::stepTo(const std::string& there, const std::string& here, std::string name,
                                std::uint64_t gesture) {
    const size_t shorter = std::min(there.size(), here.size());
    const auto begin = static_cast<size_t>(
        std::mismatch(there.begin(), there.begin() + static_cast<std::ptrdiff_t>(shorter), here.begin())
            .first -
        there.begin());
    const auto rest = static_cast<std::ptrdiff_t>(shorter - begin);
    const auto end = static_cast<size_t>(
        std::mismatch(there.rbegin(), there.rbegin() + rest, here.rbegin()).first - there.rbegin());
    return {std::move(name), begin, end, there.substr(begin, there.size() - begin - end), gesture};
}

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
    std::string before = text_, first = name;
    if (joins) {
        before = undo_.back().from(text_);
        first = undo_.back().name;
        bytes_ -= undo_.back().middle.size();
        undo_.pop_back();
    }
    // A gesture that came back to where it began is none.
    if (before != text) {
        undo_.push_back(stepTo(before, text, std::move(first), gesture));
        bytes_ += undo_.back().middle.size();
        forgetOldest();
    }
    graph_ = std::move(next);
    text_ = std::move(text);
    ++revision_;
    return true;
}

bool Document::replace(const std::string& name, Graph graph) {
    return apply(name, [&](Graph& held) { held = std::move(graph); });
}

void Document::take(std::string text) {
    const std::filesystem::path file = graph_.file;
    graph_ = parseGraph(text, file.string());
    graph_.file = file;
    text_ = std::move(text);
    ++revision_;
}

bool Document::undo() {
    if (undo_.empty()) return false;
    const Step step = std::move(undo_.back());
    undo_.pop_back();
    bytes_ -= step.middle.size();
    std::string before = step.from(text_);
    redo_.push_back(stepTo(text_, before, step.name, 0));
    take(std::move(before));
    return true;
}

bool Document::redo() {
    if (redo_.empty()) return false;
    const Step step = std::move(redo_.back());
    redo_.pop_back();
    std::string after = step.from(text_);
    undo_.push_back(stepTo(text_, after, step.name, 0));
    bytes_ += undo_.back().middle.size();
    take(std::move(after));
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
        bytes_ -= undo_[gone++].middle.size();
    undo_.erase(undo_.begin(), undo_.begin() + static_cast<std::ptrdiff_t>(gone));
}

} // namespace kestrel::edit
