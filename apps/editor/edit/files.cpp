#include "edit/files.h"
#include "core/files.h"
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fmt/format.h>
#include <functional>
#include <sstream>

namespace kestrel::edit {
namespace {

// A name for a file's copy that no other file has.
std::string nameFor(const std::filesystem::path& file) {
    if (file.empty()) return "unnamed.json";
    std::error_code ignored;
    const std::string whole = std::filesystem::absolute(file, ignored).lexically_normal().string();
    return fmt::format("{}.{:016x}.json", file.stem().string(), std::hash<std::string>()(whole));
}

std::optional<std::string> contentOf(const std::filesystem::path& file) {
    try {
        return readText(file);
    } catch (const Error&) {
        return {};
    }
}

} // namespace

std::filesystem::path stateFolder() {
    const char* state = std::getenv("XDG_STATE_HOME");
    if (state != nullptr && *state != 0) return std::filesystem::path(state) / "kestrel";
    const char* home = std::getenv("HOME");
    if (home != nullptr && *home != 0) return std::filesystem::path(home) / ".local/state/kestrel";
    return std::filesystem::temp_directory_path() / "kestrel";
}

Autosave::Autosave(std::filesystem::path folder)
    : folder_(std::move(folder)) {}

Autosave::~Autosave() {
    if (writing_.valid()) writing_.wait();
}

std::filesystem::path Autosave::copyOf(const std::filesystem::path& file) const {
    return folder_ / nameFor(file);
}

std::string Autosave::save(const Document& document) {
    std::string failure;
    if (writing_.valid()) {
        if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
        failure = writing_.get();
    }
    if (!document.modified() || document.revision() == revision_) return failure;
    revision_ = document.revision();
    writing_ = std::async(
        std::launch::async, [file = copyOf(document.graph().file), text = document.text()]() -> std::string {
            try {
                writeFile(file, text);
                return {};
            } catch (const Error& error) {
                return "what is not saved cannot be kept: " + error.problems().front().text();
            }
        });
    return failure;
}

void Autosave::drop(const std::filesystem::path& file) {
    if (writing_.valid()) writing_.wait();
    std::error_code ignored;
    std::filesystem::remove(copyOf(file), ignored);
}

std::optional<Graph> Autosave::recover(const std::filesystem::path& file) const {
    const auto copy = contentOf(copyOf(file));
    if (!copy) return {};
    try {
        Graph graph = parseGraph(*copy, copyOf(file).string());
        const auto held = contentOf(file);
        if (held && saveGraph(parseGraph(*held, file.string())) == saveGraph(graph)) return {};
        graph.file = file;
        return graph;
    } catch (const InputError&) { // half of it is none
        return {};
    }
}

void Watched::read(const std::filesystem::path& file) {
    file_ = file;
    std::error_code ignored;
    time_ = std::filesystem::last_write_time(file, ignored);
    content_ = contentOf(file).value_or("");
}

bool Watched::changed() {
    std::error_code failure;
    const auto now = std::filesystem::last_write_time(file_, failure);
    if (file_.empty() || failure || now == time_) return false;
    const auto content = contentOf(file_);
    if (!content) return false;
    time_ = now;
    if (*content == content_) return false; // touched, not changed
    content_ = *content;
    return true;
}

Recent::Recent(std::filesystem::path file)
    : file_(std::move(file)) {
    std::istringstream lines(contentOf(file_).value_or(""));
    for (std::string line; std::getline(lines, line) && graphs_.size() < most;)
        if (!line.empty()) graphs_.emplace_back(line);
}

void Recent::add(const std::filesystem::path& graph) {
    std::error_code ignored;
    const std::filesystem::path whole = std::filesystem::absolute(graph, ignored).lexically_normal();
    std::erase(graphs_, whole);
    graphs_.insert(graphs_.begin(), whole);
    if (graphs_.size() > most) graphs_.resize(most);
    std::string text;
    for (const std::filesystem::path& each : graphs_) text += each.string() + "\n";
    try {
        writeFile(file_, text);
    } catch (const Error&) { // the list is a comfort
    }
}

} // namespace kestrel::edit
