#include "core/files.h"
#include "core/error.h"
#include "core/standard_output.h"
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace fs = std::filesystem;

namespace kestrel {
namespace {

[[noreturn]] void failFile(const fs::path& file, const std::string& message) {
    throw InputError(Location{file.string()}, message);
}

std::string systemReason(int code) { return std::strerror(code); }

const fs::path standardStream = "-";

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

// A pipe, a device or "-": until its end, which nobody knows before.
template<class Container>
Container readStream(const fs::path& file, std::uintmax_t limit) {
    const int descriptor = file == standardStream ? STDIN_FILENO : ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) failFile(file, "cannot be read: " + systemReason(errno));
    Container content;
    constexpr size_t block = size_t{1} << 16;
    size_t size = 0;
    int reason = 0;
    while (size <= limit) {
        content.resize(size + block);
        const ssize_t count = ::read(descriptor, content.data() + size, block);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) reason = errno;
        if (count <= 0) break;
        size += static_cast<size_t>(count);
    }
    if (descriptor != STDIN_FILENO) ::close(descriptor);
    if (reason != 0) failFile(file, "cannot be read: " + systemReason(reason));
    if (size > limit) failFile(file, fmt::format("has more than the {} bytes that are read at most", limit));
    content.resize(size);
    return content;
}

void writeDescriptor(int descriptor, const fs::path& target, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) failFile(target, "cannot be written: " + systemReason(errno));
        bytes = bytes.subspan(static_cast<size_t>(count));
    }
}

void writeStream(const fs::path& file, std::span<const std::byte> bytes) {
    if (isStandardOutput(file)) {
        std::fflush(stdout);
        writeDescriptor(STDOUT_FILENO, file, bytes);
        return;
    }
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) failFile(file, "cannot be written: " + systemReason(errno));
    try {
        writeDescriptor(descriptor, file, bytes);
    } catch (...) {
        ::close(descriptor);
        throw;
    }
    if (::close(descriptor) != 0) failFile(file, "cannot be written: " + systemReason(errno));
}

// What a file is written to: of a link that to which it leads.
fs::path linkTarget(const fs::path& file) {
    std::error_code failure;
    if (!fs::is_symlink(file, failure)) return file;
    const fs::path target = fs::weakly_canonical(file, failure);
    return failure ? file : target;
}

// A file that is written beside its target and takes its name once it is whole. Where the file system allows
// it has no name before then, so that nothing is left of it however the program ends; else a temporary one.
class TemporaryFile {
public:
    explicit TemporaryFile(const fs::path& target)
        : target_(target) {
        const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
        if (::access("/proc/self/fd", X_OK) == 0)
            descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
        if (descriptor_ >= 0) return;
        name_ = target.string() + ".XXXXXX";
        descriptor_ = ::mkostemp(name_.data(), O_CLOEXEC);
        if (descriptor_ < 0) failFile(target, "cannot be written: " + systemReason(errno));
        // mkostemp makes the file private; a result is as readable as any other file that the user makes.
        const mode_t mask = ::umask(0);
        ::umask(mask);
        ::fchmod(descriptor_, 0666 & ~mask);
    }
    TemporaryFile(TemporaryFile&& other) noexcept
        : target_(std::move(other.target_))
        , name_(std::exchange(other.name_, {}))
        , descriptor_(std::exchange(other.descriptor_, -1)) {}
    TemporaryFile& operator=(TemporaryFile&&) = delete;
    ~TemporaryFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (!name_.empty()) ::unlink(name_.c_str());
    }
    void write(std::span<const std::byte> bytes) { writeDescriptor(descriptor_, target_, bytes); }
    // Closes it under a temporary name: a process may not hold many files open.
    void close() {
        for (int i = 0; name_.empty(); ++i) {
            const std::string beside = fmt::format("{}.{}-{}", target_.string(), ::getpid(), i);
            if (link(beside)) name_ = beside;
        }
        if (::close(std::exchange(descriptor_, -1)) != 0) fail();
    }
    void finish() {
        if (name_.empty() && link(target_)) return;
        // A link replaces nothing: where the target is there already, a name beside it is renamed.
        if (descriptor_ >= 0) close();
        if (::rename(name_.c_str(), target_.c_str()) != 0) fail();
        name_.clear();
    }

private:
    [[noreturn]] void fail() const { failFile(target_, "cannot be written: " + systemReason(errno)); }
    // False if the name is taken.
    [[nodiscard]] bool link(const fs::path& name) const {
        const std::string self = fmt::format("/proc/self/fd/{}", descriptor_);
        if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
        if (errno != EEXIST) fail();
        return false;
    }

    fs::path target_;
    std::string name_; // empty: none yet, or no more
    int descriptor_ = -1;
};

TemporaryFile beside(const fs::path& file) {
    const fs::path target = linkTarget(file);
    if (target.has_parent_path()) {
        std::error_code failure;
        fs::create_directories(target.parent_path(), failure);
        if (failure) failFile(target.parent_path(), "cannot be made: " + failure.message());
    }
    return TemporaryFile(target);
}

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

bool isStandardOutput(const fs::path& file) {
    for (const char* name : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"})
        if (file == name) return true;
    return false;
}

std::vector<std::byte> readGivenBytes(const fs::path& file, std::uintmax_t limit) {
    return isStream(file) ? readStream<std::vector<std::byte>>(file, limit) : readBytes(file, limit);
}

std::string readGivenText(const fs::path& file, std::uintmax_t limit) {
    return isStream(file) ? readStream<std::string>(file, limit) : readText(file, limit);
}

bool isStream(const fs::path& file) {
    // Open already, whatever stands behind: a rename would miss it.
    const std::string name = file.string();
    for (const char* open : {"-", "/dev/stdin", "/dev/stdout", "/dev/stderr"})
        if (name == open) return true;
    if (name.starts_with("/dev/fd/") || name.starts_with("/proc/self/fd/")) return true;
    std::error_code failure;
    const fs::file_type type = fs::status(file, failure).type();
    return type == fs::file_type::fifo || type == fs::file_type::character || type == fs::file_type::socket;
}

void writeFile(const fs::path& file, std::span<const std::byte> bytes) {
    if (isStream(file)) {
        writeStream(file, bytes);
        return;
    }
    TemporaryFile temporary = beside(file);
    temporary.write(bytes);
    temporary.finish();
}

void writeFiles(const FileBytes& files) {
    std::vector<TemporaryFile> whole;
    for (const auto& [file, bytes] : files) {
        if (isStream(file)) continue;
        whole.push_back(beside(file));
        whole.back().write(bytes);
        constexpr std::size_t open = 100;
        if (whole.size() > open) whole.back().close();
    }
    for (const auto& [file, bytes] : files)
        if (isStream(file)) writeStream(file, bytes);
    for (TemporaryFile& temporary : whole) temporary.finish();
}

void requireWritableFolder(const fs::path& folder) {
    // The first folder on the way that is there must take another; rights alone do not tell (a file system
    // that is read-only, or none).
    fs::path there = fs::absolute(folder).lexically_normal();
    std::error_code failure;
    while (!fs::exists(fs::symlink_status(there, failure)) && there.has_relative_path()) {
        const fs::path above = there.parent_path();
        if (above == there) break;
        there = above;
    }
    if (!fs::is_directory(there, failure))
        failFile(folder, fmt::format("cannot be written: {} is not a folder", there.string()));
    std::string probe = (there / ".kestrel.XXXXXX").string();
    if (::mkdtemp(probe.data()) == nullptr)
        failFile(folder, fmt::format("cannot be written: {}: {}", there.string(), systemReason(errno)));
    ::rmdir(probe.c_str());
}

void requireWritable(const fs::path& file) {
    if (isStandardOutput(file)) return;
    if (isStream(file)) {
        if (::access(file.c_str(), W_OK) != 0) failFile(file, "cannot be written: " + systemReason(errno));
        return;
    }
    std::error_code failure;
    const fs::path target = linkTarget(file);
    if (fs::is_directory(target, failure)) failFile(file, "cannot be written: it is a folder");
    requireWritableFolder(target.has_parent_path() ? target.parent_path() : ".");
}

void writeFile(const fs::path& file, std::string_view text) {
    writeFile(file, std::as_bytes(std::span(text)));
}

fs::path pathInside(const fs::path& folder, std::string_view relative) {
    const fs::path asked(relative);
    const fs::path root = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder);
    fs::path full = fs::weakly_canonical(root / asked);
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
