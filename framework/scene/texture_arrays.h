// Which texture array and layer each image goes to: textures lie in few arrays by size, since shaders can
// choose among few samplers only.
#pragma once
#include "scene/scene.h"
#include <cstdint>
#include <vector>

namespace kestrel {

// Colour images are decoded from sRGB when read, data images (metallic-roughness, normals) are not. An image
// that is used as both goes to both.
enum class TextureRole : std::uint8_t { Colour, Data };

inline constexpr std::uint32_t maxTextureArrays = 4; // of one role
inline constexpr std::uint32_t maxTextureSide = 4096;

struct TextureArrays {
    struct Array {
        std::uint32_t side = 0;  // texels; a power of two, layers are squares
        std::vector<int> images; // by layer: index into Scene::images
    };
    struct Place {
        int array = -1, layer = -1; // -1: the image is not used in this role
    };
    std::vector<Array> arrays; // at most maxTextureArrays, by rising side
    std::vector<Place> places; // by image
};

// An image goes to the array of its longer side rounded up to a power of two, at most maxTextureSide; of more
// sizes than maxTextureArrays those are joined whose joining costs the fewest texels.
TextureArrays textureArrays(const Scene& scene, TextureRole role);

} // namespace kestrel
