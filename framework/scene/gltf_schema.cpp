#include "scene/gltf_schema.h"
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace kestrel {
namespace {

using nlohmann::json;

enum class Kind { Bool, String, Integer, Number, Index, IndexMap, Object };

struct Field;
using Shape = std::vector<Field>;

// One member of an object.
struct Field {
    std::string name;
    Kind kind = Kind::Number;
    bool isRequired = false;
    bool isArray = false;
    size_t length = 0; // of the array; 0: any
    double min = -std::numeric_limits<float>::max(), max = std::numeric_limits<float>::max();
    std::string target;               // Index: the array at the top level that it refers to
    std::vector<std::string> choices; // String: the values that are allowed; empty: any
    const Shape* shape = nullptr;     // Object

    Field required() && {
        isRequired = true;
        return std::move(*this);
    }
    Field array(size_t count = 0) && {
        isArray = true;
        length = count;
        return std::move(*this);
    }
};

Field field(const char* name, Kind kind) {
    Field made;
    made.name = name;
    made.kind = kind;
    return made;
}
Field boolean(const char* name) { return field(name, Kind::Bool); }
Field number(const char* name) { return field(name, Kind::Number); }
Field number(const char* name, double min, double max = std::numeric_limits<float>::max()) {
    Field made = number(name);
    made.min = min;
    made.max = max;
    return made;
}
Field integer(const char* name, double min = 0, double max = 9e15) {
    Field made = number(name, min, max);
    made.kind = Kind::Integer;
    return made;
}
Field string(const char* name, std::vector<std::string> choices = {}) {
    Field made = field(name, Kind::String);
    made.choices = std::move(choices);
    return made;
}
Field index(const char* name, const char* target, Kind kind = Kind::Index) {
    Field made = field(name, kind);
    made.target = target;
    return made;
}
Field object(const char* name, const Shape& shape) {
    Field made = field(name, Kind::Object);
    made.shape = &shape;
    return made;
}

constexpr double maxInt = 2147483647;
constexpr double maxUnit = 1;

// Shapes below name the members that the importer reads, inner objects first.

const Shape& bufferShape() {
    static const Shape shape{integer("byteLength", 1).required(), string("uri")};
    return shape;
}

const Shape& bufferViewShape() {
    static const Shape shape{index("buffer", "buffers").required(), integer("byteOffset"),
                             integer("byteLength", 1).required(), integer("byteStride", 4, 252)};
    return shape;
}

const Shape& accessorShape() {
    static const Shape sparseIndices{index("bufferView", "bufferViews").required(),
                                     integer("byteOffset", 0, maxInt),
                                     integer("componentType", 5121, 5125).required()};
    static const Shape sparseValues{index("bufferView", "bufferViews").required(),
                                    integer("byteOffset", 0, maxInt)};
    static const Shape sparse{integer("count", 1, maxInt).required(),
                              object("indices", sparseIndices).required(),
                              object("values", sparseValues).required()};
    static const Shape shape{
        index("bufferView", "bufferViews"),
        integer("byteOffset"),
        integer("componentType", 5120, 5126).required(),
        boolean("normalized"),
        integer("count", 1).required(),
        string("type", {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"}).required(),
        object("sparse", sparse)};
    return shape;
}

const Shape& meshShape() {
    static const Shape primitive{index("attributes", "accessors", Kind::IndexMap).required(),
                                 index("indices", "accessors"), index("material", "materials"),
                                 integer("mode", 0, 6),
                                 index("targets", "accessors", Kind::IndexMap).array()};
    static const Shape shape{string("name"), object("primitives", primitive).array().required(),
                             number("weights").array()};
    return shape;
}

const Shape& nodeShape() {
    static const Shape areaLight{string("kind", {"rectangle", "sphere"}).required(),
                                 string("name"),
                                 number("colour", 0).array(3),
                                 number("intensity", 0),
                                 number("half_size", 0).array(2).required(),
                                 integer("index", 0, maxInt)};
    static const Shape extras{object("KESTREL_area_light", areaLight)};
    static const Shape lightReference{index("light", "extensions.KHR_lights_punctual.lights").required()};
    static const Shape extensions{object("KHR_lights_punctual", lightReference)};
    static const Shape shape{string("name"),
                             index("children", "nodes").array(),
                             number("matrix").array(16),
                             number("translation").array(3),
                             number("rotation").array(4),
                             number("scale").array(3),
                             index("mesh", "meshes"),
                             index("skin", "skins"),
                             index("camera", "cameras"),
                             number("weights").array(),
                             object("extensions", extensions),
                             object("extras", extras)};
    return shape;
}

const Shape& textureInfoShape() {
    static const Shape transform{number("offset").array(2), number("rotation"), number("scale").array(2),
                                 integer("texCoord", 0, 255)};
    static const Shape extensions{object("KHR_texture_transform", transform)};
    static const Shape shape{index("index", "textures").required(), integer("texCoord", 0, 255),
                             number("scale"), object("extensions", extensions)};
    return shape;
}

const Shape& materialShape() {
    static const Shape metallicRoughness{
        number("baseColorFactor", 0, maxUnit).array(4), object("baseColorTexture", textureInfoShape()),
        number("metallicFactor", 0, maxUnit), number("roughnessFactor", 0, maxUnit),
        object("metallicRoughnessTexture", textureInfoShape())};
    static const Shape strength{number("emissiveStrength", 0)};
    static const Shape transmission{number("transmissionFactor", 0, maxUnit)};
    static const Shape ior{number("ior", 0)};
    static const Shape unlit{};
    static const Shape extensions{object("KHR_materials_emissive_strength", strength),
                                  object("KHR_materials_transmission", transmission),
                                  object("KHR_materials_ior", ior), object("KHR_materials_unlit", unlit)};
    static const Shape shape{string("name"),
                             object("pbrMetallicRoughness", metallicRoughness),
                             object("normalTexture", textureInfoShape()),
                             object("occlusionTexture", textureInfoShape()),
                             object("emissiveTexture", textureInfoShape()),
                             number("emissiveFactor", 0).array(3),
                             string("alphaMode", {"OPAQUE", "MASK", "BLEND"}),
                             number("alphaCutoff", 0),
                             boolean("doubleSided"),
                             object("extensions", extensions)};
    return shape;
}

const Shape& animationShape() {
    static const Shape target{index("node", "nodes"), string("path").required()};
    static const Shape channel{integer("sampler", 0, maxInt).required(), object("target", target).required()};
    static const Shape sampler{index("input", "accessors").required(),
                               index("output", "accessors").required(),
                               string("interpolation", {"LINEAR", "STEP", "CUBICSPLINE"})};
    static const Shape shape{string("name"), object("channels", channel).array().required(),
                             object("samplers", sampler).array().required()};
    return shape;
}

const Shape& cameraShape() {
    static const Shape perspective{number("yfov").required(), number("znear").required(), number("zfar"),
                                   number("aspectRatio")};
    static const Shape orthographic{number("xmag").required(), number("ymag").required(),
                                    number("znear").required(), number("zfar").required()};
    static const Shape extras{boolean("KESTREL_frame_aspect")};
    static const Shape shape{string("name"), string("type", {"perspective", "orthographic"}).required(),
                             object("perspective", perspective), object("orthographic", orthographic),
                             object("extras", extras)};
    return shape;
}

const Shape& lightsShape() {
    static const Shape spot{number("innerConeAngle"), number("outerConeAngle")};
    static const Shape light{string("name"),
                             string("type", {"point", "spot", "directional"}).required(),
                             number("color", 0).array(3),
                             number("intensity", 0),
                             number("range", 0),
                             object("spot", spot)};
    static const Shape lights{object("lights", light).array().required()};
    static const Shape shape{object("KHR_lights_punctual", lights)};
    return shape;
}

const Shape& documentShape() {
    static const Shape scene{string("name"), index("nodes", "nodes").array()};
    static const Shape image{string("name"), string("uri"), index("bufferView", "bufferViews"),
                             string("mimeType")};
    static const Shape sampler{integer("magFilter", 0, maxInt), integer("wrapS", 0, maxInt),
                               integer("wrapT", 0, maxInt)};
    static const Shape texture{index("sampler", "samplers"), index("source", "images")};
    static const Shape skin{string("name"), index("joints", "nodes").array().required(),
                            index("inverseBindMatrices", "accessors")};
    static const Shape shape{string("extensionsUsed").array(),
                             string("extensionsRequired").array(),
                             object("buffers", bufferShape()).array(),
                             object("bufferViews", bufferViewShape()).array(),
                             object("accessors", accessorShape()).array(),
                             object("meshes", meshShape()).array(),
                             object("nodes", nodeShape()).array(),
                             object("scenes", scene).array(),
                             index("scene", "scenes"),
                             object("materials", materialShape()).array(),
                             object("images", image).array(),
                             object("textures", texture).array(),
                             object("samplers", sampler).array(),
                             object("skins", skin).array(),
                             object("animations", animationShape()).array(),
                             object("cameras", cameraShape()).array(),
                             object("extensions", lightsShape())};
    return shape;
}

class Checker {
public:
    explicit Checker(GltfFile& file)
        : file_(file) {}

    void checkObject(json& value, const Shape& shape, const std::string& path) {
        if (!value.is_object()) fail(path, "is not an object");
        for (const Field& field : shape) {
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

    void checkArray(json& value, const Field& field, const std::string& path) {
        if (!value.is_array()) fail(path, "is not an array");
        if (field.length != 0 && value.size() != field.length)
            fail(path, fmt::format("has {} numbers, not {}", value.size(), field.length));
        for (size_t i = 0; i < value.size(); ++i) checkValue(value[i], field, fmt::format("{}[{}]", path, i));
    }

    void checkValue(json& value, const Field& field, const std::string& path) {
        switch (field.kind) {
        case Kind::Bool:
            if (!value.is_boolean()) fail(path, "is neither true nor false");
            break;
        case Kind::String:
            checkString(value, field, path);
            break;
        case Kind::Integer:
        case Kind::Number:
            checkNumber(value, field, path);
            break;
        case Kind::Index:
            checkIndex(value, field, path);
            break;
        case Kind::IndexMap:
            if (!value.is_object()) fail(path, "is not an object");
            for (auto& [name, one] : value.items()) checkIndex(one, field, path + "." + name);
            break;
        case Kind::Object:
            checkObject(value, *field.shape, path);
            break;
        }
    }

    void checkString(const json& value, const Field& field, const std::string& path) const {
        if (!value.is_string()) fail(path, "is not a string");
        if (field.choices.empty()) return;
        for (const std::string& choice : field.choices)
            if (value.get_ref<const std::string&>() == choice) return;
        fail(path, fmt::format("is '{}'; it can be {}", value.get<std::string>().substr(0, 60),
                               fmt::join(field.choices, ", ")));
    }

    void checkNumber(json& value, const Field& field, const std::string& path) const {
        if (!value.is_number()) fail(path, "is not a number");
        const double number = value.get<double>();
        if (field.kind == Kind::Integer) makeInteger(value, path);
        // Integers above 2^31 would be cut off where only a number is meant.
        else if (value.is_number_integer())
            value = number;
        if (!(number >= field.min && number <= field.max))
            fail(path, field.max < 1e15
                           ? fmt::format("is {}, not within {} to {}", number, field.min, field.max)
                           : fmt::format("is {}, which is out of range", number));
    }

    void makeInteger(json& value, const std::string& path) const {
        if (value.is_number_integer()) return;
        const double number = value.get<double>();
        if (number != std::floor(number) || std::abs(number) > 9e15) fail(path, "is not a whole number");
        value = static_cast<std::int64_t>(number);
        if (number >= 0) value = static_cast<std::uint64_t>(number);
    }

    void checkIndex(json& value, const Field& field, const std::string& path) const {
        if (!value.is_number()) fail(path, "is not a number");
        makeInteger(value, path);
        const size_t count = sizeOf(field.target);
        const double number = value.get<double>();
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

    GltfFile& file_;
};

void checkVersion(const GltfFile& file) {
    const auto asset = file.document.find("asset");
    if (asset == file.document.end() || !asset->is_object() || !asset->contains("version") ||
        !(*asset)["version"].is_string())
        failGltf(file, "is not glTF: asset.version is missing");
    const std::string& version = (*asset)["version"].get_ref<const std::string&>();
    if (!version.starts_with("2."))
        failGltf(file, fmt::format("is glTF {}; version 2 is read", version.substr(0, 20)));
}

} // namespace

void checkGltfSchema(GltfFile& file) {
    checkVersion(file);
    Checker(file).checkObject(file.document, documentShape(), "");
}

} // namespace kestrel
