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

std::uint32_t sideOf(const TextureImage& image) {
    const auto longer = static_cast<std::uint32_t>(std::max({image.width, image.height, 1}));
    return std::min(std::bit_ceil(longer), maxTextureSide);
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

} // namespace

TextureArrays textureArrays(const Scene& scene, TextureRole role) {
    TextureArrays result;
    const std::vector<bool> used = usedImages(scene, role);
    for (size_t image = 0; image < used.size(); ++image) {
        if (!used[image]) continue;
        const std::uint32_t side = sideOf(scene.images[image]);
        auto at = std::find_if(result.arrays.begin(), result.arrays.end(),
                               [side](const TextureArrays::Array& array) { return array.side >= side; });
        if (at == result.arrays.end() || at->side != side) at = result.arrays.insert(at, {side, {}});
        at->images.push_back(static_cast<int>(image));
    }
    while (result.arrays.size() > maxTextureArrays) joinCheapest(result.arrays);
    result.places.resize(scene.images.size());
    for (size_t array = 0; array < result.arrays.size(); ++array)
        for (size_t layer = 0; layer < result.arrays[array].images.size(); ++layer)
            result.places[static_cast<size_t>(result.arrays[array].images[layer])] = {
                static_cast<int>(array), static_cast<int>(layer)};
    return result;
}

} // namespace kestrel
