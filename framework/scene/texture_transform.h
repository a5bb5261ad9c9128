// Where a texture is read for the coordinates of a vertex.
#pragma once
#include "scene/material.h"
#include <cmath>

namespace kestrel {

// KHR_texture_transform: scale, then rotation, then offset.
inline glm::vec2 transformedTexCoord(const TextureRef& texture, const glm::vec2& texCoord) {
    const glm::vec2 p = texCoord * texture.scale;
    const float c = std::cos(texture.rotation), s = std::sin(texture.rotation);
    return glm::vec2(c * p.x + s * p.y, -s * p.x + c * p.y) + texture.offset;
}

} // namespace kestrel
