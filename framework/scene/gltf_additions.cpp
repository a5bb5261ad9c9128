#include "scene/gltf_additions.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <set>
#include <string_view>

namespace kestrel {
namespace {

using nlohmann::json;

// The array at `path`; nullptr where there is none.
json* arrayAt(json& document, const json::json_pointer& path) {
    if (!document.contains(path)) return nullptr;
    json& found = document[path];
    return found.is_array() ? &found : nullptr;
}

// The string member of an object; empty where it is none.
std::string_view stringIn(const json& object, const char* name) {
    if (!object.is_object()) return {};
    const auto member = object.find(name);
    return member != object.end() && member->is_string() ? member->get_ref<const std::string&>()
                                                         : std::string_view();
}

template<class Known>
bool isUnknown(std::string_view value, const Known& known) {
    return !value.empty() && std::find(known.begin(), known.end(), value) == known.end();
}

std::string shortened(std::string_view text) { return std::string(text.substr(0, 60)); }

bool isIndex(const json& value, const std::set<size_t>& indices) {
    return value.is_number_unsigned() && indices.contains(value.get<size_t>());
}

// Elements of the array at `path` whose `type` is unknown become `standIn`, so that indices stay what they
// are.
template<class Known>
std::set<size_t> replaceUnknown(GltfFile& file, const json::json_pointer& path, const char* kind,
                                const Known& known, const json& standIn) {
    std::set<size_t> replaced;
    json* elements = arrayAt(file.document, path);
    for (size_t i = 0; elements != nullptr && i < elements->size(); ++i) {
        const std::string_view type = stringIn((*elements)[i], "type");
        if (!isUnknown(type, known)) continue;
        file.warnings.add(
            fmt::format("{}[{}] is of the type '{}', which Kestrel does not know, and is ignored", kind, i,
                        shortened(type)));
        replaced.insert(i);
        (*elements)[i] = standIn;
    }
    return replaced;
}

void setAsideCamerasAndLights(GltfFile& file) {
    constexpr std::array<std::string_view, 2> cameraTypes{"perspective", "orthographic"};
    constexpr std::array<std::string_view, 3> lightTypes{"point", "spot", "directional"};
    const std::set<size_t> cameras =
        replaceUnknown(file, json::json_pointer("/cameras"), "cameras", cameraTypes,
                       {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}});
    const std::set<size_t> lights =
        replaceUnknown(file, json::json_pointer("/extensions/KHR_lights_punctual/lights"), "lights",
                       lightTypes, {{"type", "point"}});
    json* nodes = arrayAt(file.document, json::json_pointer("/nodes"));
    if (nodes == nullptr || (cameras.empty() && lights.empty())) return;
    const json::json_pointer light("/extensions/KHR_lights_punctual/light");
    for (json& node : *nodes) {
        if (!node.is_object()) continue;
        if (node.contains("camera") && isIndex(node["camera"], cameras)) node.erase("camera");
        if (node.contains(light) && isIndex(node[light], lights))
            node["extensions"].erase("KHR_lights_punctual");
    }
}

void setAsideAlphaModes(GltfFile& file) {
    constexpr std::array<std::string_view, 3> modes{"OPAQUE", "MASK", "BLEND"};
    json* materials = arrayAt(file.document, json::json_pointer("/materials"));
    for (size_t i = 0; materials != nullptr && i < materials->size(); ++i) {
        json& material = (*materials)[i];
        const std::string_view mode = stringIn(material, "alphaMode");
        if (!isUnknown(mode, modes)) continue;
        file.warnings.add(
            fmt::format("materials[{}] has the alpha mode '{}', which Kestrel does not know, and is opaque",
                        i, shortened(mode)));
        material.erase("alphaMode");
    }
}

// Why an accessor cannot be read, as the tail of a sentence; empty if it can.
std::string reasonUnreadable(const json& accessor) {
    constexpr std::array<std::string_view, 7> types{"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    constexpr std::array<std::int64_t, 6> componentTypes{5120, 5121, 5122, 5123, 5125, 5126};
    if (const std::string_view type = stringIn(accessor, "type"); isUnknown(type, types))
        return fmt::format("is of the type '{}', which Kestrel does not know", shortened(type));
    if (!accessor.is_object() || !accessor.contains("componentType")) return {};
    const json& component = accessor["componentType"];
    if (!component.is_number_integer()) return {};
    if (std::find(componentTypes.begin(), componentTypes.end(), component.get<std::int64_t>()) !=
        componentTypes.end())
        return {};
    return fmt::format("is of the component type {}, which Kestrel does not know", component.dump());
}

void setAsideAccessors(GltfFile& file) {
    json* accessors = arrayAt(file.document, json::json_pointer("/accessors"));
    for (size_t i = 0; accessors != nullptr && i < accessors->size(); ++i) {
        const std::string reason = reasonUnreadable((*accessors)[i]);
        if (reason.empty()) continue;
        file.unreadable[i] = reason;
        json standIn = {{"type", "SCALAR"}, {"componentType", 5126}, {"count", 1}};
        if ((*accessors)[i].contains("count")) standIn["count"] = (*accessors)[i]["count"];
        (*accessors)[i] = standIn;
    }
}

} // namespace

void setAsideAdditions(GltfFile& file) {
    if (!file.document.is_object()) return;
    setAsideCamerasAndLights(file);
    setAsideAlphaModes(file);
    setAsideAccessors(file);
}

} // namespace kestrel
