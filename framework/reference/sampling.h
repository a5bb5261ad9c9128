// Points and directions of the reference's samples.
#pragma once
#include "shared/random.h"
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace kestrel {

// The unit disk with equal areas and little distortion (Shirley and Chiu, "A Low Distortion Map Between Disk
// and Square", 1997).
inline glm::vec2 concentricDisk(const glm::vec2& u) {
    const glm::vec2 s = 2.0f * u - 1.0f;
    if (s.x == 0 && s.y == 0) return {0, 0};
    constexpr float quarter = std::numbers::pi_v<float> / 4;
    const bool wide = std::abs(s.x) > std::abs(s.y);
    const float radius = wide ? s.x : s.y;
    const float angle = wide ? quarter * (s.y / s.x) : 2 * quarter - quarter * (s.x / s.y);
    return radius * glm::vec2(std::cos(angle), std::sin(angle));
}

// Two unit vectors perpendicular to the unit vector n (Duff et al., "Building an Orthonormal Basis,
// Revisited", 2017); columns tangent, bitangent, n.
inline glm::mat3 basisAround(const glm::vec3& n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1 / (sign + n.z), b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

// Direction around +z with density cosine / pi.
inline glm::vec3 cosineDirection(const glm::vec2& u) {
    const glm::vec2 disk = concentricDisk(u);
    return {disk, std::sqrt(std::max(0.0f, 1 - glm::dot(disk, disk)))};
}

// Point `index` of the Owen-scrambled Sobol sequence of `seed`: shared::scrambledSobol without the shuffled
// order, which only a running sequence needs.
inline glm::vec2 sobolPoint(std::uint32_t index, std::uint32_t seed) {
    const std::uint32_t x = shared::reverseBits32(shared::laineKarras(index, shared::hashCombine(seed, 1)));
    const std::uint32_t y = shared::reverseBits32(
        shared::laineKarras(shared::reversedSobol1(index), shared::hashCombine(seed, 2)));
    return {shared::unitFloat(x), shared::unitFloat(y)};
}

} // namespace kestrel
