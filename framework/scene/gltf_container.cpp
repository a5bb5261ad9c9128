#include "scene/gltf_container.h"
#include "core/error.h"
#include "core/files.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <span>
#include <string_view>

namespace fs = std::filesystem;

namespace kestrel {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF data is read as it lies in memory");

constexpr std::uint32_t magicGlb = 0x46546C67, chunkJson = 0x4E4F534A, chunkBinary = 0x004E4942;
constexpr int maxDepth = 64;

std::uint32_t wordAt(std::span<const std::byte> bytes, size_t offset) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data() + offset, sizeof word);
    return word;
}

std::string_view textOf(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Location locationOf(const fs::path& path, std::string_view text, size_t byte) {
    const std::string_view before = text.substr(0, std::min(byte, text.size()));
    const size_t lineStart = before.rfind('\n') + 1; // npos + 1 is 0
    return {path.string(), static_cast<int>(1 + std::count(before.begin(), before.end(), '\n')),
            static_cast<int>(std::max<size_t>(1, before.size() - lineStart))};
}

nlohmann::json parseJson(const fs::path& path, std::string_view text, std::uint64_t maxValues) {
    std::uint64_t values = 0;
    using Event = nlohmann::json::parse_event_t;
    const auto bound = [&](int depth, Event event, nlohmann::json&) {
        if (depth > maxDepth)
            throw InputError(Location{path.string()},
                             fmt::format("the JSON is nested more than {} levels deep", maxDepth));
        const bool counts =
            event == Event::value || event == Event::object_start || event == Event::array_start;
        if (counts && ++values > maxValues)
            throw InputError(Location{path.string()},
                             fmt::format("the JSON has more than {} values", maxValues));
        return true;
    };
    try {
        return nlohmann::json::parse(text.begin(), text.end(), bound);
    } catch (const nlohmann::json::parse_error& error) {
        const std::string_view what = error.what();
        const size_t tail = what.rfind(": ");
        throw InputError(locationOf(path, text, error.byte),
                         fmt::format("is not JSON: {}", what.substr(tail == what.npos ? 0 : tail + 2)));
    } catch (const nlohmann::json::exception&) {
        // The only other one is a number beyond the range of double.
        throw InputError(Location{path.string()}, "is not JSON: a number is out of range");
    }
}

void readChunks(GltfFile& file, std::span<const std::byte> bytes) {
    if (bytes.size() < 20) failGltf(file, "the GLB file ends within its header");
    if (const std::uint32_t version = wordAt(bytes, 4); version != 2)
        failGltf(file, fmt::format("is a GLB file of version {}; version 2 is read", version));
    const std::uint32_t length = wordAt(bytes, 8);
    if (length > bytes.size())
        failGltf(file,
                 fmt::format("the GLB file states a length of {} bytes and has {}", length, bytes.size()));
    if (length < 20) failGltf(file, fmt::format("the GLB file states a length of only {} bytes", length));
    size_t offset = 12;
    for (int chunk = 0; offset + 8 <= length; ++chunk) {
        const std::uint32_t size = wordAt(bytes, offset), type = wordAt(bytes, offset + 4);
        offset += 8;
        if (size > length - offset)
            failGltf(file,
                     fmt::format("GLB chunk {} states {} bytes; {} are left", chunk, size, length - offset));
        const std::span<const std::byte> content = bytes.subspan(offset, size);
        if (chunk == 0 && type != chunkJson) failGltf(file, "the first GLB chunk is not JSON");
        if (chunk == 0) file.document = parseJson(file.path, textOf(content), file.limits.jsonValues);
        if (chunk == 1 && type == chunkBinary) file.binary.assign(content.begin(), content.end());
        offset += size;
    }
}

std::optional<int> base64Digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    if (c == '/') return 63;
    return std::nullopt;
}

// RFC 4648; padding may be left out. Nothing for any other character.
std::optional<std::vector<std::byte>> decodeBase64(std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() * 3 / 4);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const std::optional<int> digit = base64Digit(c);
        if (!digit) return std::nullopt;
        bits = (bits << 6) | static_cast<std::uint32_t>(*digit);
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<std::byte>((bits >> count) & 0xFF));
    }
    if (count == 6) return std::nullopt; // a single digit makes no byte
    return bytes;
}

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

// %20 and the like, RFC 3986; a stray '%' stands for itself.
std::string decodePercent(std::string_view uri) {
    std::string text;
    for (size_t i = 0; i < uri.size(); ++i) {
        const int high = uri[i] == '%' && i + 2 < uri.size() ? hexDigit(uri[i + 1]) : -1;
        const int low = high >= 0 ? hexDigit(uri[i + 2]) : -1;
        if (low < 0) {
            text += uri[i];
            continue;
        }
        text += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return text;
}

// "http:", "file:": one letter alone is no scheme but could be a drive; it is refused as a path then.
bool hasScheme(std::string_view uri) {
    const size_t colon = uri.find(':');
    return colon != uri.npos && uri.find('/') > colon;
}

} // namespace

void failGltf(const GltfFile& file, const std::string& message) {
    throw InputError(Location{file.path.string()}, message);
}

GltfFile readGltfFile(const fs::path& path, const GltfLimits& limits) {
    GltfFile file;
    file.path = path;
    file.limits = limits;
    const std::vector<std::byte> bytes = readBytes(path);
    if (bytes.empty()) failGltf(file, "the file is empty");
    if (bytes.size() >= 4 && wordAt(bytes, 0) == magicGlb)
        readChunks(file, bytes);
    else
        file.document = parseJson(path, textOf(bytes), limits.jsonValues);
    if (!file.document.is_object()) failGltf(file, "the JSON is not an object");
    return file;
}

std::vector<std::byte> readUri(const GltfFile& file, const std::string& uri, const std::string& what) {
    if (uri.starts_with("data:")) {
        const size_t comma = uri.find(',');
        const std::string_view head = std::string_view(uri).substr(0, comma);
        if (comma == uri.npos || !head.ends_with(";base64"))
            failGltf(file, what + " has a data URI that is not base64");
        std::optional<std::vector<std::byte>> bytes = decodeBase64(std::string_view(uri).substr(comma + 1));
        if (!bytes) failGltf(file, what + " has a data URI with broken base64");
        return std::move(*bytes);
    }
    if (hasScheme(uri)) failGltf(file, fmt::format("{} is at '{}'; only files are read", what, uri));
    const std::string name = decodePercent(uri);
    if (name.empty() || name.find('\0') != name.npos) failGltf(file, what + " has an unusable URI");
    try {
        return readBytes(pathInside(file.path.parent_path(), name));
    } catch (const InputError& error) {
        // One line that names both the file that asks and the one that is asked for.
        const Problem& problem = error.problems().front();
        const std::string which = problem.where.file.empty() ? "" : fmt::format("'{}' ", uri);
        failGltf(file, fmt::format("{}: {}{}", what, which, problem.message));
    } catch (const fs::filesystem_error&) {
        failGltf(file, fmt::format("{}: '{}' is no usable file name", what, uri.substr(0, 100)));
    }
}

void readBuffers(GltfFile& file) {
    const auto buffers = file.document.find("buffers");
    if (buffers == file.document.end()) return;
    std::uint64_t total = 0;
    for (size_t i = 0; i < buffers->size(); ++i) {
        const nlohmann::json& buffer = (*buffers)[i];
        const std::string what = fmt::format("buffers[{}]", i);
        const std::uint64_t stated = buffer.at("byteLength").get<std::uint64_t>();
        std::vector<std::byte> bytes;
        if (buffer.contains("uri"))
            bytes = readUri(file, buffer["uri"].get_ref<const std::string&>(), what);
        else if (i == 0)
            bytes = std::move(file.binary);
        if (stated > bytes.size())
            failGltf(file, fmt::format("{}.byteLength is {}, but its data has {} bytes", what, stated,
                                       bytes.size()));
        bytes.resize(stated);
        total += stated;
        if (total > maxFileBytes)
            failGltf(file, fmt::format("the buffers have more than {} bytes in total", maxFileBytes));
        file.buffers.push_back(std::move(bytes));
    }
}

} // namespace kestrel
