#include "scene/gltf_shapes.h"

namespace kestrel {
namespace {

GltfField field(const char* name, GltfKind kind) {
    GltfField made;
    made.name = name;
    made.kind = kind;
    return made;
}
GltfField boolean(const char* name) { return field(name, GltfKind::Bool); }
GltfField number(const char* name) { return field(name, GltfKind::Number); }
GltfField number(const char* name, double min, double max = std::numeric_limits<float>::max()) {
    GltfField made = number(name);
    made.min = min;
    made.max = max;
    return made;
}
GltfField integer(const char* name, double min = 0, double max = 9e15) {
    GltfField made = number(name, min, max);
    made.kind = GltfKind::Integer;
    return made;
}
GltfField string(const char* name, std::vector<std::string> choices = {}) {
    GltfField made = field(name, GltfKind::String);
    made.choices = std::move(choices);
    return made;
}
GltfField index(const char* name, const char* target, GltfKind kind = GltfKind::Index) {
    GltfField made = field(name, kind);
    made.target = target;
    return made;
}
GltfField object(const char* name, const GltfShape& shape) {
    GltfField made = field(name, GltfKind::Object);
    made.shape = &shape;
    return made;
}

constexpr double maxInt = 2147483647;
constexpr double maxUnit = 1;

// Shapes below name the members that the importer reads, inner objects first.

const GltfShape& bufferShape() {
    static const GltfShape fallback{boolean("fallback")};
    static const GltfShape extensions{object("EXT_meshopt_compression", fallback),
                                      object("KHR_meshopt_compression", fallback)};
    static const GltfShape shape{integer("byteLength", 1).required(), string("uri"),
                                 object("extensions", extensions)};
    return shape;
}

const GltfShape& bufferViewShape() {
    static const GltfShape compression{index("buffer", "buffers").required(),
                                       integer("byteOffset"),
                                       integer("byteLength", 1).required(),
                                       integer("byteStride", 2, 256).required(),
                                       integer("count", 1).required(),
                                       string("mode").required(),
                                       string("filter")};
    static const GltfShape extensions{object("EXT_meshopt_compression", compression),
                                      object("KHR_meshopt_compression", compression)};
    static const GltfShape shape{index("buffer", "buffers").required(), integer("byteOffset"),
                                 integer("byteLength", 1).required(), integer("byteStride", 4, 252),
                                 object("extensions", extensions)};
    return shape;
}

const GltfShape& accessorShape() {
    static const GltfShape sparseIndices{index("bufferView", "bufferViews").required(),
                                         integer("byteOffset", 0, maxInt),
                                         integer("componentType", 0, maxInt).required()};
    static const GltfShape sparseValues{index("bufferView", "bufferViews").required(),
                                        integer("byteOffset", 0, maxInt)};
    static const GltfShape sparse{integer("count", 1, maxInt).required(),
                                  object("indices", sparseIndices).required(),
                                  object("values", sparseValues).required()};
    static const GltfShape shape{
        index("bufferView", "bufferViews"),
        integer("byteOffset"),
        integer("componentType", 5120, 5126).required(),
        boolean("normalized"),
        integer("count", 1).required(),
        string("type", {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"}).required(),
        object("sparse", sparse)};
    return shape;
}

const GltfShape& meshShape() {
    static const GltfShape draco{index("bufferView", "bufferViews").required(),
                                 field("attributes", GltfKind::IndexMap).required()};
    static const GltfShape extensions{object("KHR_draco_mesh_compression", draco)};
    static const GltfShape primitive{index("attributes", "accessors", GltfKind::IndexMap).required(),
                                     index("indices", "accessors"),
                                     index("material", "materials"),
                                     integer("mode", 0, maxInt),
                                     object("extensions", extensions),
                                     index("targets", "accessors", GltfKind::IndexMap).array()};
    static const GltfShape shape{string("name"), object("primitives", primitive).array().required(),
                                 number("weights").array()};
    return shape;
}

const GltfShape& nodeShape() {
    static const GltfShape areaLight{string("kind").required(),
                                     string("name"),
                                     number("colour", 0).array(3),
                                     number("intensity", 0),
                                     number("half_size", 0).array(2).required(),
                                     integer("index", 0, maxInt)};
    static const GltfShape extras{object("KESTREL_area_light", areaLight)};
    static const GltfShape lightReference{index("light", "extensions.KHR_lights_punctual.lights").required()};
    static const GltfShape instancing{index("attributes", "accessors", GltfKind::IndexMap).required()};
    static const GltfShape extensions{object("KHR_lights_punctual", lightReference),
                                      object("EXT_mesh_gpu_instancing", instancing)};
    static const GltfShape shape{string("name"),
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

const GltfShape& textureInfoShape() {
    static const GltfShape transform{number("offset").array(2), number("rotation"), number("scale").array(2),
                                     integer("texCoord", 0, 255)};
    static const GltfShape extensions{object("KHR_texture_transform", transform)};
    static const GltfShape shape{index("index", "textures").required(), integer("texCoord", 0, 255),
                                 number("scale"), object("extensions", extensions)};
    return shape;
}

const GltfShape& materialShape() {
    static const GltfShape metallicRoughness{
        number("baseColorFactor", 0, maxUnit).array(4), object("baseColorTexture", textureInfoShape()),
        number("metallicFactor", 0, maxUnit), number("roughnessFactor", 0, maxUnit),
        object("metallicRoughnessTexture", textureInfoShape())};
    static const GltfShape strength{number("emissiveStrength", 0)};
    static const GltfShape transmission{number("transmissionFactor", 0, maxUnit)};
    static const GltfShape ior{number("ior", 0)};
    static const GltfShape unlit{};
    static const GltfShape specular{
        number("diffuseFactor", 0, maxUnit).array(4), number("specularFactor", 0, maxUnit).array(3),
        number("glossinessFactor", 0, maxUnit), object("diffuseTexture", textureInfoShape()),
        object("specularGlossinessTexture", textureInfoShape())};
    static const GltfShape extensions{object("KHR_materials_emissive_strength", strength),
                                      object("KHR_materials_transmission", transmission),
                                      object("KHR_materials_ior", ior), object("KHR_materials_unlit", unlit),
                                      object("KHR_materials_pbrSpecularGlossiness", specular)};
    static const GltfShape shape{string("name"),
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

const GltfShape& animationShape() {
    static const GltfShape target{index("node", "nodes"), string("path").required()};
    static const GltfShape channel{integer("sampler", 0, maxInt).required(),
                                   object("target", target).required()};
    static const GltfShape sampler{index("input", "accessors").required(),
                                   index("output", "accessors").required(), string("interpolation")};
    static const GltfShape shape{string("name"), object("channels", channel).array().required(),
                                 object("samplers", sampler).array().required()};
    return shape;
}

const GltfShape& cameraShape() {
    static const GltfShape perspective{number("yfov").required(), number("znear").required(), number("zfar"),
                                       number("aspectRatio")};
    static const GltfShape orthographic{number("xmag").required(), number("ymag").required(),
                                        number("znear").required(), number("zfar").required()};
    static const GltfShape extras{boolean("KESTREL_frame_aspect")};
    static const GltfShape shape{string("name"), string("type", {"perspective", "orthographic"}).required(),
                                 object("perspective", perspective), object("orthographic", orthographic),
                                 object("extras", extras)};
    return shape;
}

const GltfShape& lightsShape() {
    static const GltfShape spot{number("innerConeAngle"), number("outerConeAngle")};
    static const GltfShape light{string("name"),
                                 string("type", {"point", "spot", "directional"}).required(),
                                 number("color", 0).array(3),
                                 number("intensity", 0),
                                 number("range", 0),
                                 object("spot", spot)};
    static const GltfShape lights{object("lights", light).array().required()};
    static const GltfShape shape{object("KHR_lights_punctual", lights)};
    return shape;
}

} // namespace

const GltfShape& gltfDocumentShape() {
    static const GltfShape scene{string("name"), index("nodes", "nodes").array()};
    static const GltfShape image{string("name"), string("uri"), index("bufferView", "bufferViews"),
                                 string("mimeType")};
    static const GltfShape sampler{integer("magFilter", 0, maxInt), integer("wrapS", 0, maxInt),
                                   integer("wrapT", 0, maxInt)};
    static const GltfShape webp{index("source", "images")};
    static const GltfShape textureExtensions{object("EXT_texture_webp", webp)};
    static const GltfShape texture{index("sampler", "samplers"), index("source", "images"),
                                   object("extensions", textureExtensions)};
    static const GltfShape skin{string("name"), index("joints", "nodes").array().required(),
                                index("inverseBindMatrices", "accessors")};
    static const GltfShape shape{string("extensionsUsed").array(),
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

} // namespace kestrel
