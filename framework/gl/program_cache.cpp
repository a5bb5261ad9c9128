#include "gl/program_cache.h"
#include "core/error.h"
#include "core/files.h"
#include "core/hash.h"
#include "core/log.h"
#include "gl/loader.h"
#include "gl/program.h"
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <mutex>
#include <optional>

namespace kestrel::gl {
namespace {

std::uint64_t hashOf(std::string_view text, std::uint64_t seed = Fnv1a::start) {
    Fnv1a hash(seed);
    hash.add(text);
    return hash.value();
}

// What precedes the binary in a file. The key is compared in full hashes of two seeds, the binary by its own.
struct FileHeader {
    char magic[8] = {'k', 'e', 's', 't', 'r', 'e', 'l', '1'};
    std::uint64_t keyHash = 0, secondKeyHash = 0, binaryHash = 0, binaryBytes = 0;
    std::uint32_t format = 0, pad = 0;
};

constexpr std::uintmax_t maxBinaryBytes = std::uintmax_t{64} << 20;
constexpr std::uint64_t secondSeed = 0x9e3779b97f4a7c15U;

std::string_view textOf(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::filesystem::path defaultFolder() {
    if (const char* folder = std::getenv("KESTREL_CACHE")) return folder;
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder != nullptr && *folder != '\0')
        return std::filesystem::path(folder) / "kestrel";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
        return std::filesystem::path(home) / ".cache" / "kestrel";
    return {};
}

std::optional<std::filesystem::path> chosenFolder;

std::string glText(GLenum name) {
    const auto* text = reinterpret_cast<const char*>(glGetString(name));
    return text == nullptr ? "" : text;
}

bool driverHasBinaries() {
    GLint formats = 0;
    glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
    return formats > 0;
}

} // namespace

void setProgramCache(const std::string& folder) { chosenFolder = folder; }

ProgramCache::ProgramCache(const ComposedProgram& composed, const std::vector<std::string>& attachments) {
    const std::filesystem::path folder = chosenFolder ? *chosenFolder : defaultFolder();
    if (folder.empty() || !driverHasBinaries()) return;
    key_ = glText(GL_RENDERER) + '\n' + glText(GL_VERSION) + '\n';
    for (const std::string& attachment : attachments) key_ += attachment + '\n';
    for (const ComposedStage& stage : composed.stages)
        key_ += fmt::format("\nstage {}\n", shaderStageName(stage.stage)) + stage.text;
    file_ = folder / fmt::format("{:016x}.program", hashOf(key_));
}

bool ProgramCache::load(Name program) const {
    std::error_code ignored;
    if (file_.empty() || !std::filesystem::is_regular_file(file_, ignored)) return false;
    std::vector<std::byte> bytes;
    try {
        bytes = readBytes(file_, maxBinaryBytes);
    } catch (const InputError& error) {
        logDebug("program cache: {}", error.what());
        return false;
    }
    FileHeader header;
    if (bytes.size() < sizeof header) return false;
    std::memcpy(&header, bytes.data(), sizeof header);
    const auto binary = std::span(bytes).subspan(sizeof header);
    const bool whole = std::memcmp(header.magic, FileHeader{}.magic, sizeof header.magic) == 0 &&
                       header.binaryBytes == binary.size() && header.binaryHash == hashOf(textOf(binary));
    if (!whole || header.keyHash != hashOf(key_) || header.secondKeyHash != hashOf(key_, secondSeed)) {
        logDebug("program cache: {} is damaged or of another program", file_.string());
        return false;
    }
    // A driver refuses binaries of another build of itself; then the program is compiled as if there were
    // none.
    const ExpectErrors expect;
    glProgramBinary(program, header.format, binary.data(), static_cast<GLsizei>(binary.size()));
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    return expect.take() == GL_NO_ERROR && linked == GL_TRUE;
}

void ProgramCache::prepare(Name program) const {
    if (!file_.empty()) glProgramParameteri(program, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
}

void ProgramCache::store(Name program) const {
    if (file_.empty()) return;
    GLint length = 0;
    glGetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &length);
    if (length <= 0) return;
    std::vector<std::byte> bytes(sizeof(FileHeader) + static_cast<size_t>(length));
    GLenum format = 0;
    GLsizei written = 0;
    glGetProgramBinary(program, length, &written, &format, bytes.data() + sizeof(FileHeader));
    if (written <= 0) return;
    bytes.resize(sizeof(FileHeader) + static_cast<size_t>(written));
    const auto binary = std::span<const std::byte>(bytes).subspan(sizeof(FileHeader));
    FileHeader header;
    header.keyHash = hashOf(key_);
    header.secondKeyHash = hashOf(key_, secondSeed);
    header.binaryHash = hashOf(textOf(binary));
    header.binaryBytes = binary.size();
    header.format = format;
    std::memcpy(bytes.data(), &header, sizeof header);
    try {
        writeFile(file_, bytes);
    } catch (const InputError& error) {
        static std::once_flag once; // every program would say the same
        std::call_once(once, [&] { logWarning("shader programs cannot be cached: {}", error.what()); });
    }
}

} // namespace kestrel::gl
