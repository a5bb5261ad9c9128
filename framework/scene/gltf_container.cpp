#include "scene/gltf_container.h"
#include "core/error.h"
#include "core/files.h"
#include "scene/gltf_views.h"
#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>
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
    } catch (const nlohmann::json::exception& error) {
        // The only other one is a number beyond the range of double: "number overflow parsing '1e400'".
        const std::string_view what = error.what();
        const size_t quote = what.find('\'');
        throw InputError(
            Location{path.string()},
            fmt::format("a number is too large: {}", quote == what.npos ? what : what.substr(quote)));
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

} // namespace

void GltfWarnings::add(const std::string& message) {
    constexpr size_t most = 100;
    if (list_.size() > most || std::find(list_.begin(), list_.end(), message) != list_.end()) return;
    list_.push_back(list_.size() < most ? message : "there are further warnings");
}

void failGltf(const GltfFile& file, const std::string& message) {
    throw InputError(Location{file.path.string()}, message);
}

GltfFile readGltfFile(const fs::path& path, const SceneOptions& options, const GltfLimits& limits) {
    GltfFile file;
    file.path = path;
    file.options = options;
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

void readBuffers(GltfFile& file) {
    const auto buffers = file.document.find("buffers");
    if (buffers == file.document.end()) return;
    std::uint64_t total = 0;
    for (size_t i = 0; i < buffers->size(); ++i) {
        const nlohmann::json& buffer = (*buffers)[i];
        const std::string what = fmt::format("buffers[{}]", i);
        const std::uint64_t stated = buffer.at("byteLength").get<std::uint64_t>();
        std::vector<std::byte> bytes;
        if (hasMeshopt() && isFallbackBuffer(buffer)) {
            file.buffers.emplace_back();
            continue;
        }
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
