#include "core/files.h"
#include "core/error.h"
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace kestrel {
namespace {

[[noreturn]] void failFile(const fs::path& file, const std::string& message) {
    throw InputError(Location{file.string()}, message);
}

std::string systemReason(int code) { return std::strerror(code); }

template<class Container>
Container readAll(const fs::path& file, std::uintmax_t limit) {
    std::error_code failure;
    const fs::file_status status = fs::status(file, failure);
    if (status.type() == fs::file_type::not_found) failFile(file, "no such file");
    if (status.type() != fs::file_type::regular) failFile(file, "is not a file");
    const std::uintmax_t size = fs::file_size(file, failure);
    if (failure) failFile(file, failure.message());
    if (size > limit) failFile(file, fmt::format("has {} bytes; at most {} are read", size, limit));
    std::ifstream stream(file, std::ios::binary);
    Container content(static_cast<size_t>(size), {});
    if (!stream || (size != 0 && !stream.read(reinterpret_cast<char*>(content.data()),
                                              static_cast<std::streamsize>(size))))
        failFile(file, "cannot be read");
    return content;
}

// An open file descriptor on a temporary name that is removed again unless it was renamed.
class TemporaryFile {
public:
    explicit TemporaryFile(const fs::path& target)
        : name_(target.string() + ".XXXXXX") {
        descriptor_ = ::mkostemp(name_.data(), O_CLOEXEC);
        if (descriptor_ < 0) failFile(target, "cannot be written: " + systemReason(errno));
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (!renamed_) ::unlink(name_.c_str());
    }
    void write(const fs::path& target, std::span<const std::byte> bytes) {
        while (!bytes.empty()) {
            const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) failFile(target, "cannot be written: " + systemReason(errno));
            bytes = bytes.subspan(static_cast<size_t>(count));
        }
    }
    void renameTo(const fs::path& target) {
        // mkostemp makes the file private; a result is as readable as any other file that the user makes.
        const mode_t mask = ::umask(0);
        ::umask(mask);
        ::fchmod(descriptor_, 0666 & ~mask);
        const int closed = ::close(descriptor_);
        descriptor_ = -1;
        if (closed != 0) failFile(target, "cannot be written: " + systemReason(errno));
        if (::rename(name_.c_str(), target.c_str()) != 0)
            failFile(target, "cannot be written: " + systemReason(errno));
        renamed_ = true;
    }

private:
    std::string name_;
    int descriptor_ = -1;
    bool renamed_ = false;
};

fs::path libraryFolder() {
    Dl_info info{};
    if (::dladdr(reinterpret_cast<void*>(&libraryFolder), &info) == 0 || info.dli_fname == nullptr) return {};
    std::error_code failure;
    return fs::canonical(info.dli_fname, failure).parent_path();
}

} // namespace

std::vector<std::byte> readBytes(const fs::path& file, std::uintmax_t limit) {
    return readAll<std::vector<std::byte>>(file, limit);
}

std::string readText(const fs::path& file, std::uintmax_t limit) { return readAll<std::string>(file, limit); }

void writeFile(const fs::path& file, std::span<const std::byte> bytes) {
    if (file.has_parent_path()) {
        std::error_code failure;
        fs::create_directories(file.parent_path(), failure);
        if (failure) failFile(file.parent_path(), "cannot be made: " + failure.message());
    }
    TemporaryFile temporary(file);
    temporary.write(file, bytes);
    temporary.renameTo(file);
}

void writeFile(const fs::path& file, std::string_view text) {
    writeFile(file, std::as_bytes(std::span(text)));
}

fs::path pathInside(const fs::path& folder, std::string_view relative) {
    const fs::path asked(relative);
    const fs::path root = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder);
    const fs::path full = fs::weakly_canonical(root / asked);
    const fs::path within = full.lexically_relative(root);
    if (asked.is_absolute() || within.empty() || *within.begin() == "..")
        throw InputError(fmt::format("'{}' leaves the folder of the file that names it", relative));
    return full;
}

fs::path shareFolder() {
    if (const char* named = std::getenv("KESTREL_SHARE")) return named;
    fs::path folder = libraryFolder() / ".." / "share" / "kestrel";
    // A multiarch library folder (lib/x86_64-linux-gnu) is one level deeper.
    if (!fs::is_directory(folder)) folder = libraryFolder() / ".." / ".." / "share" / "kestrel";
    if (!fs::is_directory(folder))
        throw MachineError(
            "the folder share/kestrel with the shaders is missing; set KESTREL_SHARE to where it is");
    return fs::canonical(folder);
}

namespace {
bool isSame(const fs::path& a, const fs::path& b) {
    std::error_code failure; // a folder that does not exist is not the same
    return fs::equivalent(a, b, failure);
}
} // namespace

std::vector<fs::path> pluginFolders() {
    std::vector<fs::path> folders = {libraryFolder() / "kestrel"};
    const char* named = std::getenv("KESTREL_PLUGINS");
    std::string_view rest = named == nullptr ? "" : named;
    while (!rest.empty()) {
        const size_t colon = rest.find(':');
        const fs::path folder = rest.substr(0, colon);
        if (!folder.empty() && !isSame(folder, folders.front())) folders.push_back(folder);
        rest.remove_prefix(colon == std::string_view::npos ? rest.size() : colon + 1);
    }
    return folders;
}

} // namespace kestrel
