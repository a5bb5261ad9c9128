// Materials, textures, samplers and images into a glTF file.
#include "core/check.h"
#include "scene/gltf_writer.h"
#include <algorithm>
#include <stb_image_write.h>

namespace kestrel {
namespace {

std::vector<std::byte> encodePng(const TextureImage& image) {
    std::vector<std::byte> bytes;
    const auto append = [](void* context, void* data, int size) {
        auto& target = *static_cast<std::vector<std::byte>*>(context);
        const auto* first = static_cast<const std::byte*>(data);
        target.insert(target.end(), first, first + size);
    };
    const int written = stbi_write_png_to_func(append, &bytes, image.width, image.height, 4,
                                               image.rgba.data(), 4 * image.width);
    KESTREL_CHECK(written != 0);
    return bytes;
}

int wrapMode(Wrap wrap) {
    switch (wrap) {
    case Wrap::MirroredRepeat:
        return 33648;
    case Wrap::ClampToEdge:
        return 33071;
    case Wrap::Repeat:
        break;
    }
    return 10497;
}

// The index of `element` in an array of the document, where it is put if it is not there yet.
size_t findOrAppend(GltfWriter& writer, const char* array, OrderedJson element) {
    const OrderedJson& list = writer.document[array];
    const auto found = std::find(list.begin(), list.end(), element);
    if (found != list.end()) return static_cast<size_t>(found - list.begin());
    return writer.append(array, std::move(element));
}

OrderedJson textureJson(GltfWriter& writer, const TextureRef& ref) {
    OrderedJson sampler = {{"wrapS", wrapMode(ref.wrapS)}, {"wrapT", wrapMode(ref.wrapT)}};
    if (ref.nearest) sampler["magFilter"] = 9728;
    const size_t samplerIndex = findOrAppend(writer, "samplers", std::move(sampler));
    OrderedJson json = {
        {"index", findOrAppend(writer, "textures", {{"sampler", samplerIndex}, {"source", ref.image}})}};
    if (ref.texCoord != 0) json["texCoord"] = ref.texCoord;
    OrderedJson transform = OrderedJson::object();
    if (ref.offset != glm::vec2(0)) transform["offset"] = jsonNumbers(ref.offset, 2);
    if (ref.rotation != 0) transform["rotation"] = double(ref.rotation);
    if (ref.scale != glm::vec2(1)) transform["scale"] = jsonNumbers(ref.scale, 2);
    if (!transform.empty()) {
        writer.use("KHR_texture_transform");
        json["extensions"]["KHR_texture_transform"] = std::move(transform);
    }
    return json;
}

void addTexture(GltfWriter& writer, OrderedJson& json, const char* name, const TextureRef& ref) {
    if (ref.present()) json[name] = textureJson(writer, ref);
}

void addEmission(GltfWriter& writer, OrderedJson& json, const Material& material) {
    const double largest = double(std::max({material.emission.x, material.emission.y, material.emission.z}));
    if (largest == 0) return;
    // The factor is at most 1; in double, factor times strength rounds back to the same float.
    const double strength = std::max(largest, 1.0);
    OrderedJson factor = OrderedJson::array();
    for (int i = 0; i < 3; ++i) factor.push_back(double(material.emission[i]) / strength);
    json["emissiveFactor"] = std::move(factor);
    if (strength == 1) return;
    writer.use("KHR_materials_emissive_strength");
    json["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
}

void addExtensions(GltfWriter& writer, OrderedJson& json, const Material& material) {
    if (material.unlit) {
        writer.use("KHR_materials_unlit");
        json["extensions"]["KHR_materials_unlit"] = OrderedJson::object();
    }
    if (material.transmission != 0) {
        writer.use("KHR_materials_transmission");
        json["extensions"]["KHR_materials_transmission"]["transmissionFactor"] =
            double(material.transmission);
    }
    if (material.ior != 1.5f) {
        writer.use("KHR_materials_ior");
        json["extensions"]["KHR_materials_ior"]["ior"] = double(material.ior);
    }
}

OrderedJson materialJson(GltfWriter& writer, const Material& material) {
    OrderedJson surface;
    surface["baseColorFactor"] = jsonNumbers(material.baseColour, 4);
    surface["metallicFactor"] = double(material.metallic);
    surface["roughnessFactor"] = double(material.roughness);
    addTexture(writer, surface, "baseColorTexture", material.baseColourTexture);
    addTexture(writer, surface, "metallicRoughnessTexture", material.metallicRoughnessTexture);
    OrderedJson json;
    if (!material.name.empty()) json["name"] = material.name;
    json["pbrMetallicRoughness"] = std::move(surface);
    addTexture(writer, json, "normalTexture", material.normalTexture);
    if (material.normalTexture.present()) json["normalTexture"]["scale"] = double(material.normalScale);
    addTexture(writer, json, "emissiveTexture", material.emissionTexture);
    if (material.alphaMode != AlphaMode::Opaque || material.alphaCutoff != 0.5f) {
        constexpr const char* modes[] = {"OPAQUE", "MASK", "BLEND"};
        json["alphaMode"] = modes[static_cast<size_t>(material.alphaMode)];
        json["alphaCutoff"] = double(material.alphaCutoff);
    }
    if (material.doubleSided) json["doubleSided"] = true;
    addEmission(writer, json, material);
    addExtensions(writer, json, material);
    return json;
}

} // namespace

void writeGltfMaterials(GltfWriter& writer, const Scene& scene) {
    for (const TextureImage& image : scene.images) {
        OrderedJson json;
        if (!image.name.empty()) json["name"] = image.name;
        json["bufferView"] = writer.addView(encodePng(image));
        json["mimeType"] = "image/png";
        writer.append("images", std::move(json));
    }
    for (const Material& material : scene.materials)
        writer.append("materials", materialJson(writer, material));
}

} // namespace kestrel
