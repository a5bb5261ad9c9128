#include "draw/cutouts.h"
#include "core/log.h"
#include "gl/loader.h"
#include "scene/least_alpha.h"
#include "scene/texture_transform.h"
#include <algorithm>
#include <compare>
#include <map>
#include <span>
#include <utility>

namespace kestrel {
namespace {

using shared::CutoutRecord;
static_assert(sizeof(CutoutRecord) == shared::cutoutTexels * 16);

// An image as one kind of filter reads it.
struct AlphaUse {
    int image;
    bool nearest;
    friend auto operator<=>(const AlphaUse&, const AlphaUse&) = default;
};

struct AlphaWords {
    std::uint32_t width = 1, height = 1;
    std::vector<std::uint32_t> texels; // in rows from the top
};

// A word a texel: its alpha and that of the next in x, in y, in both, as a repeated image has them. Of an
// image that is read without a filter, four times its own.
AlphaWords footprints(const std::vector<std::uint8_t>& rgba, std::uint32_t width, std::uint32_t height,
                      bool nearest) {
    AlphaWords words{width, height, std::vector<std::uint32_t>(std::size_t{width} * height)};
    const auto alpha = [&](std::uint32_t x, std::uint32_t y) {
        return std::uint32_t{rgba[4 * (std::size_t{y % height} * width + x % width) + 3]};
    };
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t next = nearest ? 0 : 1;
            words.texels[std::size_t{y} * width + x] = alpha(x, y) | alpha(x + next, y) << 8 |
                                                       alpha(x, y + next) << 16 |
                                                       alpha(x + next, y + next) << 24;
        }
    return words;
}

// The image's texels as a rasterizer reads them: of its square in the array, or of the image itself where no
// filter blends them and the square only repeats them.
AlphaWords wordsOf(const Scene& scene, const SceneTextures& colours, const AlphaUse& use,
                   std::uint32_t most) {
    const TextureImage& image = scene.images[static_cast<std::size_t>(use.image)];
    const std::uint32_t side = std::min(colours.side(use.image), most);
    if (use.nearest && image.width > 0 && image.height > 0 &&
        static_cast<std::uint32_t>(std::max(image.width, image.height)) <= side)
        return footprints(image.rgba, static_cast<std::uint32_t>(image.width),
                          static_cast<std::uint32_t>(image.height), true);
    return footprints(colours.square(scene, use.image, side), side, side, use.nearest);
}

// The longest side that lets all of them into one buffer of texels.
std::uint32_t mostWithin(const SceneTextures& colours, const std::vector<AlphaUse>& uses) {
    GLint64 device = 0;
    glGetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &device);
    const std::uint64_t limit =
        std::min<std::uint64_t>(static_cast<std::uint64_t>(device), shared::cutoutPlaceMask);
    const auto texels = [&](std::uint32_t most) {
        std::uint64_t sum = 1;
        for (const AlphaUse& use : uses) {
            const std::uint64_t side = std::min(colours.side(use.image), most);
            sum += side * side;
        }
        return sum;
    };
    std::uint32_t most = maxTextureSide;
    while (most > 1 && texels(most) > limit) most /= 2;
    if (most < maxTextureSide)
        logWarning("the alpha of masked materials takes {} texels, rays can address {}: for them it is "
                   "reduced to {} a side",
                   texels(maxTextureSide), limit, most);
    return most;
}

} // namespace

Cutouts::Cutouts(const Scene& scene, const SceneTextures& colours) {
    const std::vector<Material> materials = flattenedMaterials(scene);
    const auto useOf = [&](const Material& material) {
        const TextureRef& texture = material.baseColourTexture;
        const bool read =
            material.alphaMode != AlphaMode::Opaque && texture.present() && colours.side(texture.image) > 0;
        return AlphaUse{read ? texture.image : -1, read && texture.nearest};
    };
    std::vector<AlphaUse> uses;
    for (const Material& material : materials) uses.push_back(useOf(material));
    std::sort(uses.begin(), uses.end());
    uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
    std::erase_if(uses, [](const AlphaUse& use) { return use.image < 0; });

    // The first word is what a material without a texture reads.
    std::vector<std::uint32_t> texels = {0xffffffffu};
    std::map<AlphaUse, std::pair<std::uint32_t, std::uint32_t>> placed; // place and size
    placed[AlphaUse{-1, false}] = {0, 0};
    const std::uint32_t most = mostWithin(colours, uses);
    for (const AlphaUse& use : uses) {
        const AlphaWords words = wordsOf(scene, colours, use, most);
        placed[use] = {static_cast<std::uint32_t>(texels.size()),
                       (words.width - 1) | (words.height - 1) << shared::cutoutHeightShift};
        texels.insert(texels.end(), words.texels.begin(), words.texels.end());
    }
    alpha_ = gl::Buffer(texels.size() * sizeof(std::uint32_t), "scene cutout alpha");
    alpha_.upload(std::as_bytes(std::span(texels)));

    for (const Material& material : materials) {
        const AlphaUse use = useOf(material);
        const auto [place, size] = placed.at(use);
        Cut cut{.texture = material.baseColourTexture,
                .place = place,
                .size = size,
                .alpha = material.baseColour.a,
                .threshold = leastAlpha(material)};
        if (use.nearest) cut.place |= shared::cutoutNearest;
        if (material.alphaMode == AlphaMode::Blend) cut.place |= shared::cutoutBlend;
        if (use.image >= 0)
            cut.size |= (wrapCode(cut.texture.wrapS) | wrapCode(cut.texture.wrapT) << 2)
                        << shared::cutoutWrapShift;
        materials_.push_back(cut);
    }
    setTriangles(Geometry{});
}

void Cutouts::setTriangles(const Geometry& geometry) {
    first_ = firstMaskedTriangle(geometry);
    std::vector<CutoutRecord> records;
    records.reserve(geometry.triangleCount() - first_);
    for (std::uint32_t triangle = first_; triangle < geometry.triangleCount(); ++triangle) {
        const Cut& cut = materials_.at(geometry.materials[triangle]);
        CutoutRecord& record = records.emplace_back();
        record.place = cut.place;
        record.size = cut.size;
        record.threshold = cut.threshold;
        glm::vec2* const texCoords[] = {&record.texCoord0, &record.texCoord1, &record.texCoord2};
        float* const alphas[] = {&record.alpha0, &record.alpha1, &record.alpha2};
        for (std::size_t k = 0; k < 3; ++k) {
            const VertexAttributes& vertex =
                geometry.attributes[geometry.indices[3 * std::size_t{triangle} + k]];
            *texCoords[k] = transformedTexCoord(cut.texture, cut.texture.texCoord == 1 ? vertex.texCoord1
                                                                                       : vertex.texCoord);
            *alphas[k] = cut.alpha * vertex.colour.a;
        }
    }
    if (records.empty()) records.emplace_back(); // a buffer of nothing binds nowhere
    const auto bytes = std::as_bytes(std::span(records));
    if (!records_ || records_.bytes() != bytes.size()) records_ = gl::Buffer(bytes.size(), "scene cutouts");
    records_.upload(bytes);
}

} // namespace kestrel
