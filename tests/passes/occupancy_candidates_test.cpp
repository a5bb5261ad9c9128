// Strata, their candidates and what a snapped ray counts for.
#include "passes/occupancy/candidates.h"
#include "shared/random.h"
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <set>

namespace kestrel::test {
namespace {

TEST(OccupancyCandidates, EverySquareHasItsShareOfTheHemisphere) {
    // Uniform points of the square give uniform directions: z is uniform in [0, 1], and the azimuth too.
    constexpr int count = 200'000;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<int> heights(20), azimuths(20);
    for (int i = 0; i < count; ++i) {
        const double u = unit(random), v = unit(random);
        const glm::dvec3 d = hemisphereFromSquare({u, v});
        ASSERT_NEAR(glm::length(d), 1, 1e-12);
        ASSERT_GE(d.z, 0);
        ++heights[std::min<size_t>(19, static_cast<size_t>(d.z * 20))];
        const double turn = std::atan2(d.y, d.x) / (2 * std::numbers::pi) + 0.5;
        ++azimuths[std::min<size_t>(19, static_cast<size_t>(turn * 20))];
    }
    // Five standard deviations of a bin's count.
    const double bound = 5 * std::sqrt(count / 20.0);
    for (const int found : heights) EXPECT_NEAR(found, count / 20, bound);
    for (const int found : azimuths) EXPECT_NEAR(found, count / 20, bound);
}

TEST(OccupancyCandidates, TheInverseFindsThePoint) {
    double worst = 0;
    for (int y = 0; y <= 512; ++y) {
        for (int x = 0; x <= 512; ++x) {
            const glm::dvec2 point(x / 512.0, y / 512.0);
            const glm::vec2 found = shared::squareFromHemisphere(glm::vec3(hemisphereFromSquare(point)));
            worst = std::max(worst, glm::length(glm::dvec2(found) - point));
        }
    }
    EXPECT_LT(worst, 2e-6);
}

// A ten-thousandth of a stratum from its borders the lookup is still right, at every resolution.
TEST(OccupancyCandidates, TheStratumOfADirectionIsExactUpToItsBorders) {
    constexpr double places[] = {1e-4, 0.01, 0.3, 0.5, 0.77, 0.99, 1 - 1e-4};
    for (int n = 2; n <= 16; ++n)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                for (const double v : places)
                    for (const double u : places) {
                        const glm::vec3 d =
                            hemisphereFromSquare((glm::dvec2(x, y) + glm::dvec2(u, v)) / double(n));
                        ASSERT_EQ(shared::stratumOf(d, n), y * n + x) << n << ": " << x + u << " " << y + v;
                    }
}

TEST(OccupancyCandidates, StrataOfDirectionsAtTheRimExist) {
    for (const glm::vec3 d :
         {glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(-1, 0, 0),
          glm::normalize(glm::vec3(1, 1, 0)), glm::normalize(glm::vec3(-1, 1, 1e-7f))})
        for (int n = 2; n <= 16; ++n) {
            EXPECT_GE(shared::stratumOf(d, n), 0);
            EXPECT_LT(shared::stratumOf(d, n), n * n);
        }
}

TEST(OccupancyCandidates, EachStratumHoldsItsCandidateInEveryFrame) {
    for (const int n : {2, 4, 7, 16}) {
        auto strata = romaStrata(n);
        std::vector<glm::vec3> before(strata.size());
        for (std::uint32_t frame = 0; frame < 16; ++frame) {
            drawCandidates(strata, n, frame, 5);
            int inside = 0;
            for (int k = 0; k < n * n; ++k) {
                const glm::vec3& d = strata[static_cast<size_t>(k)].direction;
                EXPECT_NEAR(glm::length(d), 1, 1e-6);
                EXPECT_GE(d.z, 0);
                EXPECT_NE(d, before[static_cast<size_t>(k)]);
                before[static_cast<size_t>(k)] = d;
                inside += shared::stratumOf(d, n) == k;
            }
            EXPECT_GE(inside, n * n - 1); // one that rounding puts on a border may read as its neighbour's
        }
    }
}

TEST(OccupancyCandidates, SameSeedSameCandidates) {
    auto a = romaStrata(4), b = romaStrata(4), c = romaStrata(4);
    drawCandidates(a, 4, 3, 1);
    drawCandidates(b, 4, 3, 1);
    drawCandidates(c, 4, 3, 2);
    for (size_t k = 0; k < 16; ++k) {
        EXPECT_EQ(a[k].direction, b[k].direction);
        EXPECT_NE(a[k].direction, c[k].direction);
    }
}

TEST(OccupancyCandidates, RotationsAreRightHandedAndUnit) {
    auto strata = romaStrata(8);
    drawCandidates(strata, 8, 0, 0);
    for (const shared::RomaDirection& stratum : strata) {
        const glm::vec3 w = stratum.direction, u = shared::romaAxisX(w), v = shared::romaAxisY(w);
        EXPECT_LT(glm::length(glm::cross(u, v) - w), 1e-6f);
        const shared::RomaRotation rotation = romaRotation(w);
        const double one = double(1 << shared::romaFractionBits);
        EXPECT_LT(glm::length(2.0 * glm::dvec3(rotation.halfX) / one - glm::dvec3(u)), 1e-6);
        EXPECT_LT(glm::length(2.0 * glm::dvec3(rotation.halfY) / one - glm::dvec3(v)), 1e-6);
        EXPECT_LT(glm::length(2.0 * glm::dvec3(rotation.halfZ) / one - glm::dvec3(w)), 1e-6);
    }
}

// What a consumer sees that draws cosine-distributed rays under an open sky, with the candidates of many
// frames.
double openSky(int n, const glm::vec3& normal, std::vector<shared::RomaDirection>& strata) {
    // Integrated, not sampled: a stratum (with its sign) is chosen with the probability of its
    // cosine-weighted area, and within it the candidate is uniform.
    constexpr int samples = 24;
    double expectation = 0;
    for (size_t k = 0; k < strata.size(); ++k) {
        const int x = static_cast<int>(k) % n, y = static_cast<int>(k) / n;
        for (const float flip : {1.0f, -1.0f}) {
            double cosine = 0, weight = 0;
            for (int j = 0; j < samples; ++j) {
                for (int i = 0; i < samples; ++i) {
                    const glm::dvec2 point =
                        glm::dvec2(x + (i + 0.5) / samples, y + (j + 0.5) / samples) / double(n);
                    const glm::vec3 d = flip * glm::vec3(hemisphereFromSquare(point));
                    cosine += std::max(0.0f, glm::dot(normal, d));
                    weight += shared::romaWeight(strata[k], flip, d, normal);
                }
            }
            cosine /= samples * samples;
            weight /= samples * samples;
            const double solidAngle = 2 * std::numbers::pi / (double(n) * n);
            expectation += solidAngle * cosine / std::numbers::pi * weight;
        }
    }
    return expectation;
}

TEST(OccupancyCandidates, WeightsAverageToOneUnderAnOpenSky) {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    const std::pair<int, double> bounds[] = {{2, 0.025}, {3, 0.008}, {4, 0.005},
                                             {6, 0.003}, {8, 0.002}, {16, 0.001}};
    for (const auto& [n, bound] : bounds) {
        auto strata = romaStrata(n);
        double sum = 0;
        constexpr int count = 60;
        for (int i = 0; i < count; ++i) {
            glm::vec3 tilt = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
            if (i < 6) tilt = glm::vec3(i / 2 == 0, i / 2 == 1, i / 2 == 2) * (i % 2 == 0 ? 1.0f : -1.0f);
            const double mean = openSky(n, tilt, strata);
            EXPECT_NEAR(mean, 1, bound)
                << n << " x " << n << " strata, normal " << tilt.x << " " << tilt.y << " " << tilt.z;
            sum += mean;
        }
        EXPECT_NEAR(sum / count, 1, bound / 2) << n;
    }
}

TEST(OccupancyCandidates, WeightsEndAtTheHorizonAndAreBounded) {
    auto strata = romaStrata(4);
    std::mt19937 random(4);
    std::normal_distribution<float> gauss;
    for (int i = 0; i < 20'000; ++i) {
        const glm::vec3 n = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
        glm::vec3 d = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
        const float flip = d.z < 0 ? -1.0f : 1.0f;
        const auto k = static_cast<size_t>(shared::stratumOf(flip * d, 4));
        const float weight = shared::romaWeight(strata[k], flip, d, n);
        // Barely above the horizon the stratum's mean may be taken for 0; the open sky tells what that costs.
        if (glm::dot(n, d) <= 0) {
            ASSERT_EQ(weight, 0);
        } else if (glm::dot(n, d) > 0.2f) {
            ASSERT_GT(weight, 0);
        }
        ASSERT_LE(weight, shared::romaMaxWeight);
    }
}

TEST(OccupancyCandidates, MeanCosineIsTheMeanWhereAllIsAbove) {
    EXPECT_FLOAT_EQ(shared::meanCosine(0.8f, 0.01f), 0.8f);
    EXPECT_FLOAT_EQ(shared::meanCosine(-0.8f, 0.01f), 0.0f);
    EXPECT_FLOAT_EQ(shared::meanCosine(0.3f, 0.0f), 0.3f);
    const float width = std::sqrt(5.0f * 0.04f);
    EXPECT_NEAR(shared::meanCosine(width * 0.9999f, 0.04f), width, 1e-4f);
    EXPECT_NEAR(shared::meanCosine(0.0f, 0.04f), width * 3.0f / 16.0f, 1e-6f);
    // Above and below the horizon together: mean(max(0, x)) - mean(max(0, -x)) = mean(x).
    EXPECT_NEAR(shared::meanCosine(0.1f, 0.04f) - shared::meanCosine(-0.1f, 0.04f), 0.1f, 1e-6f);
}

// In turn each map is drawn once before any is drawn again, neighbours in the order far apart on the
// hemisphere, and the samples of a stratum are stratified over the times that it is drawn.
TEST(OccupancyCandidates, RenewalInTurnReachesEveryMap) {
    for (const int n : {2, 3, 4, 8, 16}) {
        const int maps = n * n, stride = renewalStride(maps);
        std::set<int> reached;
        for (int place = 0; place < maps; ++place) reached.insert(place * stride % maps);
        EXPECT_EQ(reached.size(), static_cast<size_t>(maps)) << n;
    }
    constexpr int n = 4, refresh = 3;
    Candidates candidates;
    const Renewal all = candidates.draw(n, refresh, false, 0, 9);
    EXPECT_EQ(all.count, n * n) << "the first call draws all";
    std::vector<std::vector<glm::vec2>> samples(n * n);
    for (std::uint32_t frame = 16; frame < 16 + 16 * n * n / refresh; ++frame) {
        const Renewal renewal = candidates.draw(n, refresh, false, frame, 9);
        EXPECT_EQ(renewal.count, refresh);
        EXPECT_EQ(renewal.first, static_cast<int>(frame * refresh % (n * n)));
        for (int place = renewal.first; place < renewal.first + renewal.count; ++place) {
            const int map = place % (n * n) * renewalStride(n * n) % (n * n);
            const glm::vec3 d = candidates.strata()[static_cast<size_t>(map)].direction;
            EXPECT_EQ(shared::stratumOf(d, n), map);
            samples[static_cast<size_t>(map)].push_back(
                glm::fract(shared::squareFromHemisphere(d) * float(n)));
        }
    }
    for (const auto& drawn : samples) {
        ASSERT_GE(drawn.size(), 15u);
        int quarters[4] = {};
        for (size_t i = 0; i < 12; ++i) ++quarters[int(drawn[i].x * 2) + 2 * int(drawn[i].y * 2)];
        for (const int count : quarters) EXPECT_NEAR(count, 3, 2);
    }
    EXPECT_EQ(candidates.draw(n, 0, false, 3, 9).count, n * n);
    EXPECT_EQ(candidates.draw(n, refresh, true, 3, 9).count, n * n);
    EXPECT_EQ(candidates.draw(n, 99, false, 3, 9).count, n * n);
}

} // namespace
} // namespace kestrel::test
