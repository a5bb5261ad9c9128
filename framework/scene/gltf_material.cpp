// Images, samplers, textures and materials of a glTF file.
#include "scene/gltf_context.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <span>
#include <stb_image.h>

namespace kestrel {
namespace {

constexpr int maxImageSide = 16384;

bool startsWith(std::span<const std::byte> bytes, std::initializer_list<unsigned> magic) {
    return bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin(),
                      [](unsigned a, std::byte b) { return std::byte(a) == b; });
}

bool isReadable(std::span<const std::byte> bytes) {
    return startsWith(bytes, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}) ||
           startsWith(bytes, {0xFF, 0xD8, 0xFF});
}

std::vector<std::byte> imageBytes(const GltfContext& context, const nlohmann::json& image,
                                  const std::string& what) {
    if (image.contains("uri")) return readUri(context.file, image["uri"].get_ref<const std::string&>(), what);
    if (!image.contains("bufferView")) context.fail(what + " has neither uri nor bufferView");
    const size_t index = image["bufferView"].get<size_t>();
    const tinygltf::BufferView& view = context.model.bufferViews[index];
    const std::vector<std::byte>& buffer = context.file.buffers[static_cast<size_t>(view.buffer)];
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
        context.fail(fmt::format("{}: bufferViews[{}] lies beyond buffers[{}]", what, index, view.buffer));
    const auto first = buffer.begin() + static_cast<std::ptrdiff_t>(view.byteOffset);
    return {first, first + static_cast<std::ptrdiff_t>(view.byteLength)};
}

TextureImage decodeImage(const GltfContext& context, std::span<const std::byte> bytes,
                         const std::string& what, std::uint64_t& pixelsLeft) {
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    // A file is at most 2 GiB large, but stb counts in int.
    if (bytes.size() > 0x7FFFFFFF) context.fail(what + " is too large");
    const int size = static_cast<int>(bytes.size());
    TextureImage image;
    int channels = 0;
    if (stbi_info_from_memory(data, size, &image.width, &image.height, &channels) == 0)
        context.fail(what + " is a broken image");
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
    if (image.width > maxImageSide || image.height > maxImageSide || pixels > pixelsLeft)
        context.fail(fmt::format("{} has {} x {} pixels; at most {} to a side and {} in all images are read",
                                 what, image.width, image.height, maxImageSide, context.file.limits.pixels));
    pixelsLeft -= pixels;
    const std::unique_ptr<stbi_uc, void (*)(void*)> decoded(
        stbi_load_from_memory(data, size, &image.width, &image.height, &channels, 4), stbi_image_free);
    if (!decoded) context.fail(fmt::format("{} is a broken image: {}", what, stbi_failure_reason()));
    image.rgba.assign(decoded.get(), decoded.get() + 4 * pixels);
    return image;
}

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
    if (texture.source < 0) {
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
    ref.image = context.imageIndex[static_cast<size_t>(texture.source)];
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
    return material;
}

} // namespace

void readGltfImages(GltfContext& context) {
    const auto images = context.file.document.find("images");
    if (images == context.file.document.end()) return;
    std::uint64_t pixelsLeft = context.file.limits.pixels;
    for (size_t i = 0; i < images->size(); ++i) {
        const nlohmann::json& source = (*images)[i];
        const std::string what = fmt::format("images[{}]", i);
        const std::vector<std::byte> bytes = imageBytes(context, source, what);
        context.imageIndex.push_back(-1);
        if (!isReadable(bytes)) {
            context.warn(what + " is neither PNG nor JPEG and is ignored");
            continue;
        }
        TextureImage image = decodeImage(context, bytes, what, pixelsLeft);
        image.name = source.value("name", "");
        context.imageIndex.back() = static_cast<int>(context.scene.images.size());
        context.scene.images.push_back(std::move(image));
    }
}

void readGltfMaterials(GltfContext& context) {
    for (const tinygltf::Material& source : context.model.materials)
        context.scene.materials.push_back(readMaterial(context, source));
}

} // namespace kestrel
