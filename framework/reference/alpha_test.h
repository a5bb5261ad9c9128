// The alpha test of the reference: does a ray stop at a point of a masked or blended triangle?
#pragma once
#include "scene/geometry.h"
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace kestrel {

// Keeps what it needs of geometry and scene, so that both may go away.
class AlphaTest {
public:
    // `blendedAsMasked` false: blended materials are there wherever their alpha is above 0.
    AlphaTest(const Geometry& geometry, const Scene& scene, bool blendedAsMasked = true);

    // Whether the point with barycentric weights u, v (of the second and third corner) of that triangle is
    // there: base colour alpha (factor times texture times vertex colour) at least the material's cutoff.
    // Opaque materials always are; Blend is decided by its cutoff too, unless said otherwise above.
    [[nodiscard]] bool isSolid(std::uint32_t triangle, float u, float v) const;

private:
    struct Corner {
        glm::vec2 texCoord; // as the base colour texture reads it, before its transform
        float alpha;        // of the vertex colour
    };
    struct MaskedMaterial {
        bool opaque = true;
        float alpha = 1, cutoff = 0.5f;
        TextureRef texture;
    };
    struct AlphaImage {
        int width = 0, height = 0;
        std::vector<std::uint8_t> alpha; // rows top to bottom
    };
    [[nodiscard]] float sample(const TextureRef& texture, const glm::vec2& texCoord) const;

    std::uint32_t first_ = 0;     // first triangle whose corners are kept
    std::vector<Corner> corners_; // three a triangle from first_ on
    std::vector<std::uint32_t> materialOf_;
    std::vector<MaskedMaterial> materials_;
    std::vector<AlphaImage> images_; // empty where no alpha test reads the image
};

} // namespace kestrel
