#include "scene/texture_arrays.h"
#include <algorithm>
#include <bit>

namespace kestrel {
namespace {

std::vector<bool> usedImages(const Scene& scene, TextureRole role) {
    std::vector<bool> used(scene.images.size(), false);
    const auto mark = [&](const TextureRef& reference) {
        if (reference.present() && static_cast<size_t>(reference.image) < used.size())
            used[static_cast<size_t>(reference.image)] = true;
    };
    for (const Material& material : scene.materials) {
        mark(role == TextureRole::Colour ? material.baseColourTexture : material.metallicRoughnessTexture);
        mark(role == TextureRole::Colour ? material.emissionTexture : material.normalTexture);
    }
    return used;
}

std::uint32_t sideOf(const TextureImage& image, std::uint32_t most) {
    const auto longer = static_cast<std::uint32_t>(std::max({image.width, image.height, 1}));
    return std::min(std::bit_ceil(longer), most);
}

std::uint64_t texelsOf(const TextureArrays::Array& array) {
    return std::uint64_t{array.side} * array.side * array.images.size();
}

std::uint64_t texelsWithin(const Scene& scene, const std::vector<bool>& used, std::uint32_t most) {
    std::uint64_t texels = 0;
    for (size_t image = 0; image < used.size(); ++image)
        if (used[image]) {
            const std::uint64_t side = sideOf(scene.images[image], most);
            texels += side * side;
        }
    return texels;
}

// Joins the array at `index` with the next larger one.
std::uint64_t costOfJoining(const std::vector<TextureArrays::Array>& arrays, size_t index) {
    const std::uint64_t small = arrays[index].side;
    const std::uint64_t large = arrays[index + 1].side;
    return arrays[index].images.size() * (large * large - small * small);
}

void joinCheapest(std::vector<TextureArrays::Array>& arrays) {
    size_t cheapest = 0;
    for (size_t i = 1; i + 1 < arrays.size(); ++i)
        if (costOfJoining(arrays, i) < costOfJoining(arrays, cheapest)) cheapest = i;
    std::vector<int>& joined = arrays[cheapest + 1].images;
    joined.insert(joined.end(), arrays[cheapest].images.begin(), arrays[cheapest].images.end());
    std::sort(joined.begin(), joined.end());
    arrays.erase(arrays.begin() + static_cast<std::ptrdiff_t>(cheapest));
}

// Halves the array that takes the most texels while one takes too many and another array is free.
void splitLarge(std::vector<TextureArrays::Array>& arrays, std::uint64_t most) {
    while (!arrays.empty() && arrays.size() < maxTextureArrays) {
        const auto largest = std::max_element(arrays.begin(), arrays.end(), [](const auto& a, const auto& b) {
            return texelsOf(a) < texelsOf(b);
        });
        if (texelsOf(*largest) <= most || largest->images.size() < 2) return;
        const auto middle =
            largest->images.begin() + static_cast<std::ptrdiff_t>((largest->images.size() + 1) / 2);
        TextureArrays::Array second{largest->side, {middle, largest->images.end()}, 1};
        largest->images.erase(middle, largest->images.end());
        arrays.insert(largest + 1, std::move(second));
    }
}

void placeImages(TextureArrays& result) {
    for (size_t index = 0; index < result.arrays.size(); ++index) {
        const TextureArrays::Array& array = result.arrays[index];
        for (size_t i = 0; i < array.images.size(); ++i) {
            const size_t each = size_t{array.tiles} * array.tiles, tile = i % each;
            result.places[static_cast<size_t>(array.images[i])] = {
                static_cast<int>(index), static_cast<int>(i / each),
                static_cast<std::uint32_t>(tile % array.tiles) * array.side,
                static_cast<std::uint32_t>(tile / array.tiles) * array.side};
        }
    }
}

} // namespace

bool TextureArrays::tiled() const {
    return std::any_of(arrays.begin(), arrays.end(), [](const Array& array) { return array.tiles > 1; });
}

TextureArrays textureArrays(const Scene& scene, TextureRole role, const TextureLimits& limits) {
    TextureArrays result;
    const std::vector<bool> used = usedImages(scene, role);
    result.side = limits.side;
    result.wantedTexels = texelsWithin(scene, used, limits.side);
    while (result.side > 1 && texelsWithin(scene, used, result.side) > limits.texels) result.side /= 2;
    for (size_t image = 0; image < used.size(); ++image) {
        if (!used[image]) continue;
        const std::uint32_t side = sideOf(scene.images[image], result.side);
        auto at = std::find_if(result.arrays.begin(), result.arrays.end(),
                               [side](const TextureArrays::Array& array) { return array.side >= side; });
        if (at == result.arrays.end() || at->side != side) at = result.arrays.insert(at, {side, {}, 1});
        at->images.push_back(static_cast<int>(image));
    }
    while (result.arrays.size() > maxTextureArrays) joinCheapest(result.arrays);
    splitLarge(result.arrays, limits.arrayTexels);
    for (TextureArrays::Array& array : result.arrays)
        while (array.layers() > limits.layers) array.tiles *= 2;
    result.places.resize(scene.images.size());
    placeImages(result);
    return result;
}

} // namespace kestrel
