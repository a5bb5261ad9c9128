#include "scene/builtin/textures.h"
#include "scene/builtin/noise.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace kestrel::builtin {
namespace {

// Fills an image by a function of the texel's middle, x to the right and y up, both 0 to 1; RGBA 0 to 1.
TextureImage fill(const char* name, int size, const std::function<glm::vec4(const glm::vec2&)>& colour) {
    TextureImage image;
    image.name = name;
    image.width = image.height = size;
    image.rgba.reserve(static_cast<size_t>(size) * static_cast<size_t>(size) * 4);
    for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
            const glm::vec2 p = (glm::vec2(column, size - 1 - row) + 0.5f) / static_cast<float>(size);
            const glm::vec4 c = glm::clamp(colour(p), 0.0f, 1.0f) * 255.0f + 0.5f;
            for (int k = 0; k < 4; ++k) image.rgba.push_back(static_cast<std::uint8_t>(c[k]));
        }
    }
    return image;
}

struct Leaf {
    glm::vec2 foot, along; // `along` is as long as the leaf
    float width;
};

// How far inside the leaf's outline p is, in units of the texture; negative outside. `vein` is the distance
// from the middle rib.
float insideLeaf(const Leaf& leaf, const glm::vec2& p, float& vein) {
    const float length = glm::length(leaf.along);
    const glm::vec2 axis = leaf.along / length;
    const glm::vec2 q = p - leaf.foot;
    const float s = glm::dot(q, axis) / length;
    vein = std::abs(q.x * axis.y - q.y * axis.x);
    if (s <= 0 || s >= 1) return -std::max(-s, s - 1) * length - vein;
    const float outline =
        leaf.width * std::pow(std::sin(std::numbers::pi_v<float> * std::pow(s, 0.75f)), 0.8f);
    return outline - vein;
}

float edge(float inside, int size) {
    const float texel = 1 / static_cast<float>(size);
    return glm::smoothstep(-texel, texel, inside);
}

} // namespace

TextureImage sprigTexture(int size) {
    std::vector<Leaf> leaves{{{0.5f, 0.62f}, {0, 0.36f}, 0.085f}};
    for (int i = 0; i < 3; ++i) {
        const float y = 0.14f + 0.18f * static_cast<float>(i), reach = 0.40f - 0.05f * static_cast<float>(i);
        for (const float side : {-1.0f, 1.0f})
            leaves.push_back({{0.5f, y + 0.03f * side}, {side * reach, 0.24f}, 0.085f});
    }
    return fill("sprig", size, [=](const glm::vec2& p) {
        // The stem counts as a very narrow leaf.
        float inside = p.y < 0.7f ? 0.012f - std::abs(p.x - 0.5f) : -1.0f, vein = 1;
        for (const Leaf& leaf : leaves) {
            float distance = 0;
            const float depth = insideLeaf(leaf, p, distance);
            if (depth > inside) {
                inside = depth;
                vein = distance;
            }
        }
        const float rib = 1 - glm::smoothstep(0.004f, 0.012f, vein);
        const float mottled = 0.5f + 0.5f * fractalNoise({p * 9.0f, 1}, 3);
        const glm::vec3 green =
            glm::mix(glm::vec3(0.26f, 0.44f, 0.12f), glm::vec3(0.44f, 0.58f, 0.20f), mottled);
        return glm::vec4(glm::mix(green, glm::vec3(0.62f, 0.70f, 0.36f), 0.6f * rib), edge(inside, size));
    });
}

TextureImage grassTexture(int size) {
    RandomSequence random(11);
    struct Blade {
        float foot, lean, height, width;
    };
    std::vector<Blade> blades;
    for (int i = 0; i < 13; ++i)
        blades.push_back({random.between(0.12f, 0.88f), random.between(-0.25f, 0.25f),
                          random.between(0.5f, 0.98f), random.between(0.018f, 0.032f)});
    return fill("grass", size, [=](const glm::vec2& p) {
        float inside = -1;
        for (const Blade& blade : blades) {
            const float s = p.y / blade.height;
            const float middle = blade.foot + blade.lean * s * s;
            if (s < 1) inside = std::max(inside, blade.width * (1 - s * s) - std::abs(p.x - middle));
        }
        const glm::vec3 colour =
            glm::mix(glm::vec3(0.25f, 0.34f, 0.12f), glm::vec3(0.56f, 0.62f, 0.26f), p.y);
        return glm::vec4(colour, edge(inside, size));
    });
}

TextureImage tileTexture(int size, int tiles, const glm::vec3& tile, const glm::vec3& grout) {
    return fill("tiles", size, [=](const glm::vec2& p) {
        const glm::vec2 q = p * static_cast<float>(tiles), f = glm::fract(q);
        const glm::vec2 toEdge = glm::min(f, 1.0f - f);
        const float joint = std::min(toEdge.x, toEdge.y);
        const glm::vec2 cell = glm::floor(q);
        RandomSequence random(static_cast<std::uint32_t>(cell.x) * 57u +
                              static_cast<std::uint32_t>(cell.y) * 131u + 3u);
        const float shade = random.between(0.86f, 1.06f);
        return glm::vec4(glm::mix(grout, tile * shade, glm::smoothstep(0.03f, 0.06f, joint)), 1);
    });
}

} // namespace kestrel::builtin
