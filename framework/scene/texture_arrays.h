// Which texture array, layer and tile each image goes to: textures lie in few arrays by size, since shaders
// can choose among few samplers only.
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

// What the arrays of one role may take. The defaults are what every device of OpenGL 4.6 has to bear (layers)
// and what software drivers still allocate, so that one scene is laid out alike everywhere.
struct TextureLimits {
    std::uint32_t layers = 2048; // of one array
    std::uint64_t arrayTexels = std::uint64_t{1}
                                << 27;             // of one array, as long as another one is free: 512 MiB
    std::uint64_t texels = std::uint64_t{1} << 29; // of all arrays: 2 GiB, a third more with mip levels
    std::uint32_t side = maxTextureSide;
};

struct TextureArrays {
    struct Array {
        std::uint32_t side = 0;  // of an image's place, texels; a power of two
        std::vector<int> images; // in the order of their places: index into Scene::images
        std::uint32_t tiles = 1; // places along each side of a layer; a power of two
        [[nodiscard]] std::uint32_t layerSide() const { return side * tiles; }
        [[nodiscard]] size_t layers() const {
            const size_t each = size_t{tiles} * tiles;
            return (images.size() + each - 1) / each;
        }
    };
    struct Place {
        int array = -1, layer = -1; // -1: the image is not used in this role
        std::uint32_t x = 0, y = 0; // of its first texel in the layer
    };
    std::vector<Array> arrays; // at most maxTextureArrays, by rising side
    std::vector<Place> places; // by image
    // The side that all images are kept within, and the texels that they take without that. Less than
    // TextureLimits::side where they would take too many.
    std::uint32_t side = maxTextureSide;
    std::uint64_t wantedTexels = 0;

    // Whether some layer holds several images.
    [[nodiscard]] bool tiled() const;
};

// An image goes to the array of its longer side rounded up to a power of two, at most TextureLimits::side; of
// more sizes than maxTextureArrays those are joined whose joining costs the fewest texels. Where an array
// would need more layers than there are, several images share a layer as tiles; where it takes too many
// texels, it is split while arrays are free; where all together take too many, the largest images are halved
// until they do not.
TextureArrays textureArrays(const Scene& scene, TextureRole role, const TextureLimits& limits = {});

} // namespace kestrel
