// The BVH against brute force, on the geometry that trees and triangle tests stumble over.
#include "scene/bvh.h"
#include "scene/bvh_trace.h"
#include "shared/random.h"
#include "shared/triangle.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

namespace kestrel {
namespace {

float unit(std::uint32_t i) { return shared::unitFloat(shared::hashUint(i)); }

glm::vec3 pointInCube(std::uint32_t i) {
    return glm::vec3(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2)) * 2.0f - 1.0f;
}

void addTriangle(Geometry& g, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    for (const glm::vec3& p : {a, b, c}) {
        g.indices.push_back(static_cast<std::uint32_t>(g.positions.size()));
        g.positions.push_back(p);
        g.bounds.add(p);
    }
    g.materials.push_back(0);
    g.attributes.resize(g.positions.size());
    g.ranges[0].count = g.triangleCount();
}

// `count` small random triangles in the cube [-1, 1]^3 times `scale`.
Geometry randomGeometry(std::uint32_t count, float scale = 1, float size = 0.15f) {
    Geometry g;
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec3 a = pointInCube(4 * i);
        addTriangle(g, scale * a, scale * (a + size * pointInCube(4 * i + 1)),
                    scale * (a + size * pointInCube(4 * i + 2)));
    }
    return g;
}

// A closed, finely folded sphere of n by n cells.
Geometry sphereGeometry(int n) {
    Geometry g;
    const auto at = [n](int i, int j) {
        const float a = 6.2831853f * static_cast<float>(i % n) / static_cast<float>(n);
        const float b = 3.14159265f * static_cast<float>(j) / static_cast<float>(n);
        if (j == 0 || j == n) return glm::vec3(0, j == 0 ? 1 : -1, 0);
        return glm::vec3(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a));
    };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            addTriangle(g, at(i, j), at(i + 1, j), at(i + 1, j + 1));
            addTriangle(g, at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    return g;
}

std::vector<TraceHit> bruteForce(const Geometry& g, const TraceRay& ray) {
    std::vector<TraceHit> hits;
    for (std::uint32_t i = 0; i < g.triangleCount(); ++i) {
        const auto corner = [&](std::uint32_t k) { return g.positions[g.indices[3 * i + k]]; };
        shared::TriangleHit hit{};
        if (shared::intersectTriangle(shared::triangleRay(ray.origin, ray.direction), ray.tMin, ray.tMax,
                                      corner(0), corner(1), corner(2), hit))
            hits.push_back({hit.t, hit.u, hit.v, i});
    }
    std::sort(hits.begin(), hits.end(), [](const TraceHit& a, const TraceHit& b) {
        return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
    });
    return hits;
}

// What a tree answers is what brute force found, sorted, to the bit.
template<class Tree>
void expectAnswers(const Tree& bvh, const TraceRay& ray, const std::vector<TraceHit>& expected) {
    const auto closest = closestHit(bvh, ray);
    EXPECT_EQ(closest.has_value(), !expected.empty());
    if (closest && !expected.empty()) {
        EXPECT_EQ(*closest, expected.front());
    }
    EXPECT_EQ(anyHit(bvh, ray), !expected.empty());
    std::vector<TraceHit> all;
    allHits(bvh, ray, [&](const TraceHit& hit) {
        all.push_back(hit);
        return false;
    });
    std::sort(all.begin(), all.end(), [](const TraceHit& a, const TraceHit& b) {
        return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
    });
    EXPECT_EQ(all, expected);
}

WideBvh buildWide(const Geometry& g) { return widened(buildBvh(g, {.maxLeaf = 1})); }

// Closest, any and all hits of random rays through the geometry equal brute force, to the bit, in both
// layouts. Returns how many rays hit something.
int expectEqualsBruteForce(const Geometry& g, const BvhSettings& settings, std::uint32_t rays,
                           float scale = 1) {
    const Bvh bvh = buildBvh(g, settings);
    const WideBvh wide = buildWide(g);
    int hitting = 0;
    for (std::uint32_t i = 0; i < rays; ++i) {
        const glm::vec3 from = 1.5f * scale * pointInCube(90000 + 2 * i);
        const glm::vec3 to = scale * pointInCube(90001 + 2 * i);
        TraceRay ray{from, glm::normalize(to - from)};
        if (i % 3 == 1) ray.tMax = 0.7f * scale;
        if (i % 3 == 2) ray.tMin = 0.4f * scale;
        const std::vector<TraceHit> expected = bruteForce(g, ray);
        expectAnswers(bvh, ray, expected);
        expectAnswers(wide, ray, expected);
        if (!expected.empty()) ++hitting;
    }
    return hitting;
}

// Every triangle lies in exactly one leaf and inside all boxes above it; returns the depth found.
int checkTree(const Bvh& bvh, std::uint32_t reference, const Box& box, std::vector<int>& seen) {
    const auto inside = [&](const glm::vec3& p) {
        return glm::all(glm::lessThanEqual(box.min, p)) && glm::all(glm::lessThanEqual(p, box.max));
    };
    if (shared::bvhIsLeaf(reference)) {
        for (std::uint32_t i = 0; i < shared::bvhLeafCount(reference); ++i) {
            const BvhTriangle& t = bvh.triangles[shared::bvhLeafFirst(reference) + i];
            ++seen[t.triangle];
            EXPECT_TRUE(inside(t.p0) && inside(t.p1) && inside(t.p2));
        }
        return 0;
    }
    int depth = 0;
    for (const auto& child : bvh.nodes[reference].children) {
        if (shared::bvhIsLeaf(child.reference) && shared::bvhLeafCount(child.reference) == 0) continue;
        if (!shared::bvhIsLeaf(child.reference)) {
            EXPECT_GT(child.reference, reference);
        }
        EXPECT_TRUE(inside(child.min) && inside(child.max));
        Box childBox;
        childBox.add(child.min);
        childBox.add(child.max);
        depth = std::max(depth, checkTree(bvh, child.reference, childBox, seen));
    }
    return depth + 1;
}

// The same of a wide tree: planes lie outside of what they bound by a 256th of a step at least.
int checkWide(const WideBvh& wide, std::uint32_t at, Box& box, std::vector<int>& seen) {
    const auto& texels = wide.items[at].texels;
    if ((texels[0].w & shared::wideNode) == 0) {
        ++seen[texels[0].w];
        for (const glm::uvec4& texel : texels) box.add(glm::uintBitsToFloat(glm::uvec3(texel)));
        return 0;
    }
    int depth = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
        if ((texels[2].w >> k & 1u) == 0) continue;
        const std::uint32_t below = (texels[1].w + shared::wideTexelOf(1u << k)) / shared::wideTexels;
        EXPECT_GT(below, at);
        Box child;
        depth = std::max(depth, checkWide(wide, below, child, seen));
        for (int axis = 0; axis < 3; ++axis) {
            const double step = std::ldexp(1.0, static_cast<int>(texels[0].w >> (8 * axis) & 255u) - 127);
            const double origin = glm::uintBitsToFloat(texels[0][axis]);
            const auto plane = [&](std::uint32_t word) { return origin + step * (word >> (8 * k) & 255u); };
            EXPECT_LE(plane(texels[1][axis]) + step / 256, child.min[axis]);
            EXPECT_GE(plane(texels[2][axis]) - step / 256, child.max[axis]);
        }
        box.add(child);
    }
    return depth + 1;
}

void expectValidTree(const Geometry& g, const Bvh& bvh) {
    std::vector<int> seen(g.triangleCount(), 0);
    const int depth = checkTree(bvh, 0, g.bounds, seen);
    EXPECT_EQ(depth, bvh.depth);
    EXPECT_LE(bvh.depth, static_cast<int>(shared::bvhStackSize));
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
    const WideBvh wide = buildWide(g);
    Box box;
    EXPECT_EQ(checkWide(wide, 0, box, seen), wide.depth);
    EXPECT_LE(wide.depth, static_cast<int>(shared::wideStackSize));
    EXPECT_LE(wide.items.size(), mostWideItems(g.triangleCount()));
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 2; }));
}

TEST(Bvh, EmptyGeometryHasARootThatNothingHits) {
    const Bvh bvh = buildBvh(Geometry{});
    ASSERT_EQ(bvh.nodes.size(), 1u);
    EXPECT_FALSE(closestHit(bvh, {{0, 0, 1}, {0, 0, -1}}));
    EXPECT_FALSE(anyHit(bvh, {{0, 0, 1}, {0, 0, -1}}));
    EXPECT_FALSE(closestHit(buildWide({}), {{0, 0, 1}, {0, 0, -1}}));
}

TEST(Bvh, OneTriangleIsHitWhereItIs) {
    Geometry g;
    addTriangle(g, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Bvh bvh = buildBvh(g);
    expectValidTree(g, bvh);
    const auto hit = closestHit(bvh, {{0.25f, 0.5f, 2}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->t, 2);
    EXPECT_EQ(hit->u, 0.25f);
    EXPECT_EQ(hit->v, 0.5f);
    EXPECT_FALSE(closestHit(bvh, {{0.75f, 0.5f, 2}, {0, 0, -1}}));
    // From behind as well, and only within the interval, whose ends belong to it.
    EXPECT_TRUE(anyHit(bvh, {{0.25f, 0.5f, -2}, {0, 0, 1}}));
    EXPECT_TRUE(anyHit(bvh, {{0.25f, 0.5f, 2}, {0, 0, -1}, 0, 2}));
    EXPECT_FALSE(anyHit(bvh, {{0.25f, 0.5f, 2}, {0, 0, -1}, 0, 1.999f}));
    EXPECT_FALSE(anyHit(bvh, {{0.25f, 0.5f, 2}, {0, 0, -1}, 2.001f}));
    // Parallel to its plane, in it: no hit, no NaN.
    EXPECT_FALSE(anyHit(bvh, {{-1, 0.25f, 0}, {1, 0, 0}}));
}

TEST(Bvh, EqualsBruteForceForEveryLeafSizeAndBinCount) {
    const Geometry g = randomGeometry(700);
    for (const int maxLeaf : {1, 4, 15}) {
        for (const int bins : {2, 16, 32}) {
            EXPECT_GT(expectEqualsBruteForce(g, {maxLeaf, bins, 1}, 150), 25);
        }
    }
}

TEST(Bvh, VerySmallAndVeryLargeScenesWorkAlike) {
    for (const float scale : {1e-4f, 1.0f, 1e4f}) {
        const Geometry g = randomGeometry(500, scale);
        expectValidTree(g, buildBvh(g));
        EXPECT_GT(expectEqualsBruteForce(g, {}, 300, scale), 50) << scale;
    }
}

TEST(Bvh, DegenerateTrianglesAndSliversDoNoHarm) {
    Geometry g = randomGeometry(200);
    for (std::uint32_t i = 0; i < 200; ++i) {
        const glm::vec3 a = pointInCube(5000 + 3 * i), b = pointInCube(5001 + 3 * i);
        if (i % 4 == 0) addTriangle(g, a, a, a);
        if (i % 4 == 1) addTriangle(g, a, b, a);
        if (i % 4 == 2) addTriangle(g, a, 0.5f * (a + b), b);
        if (i % 4 == 3) addTriangle(g, a, b, a + 1e-6f * pointInCube(5002 + 3 * i));
    }
    expectValidTree(g, buildBvh(g));
    EXPECT_GT(expectEqualsBruteForce(g, {}, 300), 20);
}

TEST(Bvh, IdenticalCentroidsAndCoplanarDuplicatesAreSplitAnyway) {
    Geometry g;
    for (int i = 0; i < 500; ++i) addTriangle(g, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    const Bvh bvh = buildBvh(g);
    expectValidTree(g, bvh);
    EXPECT_LE(bvh.depth, 10);
    int count = 0;
    allHits(bvh, {{0, 0, 1}, {0, 0, -1}}, [&](const TraceHit&) { return ++count == 500; });
    EXPECT_EQ(count, 500);
    const auto closest = closestHit(bvh, {{0, 0, 1}, {0, 0, -1}});
    ASSERT_TRUE(closest);
    EXPECT_EQ(closest->triangle, 0u);
}

TEST(Bvh, VisitStopsWhenAsked) {
    Geometry g;
    for (int i = 0; i < 50; ++i)
        addTriangle(g, {-1, -1, -0.1f * static_cast<float>(i)}, {1, -1, 0}, {0, 1, 0});
    int count = 0;
    allHits(buildBvh(g), {{0, 0, 9}, {0, 0, -1}}, [&](const TraceHit&) { return ++count == 3; });
    EXPECT_EQ(count, 3);
}

// Sizes that fall by a factor along a line drive a greedy builder into a list as deep as it is long.
TEST(Bvh, DepthStaysWithinTheStackForGeometricSeries) {
    for (const float factor : {0.5f, 0.8f, 0.97f}) {
        Geometry g;
        float x = 1e30f;
        for (int i = 0; i < 3000 && x > 1e-30f; ++i) {
            addTriangle(g, {x, 0, 0}, {x * 1.01f, 0, 0}, {x, x * 0.01f, 0});
            x *= factor;
        }
        const Bvh bvh = buildBvh(g, {1, 16, 1});
        expectValidTree(g, bvh);
    }
}

TEST(Bvh, NoRaySlipsThroughTheEdgesOfAClosedSurface) {
    const Geometry g = sphereGeometry(40);
    const Bvh bvh = buildBvh(g);
    const WideBvh wide = buildWide(g);
    for (std::uint32_t i = 0; i < g.triangleCount(); ++i) {
        const glm::vec3 a = g.positions[g.indices[3 * i]], b = g.positions[g.indices[3 * i + 1]];
        const glm::vec3 inside = 0.3f * pointInCube(i);
        const auto leaks = [&](const glm::vec3& to) {
            const TraceRay ray{inside, glm::normalize(to - inside)};
            return !anyHit(bvh, ray) || !anyHit(wide, ray);
        };
        EXPECT_FALSE(leaks(0.5f * (a + b)));
        EXPECT_FALSE(leaks(glm::mix(a, b, 0.1f + 0.8f * unit(i))));
        EXPECT_FALSE(leaks(pointInCube(7 * i)));
        EXPECT_FALSE(leaks(a));
    }
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 d(0);
        d[axis] = 1;
        EXPECT_TRUE(anyHit(bvh, {{0, 0, 0}, d}) && anyHit(wide, {{0, 0, 0}, d}));
        EXPECT_TRUE(anyHit(bvh, {{0, 0, 0}, -d}) && anyHit(wide, {{0, 0, 0}, -d}));
    }
}

// Rays at every vertex, along and beside every edge of closed and open surfaces, in many directions: what is
// closed is met once from inside, and twice by a ray through it; a sheet once.
TEST(Bvh, ASurfaceIsMetOnceAtEveryVertexAndEdge) {
    const auto count = [](const auto& bvh, const TraceRay& ray) {
        int hits = 0;
        allHits(bvh, ray, [&](const TraceHit&) { return ++hits, false; });
        return hits;
    };
    const Geometry ball = sphereGeometry(24);
    const Bvh ballBvh = buildBvh(ball);
    const WideBvh ballWide = buildWide(ball);
    for (std::uint32_t i = 0; i < ball.triangleCount(); ++i) {
        const auto corner = [&](std::uint32_t k) { return ball.positions[ball.indices[3 * i + k % 3]]; };
        for (std::uint32_t k = 0; k < 12; ++k) {
            const glm::vec3 inside = k == 0 ? glm::vec3(0) : 0.3f * pointInCube(97 * i + k);
            const glm::vec3 at =
                k % 2 == 0 ? corner(k) : glm::mix(corner(k), corner(k + 1), unit(31 * i + k));
            ASSERT_EQ(count(ballBvh, {inside, at - inside}), 1) << i << " " << k;
            ASSERT_EQ(count(ballWide, {inside, at - inside}), 1) << i << " " << k;
        }
    }
    // A sheet of 16 x 16 cells, flat and then in waves, whose vertices lie on round numbers.
    for (const float height : {0.0f, 0.03125f}) {
        Geometry sheet;
        const auto at = [&](int x, int y) {
            return glm::vec3(x - 8, y - 8, height * static_cast<float>((x * 5 + y * 3) % 4)) / 8.0f;
        };
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                addTriangle(sheet, at(x, y), at(x + 1, y), at(x + 1, y + 1));
                addTriangle(sheet, at(x + 1, y + 1), at(x, y + 1), at(x, y));
            }
        const Bvh bvh = buildBvh(sheet);
        const WideBvh wide = buildWide(sheet);
        std::uint32_t number = 0;
        for (int y = 1; y < 16; ++y)
            for (int x = 1; x < 16; ++x)
                for (int k = 0; k < 16; ++k) {
                    glm::vec3 to = at(x, y);
                    if (k % 4 == 1) to = glm::mix(to, at(x + 1, y + 1), unit(++number));
                    if (k % 4 == 2) to = 0.5f * (to + at(x + 1, y));
                    // Straight down, and from any place above.
                    const glm::vec3 aside = 0.5f * pointInCube(++number);
                    const glm::vec3 from = k < 4 ? to + glm::vec3(0, 0, 2) : glm::vec3(aside.x, aside.y, 3);
                    ASSERT_EQ(count(bvh, {from, to - from}), 1) << x << ", " << y << " " << k;
                    ASSERT_EQ(count(wide, {from, to - from}), 1) << x << ", " << y << " " << k;
                    ASSERT_EQ(count(wide, {to + (to - from), from - to}), 1) << x << ", " << y << " " << k;
                    ASSERT_EQ(count(bvh, {to + (to - from), from - to}), 1) << x << ", " << y << " " << k;
                }
    }
}

TEST(Bvh, ResultDoesNotDependOnThreads) {
    const Geometry g = randomGeometry(30000, 1, 0.02f);
    const Bvh one = buildBvh(g, {4, 16, 1}), two = buildBvh(g, {4, 16, 2}), four = buildBvh(g, {4, 16, 4});
    expectValidTree(g, two);
    for (const Bvh* other : {&two, &four}) {
        ASSERT_EQ(one.nodes.size(), other->nodes.size());
        EXPECT_EQ(std::memcmp(one.nodes.data(), other->nodes.data(), one.nodes.size() * sizeof(BvhNode)), 0);
        ASSERT_EQ(one.triangles.size(), other->triangles.size());
        EXPECT_EQ(std::memcmp(one.triangles.data(), other->triangles.data(),
                              one.triangles.size() * sizeof(BvhTriangle)),
                  0);
        EXPECT_EQ(one.depth, other->depth);
    }
}

// Large enough to be made by several threads.
TEST(Bvh, AWideTreeOfManyTrianglesIsWhole) {
    const Geometry g = randomGeometry(30000, 1, 0.02f);
    expectValidTree(g, buildBvh(g));
    EXPECT_GT(expectEqualsBruteForce(g, {}, 100), 20);
    const WideBvh one = buildWide(g), again = buildWide(g);
    ASSERT_EQ(one.items.size(), again.items.size());
    EXPECT_EQ(std::memcmp(one.items.data(), again.items.data(), one.items.size() * sizeof(WideItem)), 0);
}

// Fitted to what has moved, by little or by much, a tree answers as one built anew does; fitted to what has
// not, it is itself.
TEST(Bvh, AFittedWideTreeIsWholeAndAnswersAlike) {
    Geometry g = randomGeometry(3000, 1, 0.1f);
    const WideBvh built = buildWide(g);
    WideBvh fitted = built;
    refit(fitted, g);
    EXPECT_EQ(std::memcmp(fitted.items.data(), built.items.data(), built.items.size() * sizeof(WideItem)), 0);
    double before = expectedVisits(built);
    EXPECT_GT(before, 5);
    for (const float by : {0.001f, 0.1f, 3.0f}) {
        for (std::size_t i = 0; i < g.positions.size(); ++i)
            g.positions[i] += by * pointInCube(static_cast<std::uint32_t>(i));
        refit(fitted, g);
        std::vector<int> seen(g.triangleCount(), 0);
        Box box;
        EXPECT_EQ(checkWide(fitted, 0, box, seen), fitted.depth);
        EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
        EXPECT_GE(expectedVisits(fitted), 0.99 * expectedVisits(buildWide(g))) << by;
        EXPECT_GE(expectedVisits(fitted), 0.99 * before) << by;
        before = expectedVisits(fitted);
        int hitting = 0;
        for (std::uint32_t i = 0; i < 100; ++i) {
            const glm::vec3 from = 3.0f * pointInCube(50000 + 2 * i), to = pointInCube(50001 + 2 * i);
            const TraceRay ray{from, glm::normalize(to - from)};
            const std::vector<TraceHit> expected = bruteForce(g, ray);
            expectAnswers(fitted, ray, expected);
            hitting += !expected.empty();
        }
        EXPECT_GT(hitting, 20) << by;
    }
    // Triangles all over each other leave another tree little to gain, and yet it gains.
    EXPECT_GT(expectedVisits(fitted), 1.15 * expectedVisits(buildWide(g)));
    WideBvh empty = buildWide({});
    refit(empty, {});
    EXPECT_EQ(expectedVisits(empty), 1);
}

TEST(Bvh, CarriesMaterialAndClass) {
    Geometry g = randomGeometry(10);
    g.materials = {0, 0, 0, 0, 1, 1, 1, 2, 2, 2};
    g.ranges[0] = {0, 4};
    g.ranges[1] = {4, 3};
    g.ranges[2] = {7, 0};
    g.ranges[3] = {7, 3};
    for (const BvhTriangle& t : buildBvh(g).triangles) {
        EXPECT_EQ(t.material, g.materials[t.triangle]);
        EXPECT_EQ(t.triangleClass, t.triangle < 4 ? 0u : t.triangle < 7 ? 1u : 3u);
        EXPECT_EQ(t.p0, g.positions[g.indices[3 * t.triangle]]);
    }
}

} // namespace
} // namespace kestrel
