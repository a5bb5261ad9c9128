// Files of the editor: what is written while one works, what changed on the disk, what was open lately.
#pragma once
#include "edit/document.h"
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

namespace kestrel::edit {

// Where the editor keeps its own files: $XDG_STATE_HOME/kestrel, else ~/.local/state/kestrel, else a folder
// for temporary files.
std::filesystem::path stateFolder();

// Keeps a copy of what is not saved, so that a crash loses little. Written by another thread, never two at
// once.
class Autosave {
public:
    explicit Autosave(std::filesystem::path folder);
    ~Autosave(); // waits for what is being written
    Autosave(const Autosave&) = delete;
    Autosave& operator=(const Autosave&) = delete;

    // Writes the document where it is modified and was not written at this revision. Returns at once. A
    // failure is told by the next call; empty: none.
    std::string save(const Document& document);
    // The document was saved or given up: its copy goes.
    void drop(const std::filesystem::path& file);
    // The copy of a file's document, if there is one that differs from the file.
    [[nodiscard]] std::optional<Graph> recover(const std::filesystem::path& file) const;
    [[nodiscard]] std::filesystem::path copyOf(const std::filesystem::path& file) const;

private:
    std::filesystem::path folder_;
    std::future<std::string> writing_;
    std::uint64_t revision_ = 0;
};

// Notices that a file is another than the one that was read or written.
class Watched {
public:
    void read(const std::filesystem::path& file); // as it is now
    // True once after each change of its content; a file that went away has not changed.
    [[nodiscard]] bool changed();

private:
    std::filesystem::path file_;
    std::filesystem::file_time_type time_{};
    std::string content_;
};

// Graphs that were open lately, the last first.
class Recent {
public:
    explicit Recent(std::filesystem::path file);
    void
    add(const std::filesystem::path& graph); // kept at once; a failure to write is no mistake of the user's
    [[nodiscard]] const std::vector<std::filesystem::path>& graphs() const { return graphs_; }
    static constexpr size_t most = 20;

private:
    std::filesystem::path file_;
    std::vector<std::filesystem::path> graphs_;
};

} // namespace kestrel::edit
