#include "candidates.h"
#include "core/check.h"
#include "shared/random.h"
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

namespace kestrel {

static_assert(sizeof(shared::RomaDirection) == 48);
static_assert(offsetof(shared::RomaDirection, spreadYY) == 28);
static_assert(sizeof(shared::RomaRotation) == 48);

glm::dvec3 hemisphereFromSquare(const glm::dvec2& point) {
    const double a = 2 * point.x - 1, b = 2 * point.y - 1;
    if (a == 0 && b == 0) return {0, 0, 1};
    const double quarter = std::numbers::pi / 4;
    const bool wide = std::abs(a) > std::abs(b);
    const double radius = wide ? a : b;
    const double phi = wide ? quarter * (b / a) : 2 * quarter - quarter * (a / b);
    const double out = radius * std::sqrt(2 - radius * radius);
    return {out * std::cos(phi), out * std::sin(phi), 1 - radius * radius};
}

static shared::RomaDirection stratumMoments(int n, int x, int y) {
    constexpr int samples = 32;
    glm::dvec3 sum(0), squares(0), products(0); // products: xy, xz, yz
    for (int j = 0; j < samples; ++j) {
        for (int i = 0; i < samples; ++i) {
            const glm::dvec2 point(x + (i + 0.5) / samples, y + (j + 0.5) / samples);
            const glm::dvec3 d = hemisphereFromSquare(point / double(n));
            sum += d;
            squares += d * d;
            products += glm::dvec3(d.x * d.y, d.x * d.z, d.y * d.z);
        }
    }
    const double weight = 1.0 / (samples * samples);
    const glm::dvec3 mean = sum * weight;
    const glm::dvec3 spread = squares * weight - mean * mean;
    const glm::dvec3 mixed =
        products * weight - glm::dvec3(mean.x * mean.y, mean.x * mean.z, mean.y * mean.z);
    shared::RomaDirection result{};
    result.direction = hemisphereFromSquare(glm::dvec2(x + 0.5, y + 0.5) / double(n));
    result.mean = mean;
    result.spreadXX = static_cast<float>(spread.x);
    result.spreadYY = static_cast<float>(spread.y);
    result.spreadZZ = static_cast<float>(spread.z);
    result.spreadXY = static_cast<float>(mixed.x);
    result.spreadXZ = static_cast<float>(mixed.y);
    result.spreadYZ = static_cast<float>(mixed.z);
    return result;
}

std::vector<shared::RomaDirection> romaStrata(int n) {
    KESTREL_CHECK_LE(n * n, shared::romaMaxDirections);
    std::vector<shared::RomaDirection> strata;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) strata.push_back(stratumMoments(n, x, y));
    return strata;
}

// `sequence` tells apart the sequences that one stratum has.
static glm::vec3 drawCandidate(int n, std::uint32_t stratum, std::uint32_t sequence, std::uint32_t sample,
                               std::uint32_t seed) {
    const std::uint32_t scramble = shared::pixelSeed({stratum, sequence}, shared::randomCandidates, seed);
    const glm::dvec2 corner(stratum % static_cast<std::uint32_t>(n), stratum / static_cast<std::uint32_t>(n));
    const glm::dvec2 u(shared::scrambledSobol(sample, scramble));
    return glm::normalize(glm::vec3(hemisphereFromSquare((corner + u) / double(n))));
}

void drawCandidates(std::vector<shared::RomaDirection>& strata, int n, std::uint32_t frame,
                    std::uint32_t seed) {
    KESTREL_CHECK_EQ(strata.size(), static_cast<size_t>(n) * static_cast<size_t>(n));
    for (size_t i = 0; i < strata.size(); ++i)
        strata[i].direction = drawCandidate(n, static_cast<std::uint32_t>(i), 0, frame, seed);
}

int renewalStride(int maps) {
    int stride = std::max(1, static_cast<int>(std::lround(0.618 * maps))); // the golden section
    while (std::gcd(stride, maps) != 1) ++stride;
    return stride;
}

Renewal Candidates::draw(int n, int refresh, bool all, std::uint32_t frame, std::uint32_t seed) {
    const int maps = n * n;
    if (n_ != n) {
        strata_ = romaStrata(n);
        n_ = n;
        all = true;
    }
    if (all || refresh == 0 || refresh >= maps) {
        drawCandidates(strata_, n, frame, seed);
        return {0, maps};
    }
    // Turns of all frames in a row: a map's turn comes round after as many as there are maps.
    const auto count = static_cast<std::uint64_t>(maps);
    const std::uint64_t begin = std::uint64_t{frame} * static_cast<std::uint64_t>(refresh);
    const auto stride = static_cast<std::uint64_t>(renewalStride(maps));
    for (std::uint64_t turn = begin; turn < begin + static_cast<std::uint64_t>(refresh); ++turn) {
        const std::uint64_t stratum = turn % count * stride % count;
        strata_[stratum].direction = drawCandidate(n, static_cast<std::uint32_t>(stratum), 1,
                                                   static_cast<std::uint32_t>(turn / count), seed);
    }
    return {static_cast<int>(begin % count), refresh};
}

shared::RomaRotation romaRotation(const glm::vec3& direction) {
    const auto fixedHalf = [](const glm::vec3& axis) {
        return glm::ivec4(glm::round(glm::dvec3(axis) * double(1 << (shared::romaFractionBits - 1))), 0);
    };
    return {fixedHalf(shared::romaAxisX(direction)), fixedHalf(shared::romaAxisY(direction)),
            fixedHalf(direction)};
}

} // namespace kestrel
