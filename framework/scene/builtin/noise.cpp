#include "scene/builtin/noise.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kestrel::builtin {
namespace {

// PCG-RXS-M-XS, as a hash (Jarzynski and Olano, Hash Functions for GPU Rendering, 2020).
std::uint32_t hash(std::uint32_t x) {
    const std::uint32_t state = x * 747796405u + 2891336453u;
    const std::uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

std::uint32_t hash(const glm::ivec3& cell) {
    return hash(static_cast<std::uint32_t>(cell.x) +
                hash(static_cast<std::uint32_t>(cell.y) + hash(static_cast<std::uint32_t>(cell.z))));
}

// The upper 24 bits as a number in [0, 1).
float toUnit(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

glm::ivec3 cellOf(const glm::vec3& p) { return {glm::floor(p)}; }

float gradientTerm(const glm::ivec3& corner, const glm::vec3& offset) {
    // The twelve edges of a cube, four of them twice, as in Perlin's improved noise.
    const std::uint32_t h = hash(corner) & 15u;
    const float u = h < 8 ? offset.x : offset.y;
    const float v = h < 4 ? offset.y : (h == 12 || h == 14 ? offset.x : offset.z);
    return ((h & 1u) ? -u : u) + ((h & 2u) ? -v : v);
}

} // namespace

float RandomSequence::unit() { return toUnit(hash(seed_ * 0x9e3779b9u + hash(counter_++))); }

float RandomSequence::between(float low, float high) { return low + (high - low) * unit(); }

glm::vec3 RandomSequence::onSphere() {
    const float z = between(-1, 1);
    const float angle = between(0, 2 * std::numbers::pi_v<float>);
    const float r = std::sqrt(std::max(0.0f, 1 - z * z));
    return {r * std::cos(angle), r * std::sin(angle), z};
}

float gradientNoise(const glm::vec3& p) {
    const glm::ivec3 cell = cellOf(p);
    const glm::vec3 f = p - glm::vec3(cell);
    const glm::vec3 w = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    const auto term = [&](int x, int y, int z) {
        return gradientTerm(cell + glm::ivec3(x, y, z), f - glm::vec3(x, y, z));
    };
    const auto row = [&](int y, int z) { return glm::mix(term(0, y, z), term(1, y, z), w.x); };
    return glm::mix(glm::mix(row(0, 0), row(1, 0), w.y), glm::mix(row(0, 1), row(1, 1), w.y), w.z);
}

float fractalNoise(const glm::vec3& p, int octaves) {
    float sum = 0, amplitude = 1, frequency = 1;
    for (int i = 0; i < octaves; ++i) {
        // Octaves are moved apart so that their lattices do not meet in one point.
        sum += amplitude * gradientNoise(p * frequency + 17.3f * static_cast<float>(i));
        amplitude *= 0.5f;
        frequency *= 2;
    }
    return sum;
}

Cellular cellularNoise(const glm::vec3& p) {
    const glm::ivec3 cell = cellOf(p);
    Cellular found{8, 8};
    for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                const glm::ivec3 c = cell + glm::ivec3(x, y, z);
                const std::uint32_t h = hash(c);
                const glm::vec3 point =
                    glm::vec3(c) + glm::vec3(toUnit(h), toUnit(hash(h)), toUnit(hash(h ^ 0x5bd1e995u)));
                const float d = glm::length(point - p);
                if (d < found.nearest) {
                    found.second = found.nearest;
                    found.nearest = d;
                } else {
                    found.second = std::min(found.second, d);
                }
            }
        }
    }
    return found;
}

} // namespace kestrel::builtin
