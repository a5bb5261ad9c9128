// Samplers, texture references and materials of a glTF file.
#include "scene/gltf_context.h"
#include "scene/gltf_image.h"
#include "scene/gltf_specular.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

Wrap wrapOf(GltfContext& context, int mode) {
    switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
        return Wrap::Repeat;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
        return Wrap::MirroredRepeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
        return Wrap::ClampToEdge;
    default:
        context.warn(fmt::format("the texture wrap mode {} is read as repeat", mode));
        return Wrap::Repeat;
    }
}

glm::vec2 vec2Of(const tinygltf::Value& object, const char* name, glm::vec2 otherwise) {
    if (!object.Has(name)) return otherwise;
    const tinygltf::Value& array = object.Get(name);
    return {static_cast<float>(array.Get(0).GetNumberAsDouble()),
            static_cast<float>(array.Get(1).GetNumberAsDouble())};
}

// `info` is one of tinygltf's texture infos, which share members but no type.
TextureRef textureRef(GltfContext& context, const auto& info) {
    TextureRef ref;
    if (info.index < 0) return ref;
    const tinygltf::Texture& texture = context.model.textures[static_cast<size_t>(info.index)];
    const int source = gltfTextureSource(context, static_cast<size_t>(info.index));
    if (source < 0) {
        context.warn(fmt::format("textures[{}] has no image that can be read and is ignored", info.index));
        return ref;
    }
    ref.texCoord = info.texCoord;
    if (const tinygltf::Value* transform = gltfExtension(info.extensions, "KHR_texture_transform")) {
        ref.offset = vec2Of(*transform, "offset", ref.offset);
        ref.scale = vec2Of(*transform, "scale", ref.scale);
        ref.rotation = static_cast<float>(gltfNumber(*transform, "rotation", 0));
        ref.texCoord = static_cast<int>(gltfNumber(*transform, "texCoord", ref.texCoord));
    }
    if (ref.texCoord > 1) {
        context.warn(fmt::format("a texture with the coordinates TEXCOORD_{} is ignored", ref.texCoord));
        return {};
    }
    if (texture.sampler >= 0) {
        const tinygltf::Sampler& sampler = context.model.samplers[static_cast<size_t>(texture.sampler)];
        ref.wrapS = wrapOf(context, sampler.wrapS);
        ref.wrapT = wrapOf(context, sampler.wrapT);
        ref.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    ref.image = context.imageIndex[static_cast<size_t>(source)];
    return ref.present() ? ref : TextureRef{};
}

AlphaMode alphaModeOf(const std::string& name) {
    if (name == "MASK") return AlphaMode::Mask;
    return name == "BLEND" ? AlphaMode::Blend : AlphaMode::Opaque;
}

void readExtensions(GltfContext& context, const tinygltf::Material& source, Material& material) {
    double strength = 1;
    if (const auto* extension = gltfExtension(source.extensions, "KHR_materials_emissive_strength"))
        strength = gltfNumber(*extension, "emissiveStrength", 1);
    for (int i = 0; i < 3; ++i) {
        const double emission = strength * source.emissiveFactor[static_cast<size_t>(i)];
        material.emission[i] = static_cast<float>(emission);
        if (!std::isfinite(material.emission[i]))
            context.fail(fmt::format("material '{}' has an emission that is out of range", source.name));
    }
    // tinygltf drops empty objects, so the document tells whether a material is unlit.
    const size_t index = static_cast<size_t>(&source - context.model.materials.data());
    const nlohmann::json& json = context.file.document["materials"][index];
    material.unlit = json.contains("extensions") && json["extensions"].contains("KHR_materials_unlit");
    if (const auto* extension = gltfExtension(source.extensions, "KHR_materials_transmission")) {
        material.transmission = static_cast<float>(gltfNumber(*extension, "transmissionFactor", 0));
        if (extension->Has("transmissionTexture")) context.warn("transmission textures are ignored");
    }
    if (const auto* extension = gltfExtension(source.extensions, "KHR_materials_ior"))
        material.ior = static_cast<float>(gltfNumber(*extension, "ior", 1.5));
}

// Of an extension, whose texture infos tinygltf keeps as values only.
TextureRef textureRefOf(GltfContext& context, const nlohmann::json& extension, const char* name) {
    const auto found = extension.find(name);
    if (found == extension.end()) return {};
    tinygltf::TextureInfo info;
    info.index = (*found)["index"].get<int>();
    info.texCoord = found->value("texCoord", 0);
    const auto extensions = found->find("extensions");
    if (extensions == found->end() || !extensions->contains("KHR_texture_transform"))
        return textureRef(context, info);
    tinygltf::Value::Object transform;
    for (const auto& [key, value] : (*extensions)["KHR_texture_transform"].items())
        if (value.is_number()) {
            transform[key] = tinygltf::Value(value.get<double>());
        } else if (value.is_array() && value.size() == 2) {
            tinygltf::Value::Array pair;
            for (const nlohmann::json& one : value) pair.emplace_back(one.get<double>());
            transform[key] = tinygltf::Value(std::move(pair));
        }
    info.extensions["KHR_texture_transform"] = tinygltf::Value(std::move(transform));
    return textureRef(context, info);
}

SpecularMaterial readSpecular(GltfContext& context, const nlohmann::json& extension) {
    SpecularMaterial specular;
    const auto diffuse = extension.value("diffuseFactor", std::vector<float>{1, 1, 1, 1});
    const auto factor = extension.value("specularFactor", std::vector<float>{1, 1, 1});
    for (int i = 0; i < 4; ++i) specular.diffuse[i] = diffuse[static_cast<size_t>(i)];
    for (int i = 0; i < 3; ++i) specular.specular[i] = factor[static_cast<size_t>(i)];
    specular.glossiness = extension.value("glossinessFactor", 1.0f);
    specular.diffuseTexture = textureRefOf(context, extension, "diffuseTexture");
    specular.specularTexture = textureRefOf(context, extension, "specularGlossinessTexture");
    return specular;
}

Material readMaterial(GltfContext& context, const tinygltf::Material& source) {
    const tinygltf::PbrMetallicRoughness& surface = source.pbrMetallicRoughness;
    Material material;
    material.name = source.name;
    for (int i = 0; i < 4; ++i)
        material.baseColour[i] = static_cast<float>(surface.baseColorFactor[static_cast<size_t>(i)]);
    material.metallic = static_cast<float>(surface.metallicFactor);
    material.roughness = static_cast<float>(surface.roughnessFactor);
    material.normalScale = static_cast<float>(source.normalTexture.scale);
    material.alphaMode = alphaModeOf(source.alphaMode);
    material.alphaCutoff = static_cast<float>(source.alphaCutoff);
    material.doubleSided = source.doubleSided;
    material.baseColourTexture = textureRef(context, surface.baseColorTexture);
    material.metallicRoughnessTexture = textureRef(context, surface.metallicRoughnessTexture);
    material.normalTexture = textureRef(context, source.normalTexture);
    material.emissionTexture = textureRef(context, source.emissiveTexture);
    if (source.occlusionTexture.index >= 0) context.warn("occlusion textures are ignored");
    readExtensions(context, source, material);
    const size_t index = static_cast<size_t>(&source - context.model.materials.data());
    const nlohmann::json& json = context.file.document["materials"][index];
    if (const auto extensions = json.find("extensions"); extensions != json.end())
        if (const auto found = extensions->find("KHR_materials_pbrSpecularGlossiness");
            found != extensions->end())
            convertSpecular(context, readSpecular(context, *found), material);
    return material;
}

} // namespace

void readGltfMaterials(GltfContext& context) {
    for (const tinygltf::Material& source : context.model.materials)
        context.scene.materials.push_back(readMaterial(context, source));
    warnOfReducedImages(context);
}

} // namespace kestrel
