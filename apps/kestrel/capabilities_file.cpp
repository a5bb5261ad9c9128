#include "capabilities_file.h"
#include "core/files.h"
#include "core/json.h"
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace kestrel {

namespace {

constexpr std::pair<const char*, int Capabilities::*> numbers[] = {
    {"max_compute_images", &Capabilities::maxComputeImages},
    {"max_storage_blocks", &Capabilities::maxStorageBlocks},
    {"max_texture_units", &Capabilities::maxTextureUnits},
    {"max_uniform_blocks", &Capabilities::maxUniformBlocks},
    {"max_texture_size", &Capabilities::maxTextureSize},
    {"max_3d_texture_size", &Capabilities::max3DTextureSize},
    {"max_array_layers", &Capabilities::maxArrayLayers},
    {"max_compute_shared_bytes", &Capabilities::maxComputeSharedBytes},
    {"max_compute_invocations", &Capabilities::maxComputeInvocations},
};
constexpr std::pair<const char*, std::int64_t Capabilities::*> largeNumbers[] = {
    {"max_texture_buffer_texels", &Capabilities::maxTextureBufferTexels},
    {"max_storage_block_bytes", &Capabilities::maxStorageBlockBytes},
};

template<class Number>
void readNumber(JsonFields& fields, const char* key, Number& number, std::vector<Problem>& problems) {
    const Json* value = fields.optional(key, Json::Kind::Int);
    if (value == nullptr) return;
    if (value->integer < 1 || value->integer > std::numeric_limits<Number>::max())
        problems.push_back(
            {value->where, fmt::format("{} must be from 1 to {}", key, std::numeric_limits<Number>::max())});
    else
        number = static_cast<Number>(value->integer);
}

} // namespace

Capabilities readCapabilities(const std::filesystem::path& file) {
    const Json json = Json::parse(readText(file), file.string());
    std::vector<Problem> problems;
    Capabilities result;
    JsonFields fields(json, "the capabilities", problems);
    if (const Json* text = fields.optional("renderer", Json::Kind::String)) result.renderer = text->text;
    if (const Json* text = fields.optional("version", Json::Kind::String)) result.version = text->text;
    if (const Json* flag = fields.optional("software", Json::Kind::Bool)) result.software = flag->boolean;
    if (const Json* list = fields.optional("extensions", Json::Kind::Array))
        for (const Json& item : list->items) {
            if (item.kind == Json::Kind::String)
                result.extensions.insert(item.text);
            else
                problems.push_back(
                    {item.where, fmt::format("an extension must be a string, not {}", item.kindName())});
        }
    fields.optional("kestrel", Json::Kind::Object); // what `--version --gl` says besides
    for (const auto& [key, member] : numbers) readNumber(fields, key, result.*member, problems);
    for (const auto& [key, member] : largeNumbers) readNumber(fields, key, result.*member, problems);
    fields.refuseOthers();
    if (!problems.empty()) throw InputError(std::move(problems));
    return result;
}

std::string capabilitiesJson(const Capabilities& capabilities) {
    nlohmann::ordered_json json = {{"renderer", capabilities.renderer},
                                   {"version", capabilities.version},
                                   {"software", capabilities.software},
                                   {"extensions", capabilities.extensions}};
    for (const auto& [key, member] : numbers) json[key] = capabilities.*member;
    for (const auto& [key, member] : largeNumbers) json[key] = capabilities.*member;
    return json.dump(2) + "\n";
}

} // namespace kestrel
