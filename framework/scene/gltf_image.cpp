#include "scene/gltf_image.h"
#include "scene/gltf_context.h"
#include "scene/gltf_views.h"
#include <algorithm>
#include <fmt/format.h>
#include <initializer_list>
#include <memory>
#include <span>
#include <stb_image.h>
#ifdef KESTREL_HAS_WEBP
#include <webp/decode.h>
#endif

namespace kestrel {
namespace {

constexpr int maxImageSide = 16384;

enum class ImageEncoding { Png, Jpeg, WebP, Ktx2, Unknown };

bool startsWith(std::span<const std::byte> bytes, std::initializer_list<unsigned> magic) {
    return bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin(),
                      [](unsigned a, std::byte b) { return std::byte(a) == b; });
}

// By the first bytes: what mimeType says is often wrong.
ImageEncoding encodingOf(std::span<const std::byte> bytes) {
    if (startsWith(bytes, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'})) return ImageEncoding::Png;
    if (startsWith(bytes, {0xFF, 0xD8, 0xFF})) return ImageEncoding::Jpeg;
    if (startsWith(bytes, {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB})) return ImageEncoding::Ktx2;
    if (startsWith(bytes, {'R', 'I', 'F', 'F'}) && bytes.size() >= 12 &&
        startsWith(bytes.subspan(8), {'W', 'E', 'B', 'P'}))
        return ImageEncoding::WebP;
    return ImageEncoding::Unknown;
}

// Why an image of this encoding is left out, as the tail of a sentence; empty if it is read.
std::string reasonToLeaveOut(ImageEncoding encoding) {
    if (encoding == ImageEncoding::Ktx2) return "is KTX 2, for which no decoder is packaged, and is ignored";
    if (encoding == ImageEncoding::WebP && !hasWebp())
        return "is WebP, which this build lacks (libwebp-dev), and is ignored";
    return encoding == ImageEncoding::Unknown ? "is neither PNG nor JPEG nor WebP and is ignored" : "";
}

std::vector<std::byte> imageBytes(const GltfContext& context, const nlohmann::json& image,
                                  const std::string& what) {
    if (image.contains("uri")) return readUri(context.file, image["uri"].get_ref<const std::string&>(), what);
    if (!image.contains("bufferView")) context.fail(what + " has neither uri nor bufferView");
    const std::span<const std::byte> view = gltfView(context.file, image["bufferView"].get<size_t>());
    return {view.begin(), view.end()};
}

// Decodes one image, with its sizes checked before its pixels are.
class ImageDecoder {
public:
    ImageDecoder(const GltfContext& context, std::span<const std::byte> bytes, std::string what)
        : context_(context)
        , bytes_(bytes)
        , what_(std::move(what)) {
        // A file is at most 2 GiB large, but stb counts in int.
        if (bytes.size() > 0x7FFFFFFF) context.fail(what_ + " is too large");
    }

    TextureImage decode(ImageEncoding encoding, std::uint64_t& pixelsLeft) {
        return encoding == ImageEncoding::WebP ? decodeWebp(pixelsLeft) : decodeByStb(pixelsLeft);
    }

private:
    [[noreturn]] void failBroken(const char* reason = nullptr) const {
        context_.fail(what_ + " is a broken image" + (reason != nullptr ? std::string(": ") + reason : ""));
    }

    // Room for an image of this size.
    TextureImage sized(int width, int height, std::uint64_t& pixelsLeft) const {
        TextureImage image;
        image.width = width;
        image.height = height;
        const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
        if (width > maxImageSide || height > maxImageSide || pixels > pixelsLeft)
            context_.fail(
                fmt::format("{} has {} x {} pixels; at most {} to a side and {} in all images are decoded",
                            what_, width, height, maxImageSide, context_.file.limits.decodedPixels));
        pixelsLeft -= pixels;
        image.rgba.resize(4 * pixels);
        return image;
    }

    [[nodiscard]] TextureImage decodeByStb(std::uint64_t& pixelsLeft) const {
        const auto* data = reinterpret_cast<const stbi_uc*>(bytes_.data());
        const int size = static_cast<int>(bytes_.size());
        int width = 0, height = 0, channels = 0;
        if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0) failBroken();
        TextureImage image = sized(width, height, pixelsLeft);
        const std::unique_ptr<stbi_uc, void (*)(void*)> decoded(
            stbi_load_from_memory(data, size, &width, &height, &channels, 4), stbi_image_free);
        if (!decoded) failBroken(stbi_failure_reason());
        std::copy_n(decoded.get(), image.rgba.size(), image.rgba.begin());
        return image;
    }

#ifdef KESTREL_HAS_WEBP
    [[nodiscard]] TextureImage decodeWebp(std::uint64_t& pixelsLeft) const {
        const auto* data = reinterpret_cast<const std::uint8_t*>(bytes_.data());
        WebPBitstreamFeatures features;
        if (WebPGetFeatures(data, bytes_.size(), &features) != VP8_STATUS_OK) failBroken();
        if (features.has_animation != 0) failBroken("it is animated");
        TextureImage image = sized(features.width, features.height, pixelsLeft);
        if (WebPDecodeRGBAInto(data, bytes_.size(), image.rgba.data(), image.rgba.size(), 4 * image.width) ==
            nullptr)
            failBroken();
        return image;
    }
#else
    [[nodiscard]] TextureImage decodeWebp(std::uint64_t&) const { failBroken(); }
#endif

    const GltfContext& context_;
    std::span<const std::byte> bytes_;
    std::string what_;
};

// The mean of two by two pixels, as they are stored; the last row or column stands for itself where there is
// no other.
void halve(TextureImage& image) {
    const int width = std::max(image.width / 2, 1), height = std::max(image.height / 2, 1);
    std::vector<std::uint8_t> halved;
    halved.reserve(4 * static_cast<size_t>(width) * static_cast<size_t>(height));
    const auto at = [&](int x, int y, int channel) {
        x = std::min(x, image.width - 1);
        y = std::min(y, image.height - 1);
        return static_cast<int>(image.rgba[4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) +
                                                static_cast<size_t>(x)) +
                                           static_cast<size_t>(channel)]);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 4; ++c)
                halved.push_back(
                    static_cast<std::uint8_t>((at(2 * x, 2 * y, c) + at(2 * x + 1, 2 * y, c) +
                                               at(2 * x, 2 * y + 1, c) + at(2 * x + 1, 2 * y + 1, c) + 2) /
                                              4));
    image.width = width;
    image.height = height;
    image.rgba = std::move(halved);
}

std::uint64_t pixelsOf(const TextureImage& image) {
    return static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
}

// The images that some material shows, as far as Kestrel reads it.
std::vector<bool> shownImages(const GltfContext& context, size_t count) {
    std::vector<bool> shown(count, false);
    const auto mark = [&](int texture) {
        if (texture < 0) return;
        if (const int source = gltfTextureSource(context, static_cast<size_t>(texture)); source >= 0)
            shown[static_cast<size_t>(source)] = true;
    };
    for (size_t i = 0; i < context.model.materials.size(); ++i) {
        const tinygltf::Material& material = context.model.materials[i];
        mark(material.pbrMetallicRoughness.baseColorTexture.index);
        mark(material.pbrMetallicRoughness.metallicRoughnessTexture.index);
        mark(material.normalTexture.index);
        mark(material.emissiveTexture.index);
        const nlohmann::json& json = context.file.document["materials"][i];
        const nlohmann::json::json_pointer specular("/extensions/KHR_materials_pbrSpecularGlossiness");
        if (!json.contains(specular)) continue;
        for (const char* name : {"diffuseTexture", "specularGlossinessTexture"})
            if (json[specular].contains(name)) mark(json[specular][name]["index"].get<int>());
    }
    return shown;
}

} // namespace

bool hasWebp() {
#ifdef KESTREL_HAS_WEBP
    return true;
#else
    return false;
#endif
}

int gltfTextureSource(const GltfContext& context, size_t texture) {
    const tinygltf::Texture& source = context.model.textures[texture];
    const tinygltf::Value* webp = gltfExtension(source.extensions, "EXT_texture_webp");
    return webp != nullptr && hasWebp() ? static_cast<int>(gltfNumber(*webp, "source", source.source))
                                        : source.source;
}

int keepGltfImage(GltfContext& context, TextureImage image) {
    std::vector<TextureImage>& images = context.scene.images;
    const std::uint64_t most = context.file.limits.pixels;
    context.wantedPixels += pixelsOf(image);
    const auto fit = [&](TextureImage& one) {
        while (std::max(one.width, one.height) > context.imageSide) halve(one);
    };
    images.push_back(std::move(image));
    fit(images.back());
    const auto kept = [&] {
        std::uint64_t pixels = 0;
        for (const TextureImage& one : images) pixels += pixelsOf(one);
        return pixels;
    };
    context.keptPixels += pixelsOf(images.back());
    while (context.keptPixels > most && context.imageSide > 1) {
        context.imageSide /= 2;
        std::for_each(images.begin(), images.end(), fit);
        context.keptPixels = kept();
    }
    if (context.keptPixels > most)
        context.fail(fmt::format("has {} images; at most {} pixels are kept", images.size(), most));
    return static_cast<int>(images.size()) - 1;
}

void warnOfReducedImages(GltfContext& context) {
    if (context.imageSide < maxImageSide)
        context.warn(fmt::format(
            "the images have {} pixels in all, at most {} are kept: they are reduced to {} a side",
            context.wantedPixels, context.file.limits.pixels, context.imageSide));
}

void readGltfImages(GltfContext& context) {
    context.imageSide = maxImageSide;
    const auto images = context.file.document.find("images");
    if (images == context.file.document.end()) return;
    std::uint64_t pixelsLeft = context.file.limits.decodedPixels;
    const std::vector<bool> shown = shownImages(context, images->size());
    context.imageIndex.assign(images->size(), -1);
    for (size_t i = 0; i < images->size(); ++i) {
        if (!shown[i]) continue;
        const nlohmann::json& source = (*images)[i];
        const std::string what = fmt::format("images[{}]", i);
        // What Kestrel itself refuses to read costs the image, not the scene.
        if (source.contains("uri"))
            if (const std::string refused = outsideFolder(context.file, source["uri"].get<std::string>());
                !refused.empty()) {
                context.warn(fmt::format("{}: {} and is left out", what, refused));
                continue;
            }
        const std::vector<std::byte> bytes = imageBytes(context, source, what);
        const ImageEncoding encoding = encodingOf(bytes);
        if (const std::string reason = reasonToLeaveOut(encoding); !reason.empty()) {
            context.warn(fmt::format("{} {}", what, reason));
            continue;
        }
        TextureImage image = ImageDecoder(context, bytes, what).decode(encoding, pixelsLeft);
        image.name = source.value("name", "");
        context.imageIndex[i] = keepGltfImage(context, std::move(image));
    }
}

} // namespace kestrel
