#include "scene/gltf_schema.h"
#include "scene/gltf_shapes.h"
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>
#include <set>
#include <string_view>

namespace kestrel {
namespace {

using nlohmann::json;
using namespace nlohmann::literals;

class Checker {
public:
    explicit Checker(GltfFile& file)
        : file_(file) {}

    void checkObject(json& value, const GltfShape& shape, const std::string& path) {
        if (!value.is_object()) fail(path, "is not an object");
        for (const GltfField& field : shape) {
            const std::string below = path.empty() ? field.name : path + "." + field.name;
            const auto member = value.find(field.name);
            if (member == value.end()) {
                if (field.isRequired) fail(below, "is missing");
                continue;
            }
            // Extras may be anything; only objects can hold what we look for.
            if (field.name == "extras" && !member->is_object()) continue;
            if (field.isArray)
                checkArray(*member, field, below);
            else
                checkValue(*member, field, below);
        }
    }

private:
    [[noreturn]] void fail(const std::string& path, const std::string& message) const {
        failGltf(file_, path + " " + message);
    }

    void warn(const std::string& path, const std::string& message) {
        file_.warnings.add(path + " " + message);
    }

    void checkArray(json& value, const GltfField& field, const std::string& path) {
        if (!value.is_array()) fail(path, "is not an array");
        if (field.length != 0 && value.size() != field.length)
            fail(path, fmt::format("has {} numbers, not {}", value.size(), field.length));
        for (size_t i = 0; i < value.size(); ++i) checkValue(value[i], field, fmt::format("{}[{}]", path, i));
    }

    void checkValue(json& value, const GltfField& field, const std::string& path) {
        switch (field.kind) {
        case GltfKind::Bool:
            if (!value.is_boolean()) fail(path, "is neither true nor false");
            break;
        case GltfKind::String:
            checkString(value, field, path);
            break;
        case GltfKind::Integer:
        case GltfKind::Number:
            checkNumber(value, field, path);
            break;
        case GltfKind::Index:
            checkIndex(value, field, path);
            break;
        case GltfKind::IndexMap:
            if (!value.is_object()) fail(path, "is not an object");
            for (auto& [name, one] : value.items()) checkIndex(one, field, path + "." + name);
            break;
        case GltfKind::Object:
            checkObject(value, *field.shape, path);
            break;
        }
    }

    void checkString(const json& value, const GltfField& field, const std::string& path) const {
        if (!value.is_string()) fail(path, "is not a string");
        if (field.choices.empty()) return;
        for (const std::string& choice : field.choices)
            if (value.get_ref<const std::string&>() == choice) return;
        fail(path, fmt::format("is '{}'; it can be {}", value.get<std::string>().substr(0, 60),
                               fmt::join(field.choices, ", ")));
    }

    void checkNumber(json& value, const GltfField& field, const std::string& path) {
        if (!value.is_number()) fail(path, "is not a number");
        const double number = value.get<double>();
        if (field.kind == GltfKind::Integer) makeInteger(value, path);
        // Integers above 2^31 would be cut off where only a number is meant.
        else if (value.is_number_integer())
            value = number;
        if (number >= field.min && number <= field.max) return;
        const bool counts = field.kind == GltfKind::Integer;
        if (!counts && (isRounding(number, field) || isInUnusedMaterial(path))) {
            const double nearest = std::clamp(number, field.min, field.max);
            warn(path, fmt::format("is {}, which is out of range, and is read as {}", number, nearest));
            value = nearest;
            return;
        }
        fail(path, field.max < 1e15 ? fmt::format("is {}, not within {} to {}", number, field.min, field.max)
                                    : fmt::format("is {}, which is out of range", number));
    }

    // Exporters compute with floats and write 1.0000001 or, through colour spaces, 1.0002 where 1 is meant.
    static bool isRounding(double number, const GltfField& field) {
        const double bound = number < field.min ? field.min : field.max;
        return std::abs(number - bound) <= gltfRounding * std::max(1.0, std::abs(bound));
    }

    // Whether the path lies in a material that no primitive names.
    [[nodiscard]] bool isInUnusedMaterial(const std::string& path) {
        constexpr std::string_view start = "materials[";
        if (!path.starts_with(start)) return false;
        if (!usedMaterials_) usedMaterials_ = materialsInUse();
        size_t index = 0;
        const char* first = path.data() + start.size();
        return std::from_chars(first, path.data() + path.size(), index).ec == std::errc() &&
               !usedMaterials_->contains(index);
    }

    // Of a document that may be wrong anywhere.
    [[nodiscard]] std::set<size_t> materialsInUse() const {
        std::set<size_t> used;
        const auto note = [&](const json& primitive) {
            const auto material = primitive.is_object() ? primitive.find("material") : primitive.end();
            if (primitive.is_object() && material != primitive.end() && material->is_number())
                used.insert(static_cast<size_t>(std::clamp(material->get<double>(), 0.0, 9e15)));
        };
        const auto meshes = file_.document.find("meshes");
        if (meshes == file_.document.end()) return used;
        for (const json& mesh : *meshes) {
            const auto primitives = mesh.is_object() ? mesh.find("primitives") : mesh.end();
            if (!mesh.is_object() || primitives == mesh.end()) continue;
            for (const json& primitive : *primitives) note(primitive);
        }
        return used;
    }

    void makeInteger(json& value, const std::string& path) const {
        if (value.is_number_integer()) return;
        const double number = value.get<double>();
        if (number != std::floor(number) || std::abs(number) > 9e15) fail(path, "is not a whole number");
        value = static_cast<std::int64_t>(number);
        if (number >= 0) value = static_cast<std::uint64_t>(number);
    }

    void checkIndex(json& value, const GltfField& field, const std::string& path) const {
        if (!value.is_number()) fail(path, "is not a number");
        makeInteger(value, path);
        const double number = value.get<double>();
        if (field.target.empty()) { // a number that another file format gives out
            if (!(number >= 0 && number <= maxId))
                fail(path, fmt::format("is {}, which is out of range", number));
            return;
        }
        const size_t count = sizeOf(field.target);
        if (!(number >= 0 && number < static_cast<double>(count)))
            fail(path, fmt::format("is {}, but there are {} {}", number, count,
                                   field.target.substr(field.target.rfind('.') + 1)));
    }

    // How many elements the array at `target` (keys with dots between) has; 0 if there is none.
    [[nodiscard]] size_t sizeOf(const std::string& target) const {
        const json* value = &file_.document;
        for (size_t start = 0; start <= target.size();) {
            const size_t end = std::min(target.find('.', start), target.size());
            if (!value->is_object()) return 0;
            const auto member = value->find(target.substr(start, end - start));
            if (member == value->end()) return 0;
            value = &*member;
            start = end + 1;
        }
        return value->is_array() ? value->size() : 0;
    }

    static constexpr double maxId = 4294967295.0;

    GltfFile& file_;
    std::optional<std::set<size_t>> usedMaterials_;
};

// Members that the value of another one makes necessary.
void checkDependentMembers(const GltfFile& file) {
    const nlohmann::json cameras = file.document.value("cameras", nlohmann::json::array());
    for (size_t i = 0; i < cameras.size(); ++i) {
        const std::string& type = cameras[i]["type"].get_ref<const std::string&>();
        if (!cameras[i].contains(type)) failGltf(file, fmt::format("cameras[{}].{} is missing", i, type));
    }
    const nlohmann::json lights =
        file.document.value("/extensions/KHR_lights_punctual/lights"_json_pointer, nlohmann::json::array());
    for (size_t i = 0; i < lights.size(); ++i)
        if (lights[i]["type"] == "spot" && !lights[i].contains("spot"))
            failGltf(file, fmt::format("extensions.KHR_lights_punctual.lights[{}].spot is missing", i));
}

void checkVersion(const GltfFile& file) {
    const auto asset = file.document.find("asset");
    if (asset == file.document.end() || !asset->is_object() || !asset->contains("version") ||
        !(*asset)["version"].is_string())
        failGltf(file, "is not glTF: asset.version is missing");
    const std::string& version = (*asset)["version"].get_ref<const std::string&>();
    if (!version.starts_with("2."))
        failGltf(file, fmt::format("is glTF {}; version 2 is read", version.substr(0, 20)));
    const auto least = asset->find("minVersion");
    if (least != asset->end() && least->is_string() && *least != "2.0")
        failGltf(file, fmt::format("needs a reader of glTF {}; version 2.0 is read",
                                   least->get_ref<const std::string&>().substr(0, 20)));
}

} // namespace

void checkGltfSchema(GltfFile& file) {
    checkVersion(file);
    Checker(file).checkObject(file.document, gltfDocumentShape(), "");
    checkDependentMembers(file);
}

} // namespace kestrel
