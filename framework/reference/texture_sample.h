// Reads of a scene's images as samplers do them: transformed, wrapped, filtered.
#pragma once
#include "scene/texture_transform.h"
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace kestrel {

// Column or row `i` of an image of `size` texels a side, wrapped.
inline int wrappedTexel(int i, int size, Wrap wrap) {
    if (wrap == Wrap::ClampToEdge) return std::clamp(i, 0, size - 1);
    const int period = wrap == Wrap::Repeat ? size : 2 * size;
    const int k = ((i % period) + period) % period;
    return k < size ? k : period - 1 - k;
}

// The finest level at `texCoord` (before the reference's transform), bilinear or nearest as the reference
// says. `texel(i)` gives texel i in rows from the top: a number or a vector.
template<class Texel>
auto sampleTexels(const TextureRef& texture, int width, int height, const glm::vec2& texCoord,
                  const Texel& texel) {
    const glm::vec2 p = transformedTexCoord(texture, texCoord) * glm::vec2(width, height);
    const auto at = [&](int x, int y) {
        const auto column = static_cast<size_t>(wrappedTexel(x, width, texture.wrapS));
        const auto row = static_cast<size_t>(wrappedTexel(y, height, texture.wrapT));
        return texel(row * static_cast<size_t>(width) + column);
    };
    if (texture.nearest) return at(static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)));
    const glm::vec2 q = p - 0.5f;
    const glm::vec2 f = q - glm::floor(q);
    const int x = static_cast<int>(std::floor(q.x)), y = static_cast<int>(std::floor(q.y));
    return glm::mix(glm::mix(at(x, y), at(x + 1, y), f.x), glm::mix(at(x, y + 1), at(x + 1, y + 1), f.x),
                    f.y);
}

} // namespace kestrel
