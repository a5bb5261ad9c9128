// URIs in glTF files: data in the text itself, and files beside it.
#include "core/error.h"
#include "core/files.h"
#include "scene/gltf_container.h"
#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <optional>
#include <string_view>

namespace fs = std::filesystem;

namespace kestrel {
namespace {

std::string lowered(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
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
    text.reserve(uri.size());
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

bool isData(std::string_view uri) { return lowered(uri.substr(0, 5)) == "data:"; }

// RFC 2397: data:[type][;parameters][;base64],octets. Any of it may be percent-encoded.
std::vector<std::byte> decodeData(const GltfFile& file, std::string_view uri, const std::string& what) {
    const size_t comma = uri.find(',');
    if (comma == uri.npos) failGltf(file, what + " has a data URI without a comma, which ends its head");
    const std::string head = lowered(decodePercent(uri.substr(0, comma)));
    const std::string octets = decodePercent(uri.substr(comma + 1));
    if (!head.ends_with(";base64")) {
        const auto* first = reinterpret_cast<const std::byte*>(octets.data());
        return {first, first + octets.size()};
    }
    std::optional<std::vector<std::byte>> bytes = decodeBase64(octets);
    if (!bytes) failGltf(file, what + " has a data URI with broken base64");
    return std::move(*bytes);
}

// "http:", "file:": one letter alone is no scheme but could be a drive; it is refused as a path then.
bool hasScheme(std::string_view uri) {
    const size_t colon = uri.find(':');
    return colon != uri.npos && uri.find('/') > colon;
}

// The path in a URI, still relative where the URI is; nothing where it leads elsewhere than to files.
std::optional<std::string> fileNameIn(std::string_view uri) {
    constexpr std::string_view local[] = {"file://localhost/", "file:///", "file:/"};
    for (const std::string_view start : local)
        if (lowered(uri.substr(0, start.size())) == start) return decodePercent(uri.substr(start.size() - 1));
    if (hasScheme(uri)) return std::nullopt;
    return decodePercent(uri);
}

// The folder of the file as it was named; where that is a link that has no such file beside it, the folder of
// what it links to.
fs::path folderOf(const GltfFile& file, const fs::path& name) {
    fs::path named = file.path.parent_path();
    std::error_code ignored;
    if (fs::is_symlink(file.path, ignored) && !fs::exists(named / name, ignored))
        return fs::canonical(file.path, ignored).parent_path();
    return named;
}

// Throws std::filesystem::filesystem_error for what is no file name.
bool isOutside(const GltfFile& file, const std::string& name) {
    try {
        static_cast<void>(pathInside(folderOf(file, name), name));
        return false;
    } catch (const InputError&) {
        return true;
    }
}

constexpr const char* outsideText = "leaves the folder of the scene (--allow-outside lets it be read)";

} // namespace

std::string outsideFolder(const GltfFile& file, const std::string& uri) {
    if (isData(uri) || file.options.allowOutside) return {};
    const std::optional<std::string> name = fileNameIn(uri);
    if (!name || name->empty() || name->find('\0') != name->npos) return {};
    try {
        return isOutside(file, *name) ? fmt::format("'{}' {}", uri, outsideText) : "";
    } catch (const fs::filesystem_error&) {
        return {}; // readUri() tells what is wrong with it
    }
}

std::vector<std::byte> readUri(const GltfFile& file, const std::string& uri, const std::string& what) {
    if (isData(uri)) return decodeData(file, uri, what);
    const std::optional<std::string> name = fileNameIn(uri);
    if (!name) failGltf(file, fmt::format("{} is at '{}'; only files are read", what, uri));
    if (name->empty() || name->find('\0') != name->npos) failGltf(file, what + " has an unusable URI");
    try {
        if (!file.options.allowOutside && isOutside(file, *name))
            failGltf(file, fmt::format("{}: '{}' {}", what, uri, outsideText));
        return readBytes(folderOf(file, *name) / *name);
    } catch (const InputError& error) {
        // One line that names both the file that asks and the one that is asked for.
        const Problem& problem = error.problems().front();
        if (problem.where.file == file.path.string()) throw;
        failGltf(file, fmt::format("{}: '{}' {}", what, uri, problem.message));
    } catch (const fs::filesystem_error&) {
        failGltf(file, fmt::format("{}: '{}' is no usable file name", what, uri.substr(0, 100)));
    }
}

} // namespace kestrel
