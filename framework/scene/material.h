// Materials and textures as glTF 2.0 means them (metallic-roughness), with the extensions that Kestrel
// honours.
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace kestrel {

enum class AlphaMode : std::uint8_t { Opaque, Mask, Blend };
enum class Wrap : std::uint8_t { Repeat, MirroredRepeat, ClampToEdge };

// An 8-bit RGBA image, rows top to bottom. Whether it is sRGB is a matter of its use (see TextureUse).
struct TextureImage {
    std::string name;
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba; // 4 * width * height
    friend bool operator==(const TextureImage&, const TextureImage&) = default;
};

// Reference from a material to an image, with sampler and KHR_texture_transform.
struct TextureRef {
    int image = -1; // index into Scene::images; -1: no texture
    int texCoord = 0;
    Wrap wrapS = Wrap::Repeat, wrapT = Wrap::Repeat;
    bool nearest = false; // magnification filter
    glm::vec2 offset{0}, scale{1};
    float rotation = 0; // radians, counter-clockwise
    [[nodiscard]] bool present() const { return image >= 0; }
    friend bool operator==(const TextureRef&, const TextureRef&) = default;
};

struct Material {
    std::string name;
    glm::vec4 baseColour{1}; // linear
    float metallic = 1, roughness = 1;
    glm::vec3 emission{0}; // linear radiance, emissive strength included
    float normalScale = 1;
    AlphaMode alphaMode = AlphaMode::Opaque;
    float alphaCutoff = 0.5f; // for Mask; Blend surfaces are tested against it too where a pass must decide
    bool doubleSided = false;
    bool unlit = false;     // KHR_materials_unlit
    float transmission = 0; // KHR_materials_transmission
    float ior = 1.5f;       // KHR_materials_ior
    TextureRef baseColourTexture, metallicRoughnessTexture, normalTexture, emissionTexture;
    friend bool operator==(const Material&, const Material&) = default;
};

} // namespace kestrel
