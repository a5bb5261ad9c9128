#include "scene/gltf_specular.h"
#include "scene/gltf_context.h"
#include "scene/gltf_image.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

constexpr float dielectric = 0.04f;

float linearOf(std::uint8_t value) {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> made{};
        for (size_t i = 0; i < made.size(); ++i) {
            const float c = static_cast<float>(i) / 255;
            made[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
        }
        return made;
    }();
    return table[value];
}

std::uint8_t byteOf(float value) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
}

std::uint8_t codedOf(float linear) {
    const float c = std::clamp(linear, 0.0f, 1.0f);
    return byteOf(c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f);
}

// The pixel of `image` at the place of (x, y) in a picture of width times height.
const std::uint8_t* pixelAt(const TextureImage& image, int x, int y, int width, int height) {
    const auto place = [](int at, int size, int own) {
        return static_cast<size_t>((2 * static_cast<std::int64_t>(at) + 1) * own /
                                   (2 * static_cast<std::int64_t>(size)));
    };
    return image.rgba.data() + 4 * (place(y, height, image.height) * static_cast<size_t>(image.width) +
                                    place(x, width, image.width));
}

bool isPlacedAlike(TextureRef a, const TextureRef& b) {
    a.image = b.image;
    return a == b;
}

glm::vec4 meanOf(const TextureImage& image) {
    glm::dvec4 sum(0);
    for (size_t i = 0; i + 3 < image.rgba.size(); i += 4)
        sum += glm::dvec4(double(linearOf(image.rgba[i])), double(linearOf(image.rgba[i + 1])),
                          double(linearOf(image.rgba[i + 2])), image.rgba[i + 3] / 255.0);
    const size_t pixels = image.rgba.size() / 4;
    return glm::vec4(sum / std::max(1.0, static_cast<double>(pixels)));
}

glm::vec3 diffuseColour(const glm::vec3& factor, const glm::vec3& specular) {
    return factor * (1 - std::max({specular.r, specular.g, specular.b}));
}

// Converts pixel by pixel. `specular` is nullptr where only the diffuse factor varies, and the other way
// round.
struct Converted {
    TextureImage base, surface;
};
Converted convertPixels(const SpecularMaterial& source, const TextureImage* diffuse,
                        const TextureImage* specular) {
    const int width = std::max(diffuse ? diffuse->width : 1, specular ? specular->width : 1);
    const int height = std::max(diffuse ? diffuse->height : 1, specular ? specular->height : 1);
    const size_t bytes = 4 * static_cast<size_t>(width) * static_cast<size_t>(height);
    Converted result;
    for (TextureImage* image : {&result.base, &result.surface}) {
        image->width = width;
        image->height = height;
        image->rgba.reserve(bytes);
    }
    result.base.name = diffuse ? diffuse->name : specular->name;
    result.surface.name = specular ? specular->name : diffuse->name;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            glm::vec3 d(source.diffuse), s = source.specular;
            std::uint8_t alpha = 255;
            float gloss = source.glossiness;
            if (diffuse != nullptr) {
                const std::uint8_t* pixel = pixelAt(*diffuse, x, y, width, height);
                d *= glm::vec3(linearOf(pixel[0]), linearOf(pixel[1]), linearOf(pixel[2]));
                alpha = pixel[3];
            }
            if (specular != nullptr) {
                const std::uint8_t* pixel = pixelAt(*specular, x, y, width, height);
                s *= glm::vec3(linearOf(pixel[0]), linearOf(pixel[1]), linearOf(pixel[2]));
                gloss *= static_cast<float>(pixel[3]) / 255;
            }
            const MetallicSurface surface = metallicSurface(diffuseColour(d, s), s);
            for (int c = 0; c < 3; ++c) result.base.rgba.push_back(codedOf(surface.baseColour[c]));
            result.base.rgba.push_back(alpha);
            result.surface.rgba.insert(result.surface.rgba.end(),
                                       {255, byteOf(1 - gloss), byteOf(surface.metallic), 255});
        }
    return result;
}

// What equal inputs give is made once.
std::string keyOf(const SpecularMaterial& source) {
    return fmt::format("{} {} {} {} {} {} {} {} {}", source.diffuse.r, source.diffuse.g, source.diffuse.b,
                       source.specular.r, source.specular.g, source.specular.b, source.glossiness,
                       source.diffuseTexture.image, source.specularTexture.image);
}

} // namespace

// With x = 1 - metalness, a grey surface of base colour b has the diffuse colour d = b x and reflects
// s = 0.04 x + b (1 - x): 0.04 x^2 - (d + s) x + d = 0, of which the smaller root is meant.
MetallicSurface metallicSurface(const glm::vec3& diffuse, const glm::vec3& specular) {
    const double d = double(diffuse.r + diffuse.g + diffuse.b) / 3,
                 s = double(specular.r + specular.g + specular.b) / 3;
    constexpr double a = double(dielectric);
    const double sum = d + s, root = std::sqrt(std::max(sum * sum - 4 * a * d, 0.0));
    // 2 d / (sum + root) is the smaller root without cancellation; what reflects less than 0.04 is no metal.
    double x = sum + root > 0 ? 2 * d / (sum + root) : 1;
    if (s <= a) x = 1;
    x = std::clamp(x, 0.0, 1.0);
    MetallicSurface surface;
    surface.metallic = static_cast<float>(1 - x);
    const double weight = x * x + (1 - x) * (1 - x);
    for (int i = 0; i < 3; ++i) {
        const double reflected = std::max(double(specular[i]) - a * x, 0.0);
        surface.baseColour[i] =
            static_cast<float>(std::clamp((x * double(diffuse[i]) + (1 - x) * reflected) / weight, 0.0, 1.0));
    }
    return surface;
}

void convertSpecular(GltfContext& context, const SpecularMaterial& given, Material& material) {
    context.warn("specular-glossiness materials are converted to metallic-roughness");
    SpecularMaterial source = given;
    // The fallback states the same opacity; some exporters (assimp) write it there alone.
    if (material.alphaMode == AlphaMode::Blend && material.baseColour.a < source.diffuse.a) {
        context.warn("blended specular-glossiness materials take the lower opacity of their fallback");
        source.diffuse.a = material.baseColour.a;
    }
    const auto imageOf = [&](const TextureRef& ref) {
        return ref.present() ? &context.scene.images[static_cast<size_t>(ref.image)] : nullptr;
    };
    if (source.diffuseTexture.present() && source.specularTexture.present() &&
        !isPlacedAlike(source.diffuseTexture, source.specularTexture)) {
        context.warn(
            fmt::format("the two textures of the specular-glossiness material '{}' are placed differently: "
                        "of the second one its mean counts",
                        material.name));
        const glm::vec4 mean = meanOf(*imageOf(source.specularTexture));
        source.specular *= glm::vec3(mean);
        source.glossiness *= mean.a;
        source.specularTexture = {};
    }
    const glm::vec3 plain = diffuseColour(glm::vec3(source.diffuse), source.specular);
    const MetallicSurface surface = metallicSurface(plain, source.specular);
    material.baseColour = glm::vec4(surface.baseColour, source.diffuse.a);
    material.metallic = surface.metallic;
    material.roughness = 1 - source.glossiness;
    material.baseColourTexture = source.diffuseTexture;
    material.metallicRoughnessTexture = {};
    const float brightest = std::max({source.specular.r, source.specular.g, source.specular.b});
    if (!source.specularTexture.present() && (!source.diffuseTexture.present() || brightest <= dielectric)) {
        // Not a metal anywhere: the base colour is the diffuse colour.
        if (source.diffuseTexture.present()) material.baseColour = glm::vec4(plain, source.diffuse.a);
        return;
    }
    const auto [made, isNew] = context.converted.try_emplace(keyOf(source));
    if (isNew) {
        Converted converted =
            convertPixels(source, imageOf(source.diffuseTexture), imageOf(source.specularTexture));
        made->second.first = keepGltfImage(context, std::move(converted.base));
        made->second.second = keepGltfImage(context, std::move(converted.surface));
    }
    material.baseColour = glm::vec4(1, 1, 1, source.diffuse.a);
    material.metallic = material.roughness = 1;
    material.baseColourTexture = material.metallicRoughnessTexture =
        source.diffuseTexture.present() ? source.diffuseTexture : source.specularTexture;
    material.baseColourTexture.image = made->second.first;
    material.metallicRoughnessTexture.image = made->second.second;
}

} // namespace kestrel
