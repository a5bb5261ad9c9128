// What tells one state of a file from another without reading it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>

namespace kestrel {

struct FileState {
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type modified;
    friend bool operator==(const FileState&, const FileState&) = default;
};

// Nothing where there is no plain file.
inline std::optional<FileState> fileState(const std::filesystem::path& file) {
    std::error_code failure;
    if (!std::filesystem::is_regular_file(file, failure)) return std::nullopt;
    const FileState state{std::filesystem::file_size(file, failure),
                          std::filesystem::last_write_time(file, failure)};
    if (failure) return std::nullopt;
    return state;
}

} // namespace kestrel
