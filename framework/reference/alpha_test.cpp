#include "reference/alpha_test.h"
#include "reference/texture_sample.h"
#include "scene/least_alpha.h"
#include <limits>

namespace kestrel {
AlphaTest::AlphaTest(const Geometry& geometry, const Scene& scene, bool blendedAsMasked)
    : first_(firstMaskedTriangle(geometry))
    , images_(scene.images.size()) {
    for (const Material& material : flattenedMaterials(scene)) {
        const bool kept = material.alphaMode == AlphaMode::Blend && !blendedAsMasked;
        materials_.push_back({material.alphaMode == AlphaMode::Opaque, material.baseColour.a,
                              kept ? std::numeric_limits<float>::denorm_min() : leastAlpha(material),
                              material.baseColourTexture});
    }
    for (std::uint32_t triangle = first_; triangle < geometry.triangleCount(); ++triangle) {
        const std::uint32_t index = geometry.materials[triangle];
        materialOf_.push_back(index);
        const TextureRef& texture = materials_[index].texture;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const VertexAttributes& vertex = geometry.attributes[geometry.indices[3 * triangle + k]];
            corners_.push_back({texture.texCoord == 1 ? vertex.texCoord1 : vertex.texCoord, vertex.colour.a});
        }
        if (!texture.present()) continue;
        AlphaImage& image = images_[static_cast<size_t>(texture.image)];
        if (image.width > 0) continue;
        const TextureImage& source = scene.images[static_cast<size_t>(texture.image)];
        image.width = source.width;
        image.height = source.height;
        image.alpha.resize(source.rgba.size() / 4);
        for (size_t i = 0; i < image.alpha.size(); ++i) image.alpha[i] = source.rgba[4 * i + 3];
    }
}

float AlphaTest::sample(const TextureRef& texture, const glm::vec2& texCoord) const {
    const AlphaImage& image = images_[static_cast<size_t>(texture.image)];
    return sampleTexels(texture, image.width, image.height, texCoord,
                        [&](size_t i) { return static_cast<float>(image.alpha[i]) / 255; });
}

bool AlphaTest::isSolid(std::uint32_t triangle, float u, float v) const {
    if (triangle < first_) return true;
    const size_t i = triangle - first_;
    const MaskedMaterial& material = materials_[materialOf_[i]];
    if (material.opaque) return true;
    const Corner *a = &corners_[3 * i], *b = a + 1, *c = a + 2;
    const float w = 1 - u - v;
    float alpha = material.alpha * (w * a->alpha + u * b->alpha + v * c->alpha);
    if (material.texture.present())
        alpha *= sample(material.texture, w * a->texCoord + u * b->texCoord + v * c->texCoord);
    return alpha >= material.cutoff;
}

} // namespace kestrel
