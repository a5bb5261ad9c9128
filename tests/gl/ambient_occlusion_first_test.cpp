// The first pass of ambient occlusion against closed forms and a second writing of its formulas, in double
// precision on the CPU.
#include "depth_source.h"
#include "shared/ambient_occlusion.h"
#include "shared/random.h"
#include "shared/work_list.h"
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace kestrel::test {
namespace {

const PortRef visibility{"first", "visibility"}, mask{"first", "mask"}, rayMin{"first", "ray_min"},
    rayMax{"first", "ray_max"}, sdMask{"first", "sd_mask"}, pixels{"first", "pixels"},
    settings{"first", "settings"};

struct Parameters {
    bool hbao = false, dual = false;
    int samples = 8, guard = 0, mapDivisor = 4, mapGuard = 64;
    double radius = 0.5, exponent = 1, thickness = 0, cutoff = 0, maximumRadius = 512;
};

struct Answer {
    double visibility = 1;
    std::uint32_t mask = 0;
    // Of each sample in the mask: texel, and the distances between which it is asked about.
    struct Ray {
        glm::ivec2 texel;
        double from, to;
    };
    std::vector<Ray> rays;
};

struct FirstPass : DepthTest {
    static Graph graph(const Parameters& p, const std::vector<PortRef>& outputs) {
        Graph made =
            parseGraph(fmt::format(R"({{"kestrel": 1, "passes": {{
            "source": {{"type": "DepthSource", "properties": {{"guard": {}}}}},
            "first": {{"type": "AmbientOcclusionFirst", "properties": {{
                "kernel": "{}", "samples": "{}", "dual": {}, "radius": {}, "exponent": {}, "thickness": {},
                "cutoff": {}, "maximum_radius": {}, "divisor": {}, "guard": {}}}}}}},
            "edges": [["source.view_depth", "first.view_depth"], ["source.normal", "first.normal"],
                ["source.second_depth", "first.second_depth"]],
            "outputs": []}})",
                                   p.guard, p.hbao ? "hbao" : "vao", p.samples, p.dual, p.radius, p.exponent,
                                   p.thickness, p.cutoff, p.maximumRadius, p.mapDivisor, p.mapGuard),
                       "test.json");
        for (const PortRef& port : outputs) made.outputs.push_back({port, {}});
        return made;
    }
    static void facing() {
        DepthSource::normal = [](int, int) { return glm::vec3(0, 0, 1); };
    }

    static double radicalInverse(unsigned int n) {
        double result = 0, digit = 0.5;
        for (; n != 0; n /= 2, digit /= 2) result += digit * (n % 2);
        return result;
    }
    // Section 3 of the behaviour of the original, as formulas.
    static Answer replay(const Parameters& p, const glm::ivec2& size, const glm::ivec2& pixel) {
        using glm::dvec2, glm::dvec3;
        const double f = pixelsPerUnit, far = 1e15;
        const auto unproject = [&](const dvec2& at, double z) {
            return dvec3((at - dvec2(size) * 0.5) / f * z, -z);
        };
        const auto orFar = [&](float z) { return z > 0 ? double{z} : far; };
        Answer answer;
        const double z = orFar(DepthSource::depth(pixel.x, pixel.y));
        const dvec2 centre = dvec2(pixel) + 0.5;
        const dvec3 position = unproject(centre, z);
        double radius = p.radius, radiusPixels = radius * f / z;
        if (radiusPixels > p.maximumRadius) {
            radius *= p.maximumRadius / radiusPixels;
            radiusPixels = p.maximumRadius;
        }
        if (z == far || radiusPixels < 0.5) return answer;
        dvec3 normal = DepthSource::normal(pixel.x, pixel.y);
        if (glm::dot(position, normal) > 0) normal = -normal;
        const dvec3 n = -glm::normalize(position);
        constexpr int bayer[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
        const double phi = 2 * std::numbers::pi * bayer[pixel.y % 4][pixel.x % 4] / 16;
        const dvec3 b = glm::normalize(glm::cross(n, dvec3(std::sin(phi), std::cos(phi), 0))),
                    t = glm::cross(b, n);
        const dvec3 local(glm::dot(normal, t), glm::dot(normal, b), std::max(glm::dot(normal, n), 1e-4));
        const double top = (1 + p.thickness) * radius;
        double sum = 0;
        for (int i = 0; i < p.samples; ++i) {
            const double u = radicalInverse(static_cast<unsigned int>(p.samples + i)),
                         a = 2 * std::numbers::pi * i / p.samples;
            const double r = p.hbao ? 2 / std::numbers::pi * std::asin(std::pow(u, 1.25))
                                    : std::sqrt(1 - std::pow(u, 2.0 / 3));
            const dvec2 d = r * radius * dvec2(std::sin(a), std::cos(a));
            const double h = std::sqrt(radius * radius - glm::dot(d, d)), start = h,
                         end = std::clamp(-glm::dot(d, dvec2(local)) / local.z, -h, h),
                         pdf = p.hbao ? 0.9 * std::pow(1 - r, 1.5) : 2 * h;
            if ((start - end) / (2 * h) <= 0.1) continue;
            const dvec3 s0 = position + t * d.x + b * d.y;
            const dvec2 place = dvec2(size) * 0.5 + f * dvec2(s0.x, s0.y) / -s0.z;
            const auto inside = [&](const dvec2& at) {
                return at.x >= -p.guard && at.y >= -p.guard && at.x < size.x + p.guard &&
                       at.y < size.y + p.guard;
            };
            const glm::ivec2 near(glm::clamp(glm::floor(place), dvec2(-p.guard), dvec2(size + p.guard - 1)));
            if (near == pixel) {
                sum += p.hbao ? 0 : (start - end) / pdf;
                continue;
            }
            const auto value = [&](const dvec3& s) {
                const double o = glm::dot(s - position, n);
                if (!p.hbao)
                    return std::max(start - std::max(end, o), 0.0) / pdf +
                           std::clamp((o - top) / start, 0.0, 1.0) * (start - end) / pdf;
                const dvec3 v = s - position;
                const double cosine = glm::dot(normal, v) / std::sqrt(std::max(glm::dot(v, v), 1e-30));
                return std::clamp(std::clamp(cosine - 0.1, 0.0, 1.0) *
                                      std::clamp(1 - glm::dot(v, v) / (radius * radius), 0.0, 1.0) / pdf,
                                  0.0, 1.0);
            };
            const auto needed = [&](double o) {
                return o > (p.hbao ? std::max(start, 0.1 * radius) : top) &&
                       glm::length(place - centre) > p.cutoff;
            };
            const dvec2 nearCentre = dvec2(near) + 0.5;
            const dvec3 s = unproject(nearCentre, orFar(DepthSource::depth(near.x, near.y)));
            double o = glm::dot(s - position, n), v = value(s);
            if (p.dual && needed(o)) {
                const dvec3 s2 = unproject(nearCentre, orFar(DepthSource::second(near.x, near.y)));
                v = p.hbao ? std::max(v, value(s2)) : std::min(v, value(s2));
                o = std::min(o, glm::dot(s2 - position, n));
            }
            sum += v;
            const dvec2 edge(std::max(p.mapGuard, p.guard));
            const bool mapped = glm::all(glm::greaterThanEqual(place, -edge)) &&
                                glm::all(glm::lessThan(place, dvec2(size) + edge));
            if (inside(place) ? !needed(o) : !mapped) continue;
            answer.mask |= 1U << i;
            const double high = p.hbao ? std::max(start, 0.1 * radius) : top + start;
            const double stretch = glm::length(s0) / glm::length(position),
                         ceiling = inside(place) ? std::min(o, high) : high;
            const glm::ivec2 texel = glm::ivec2(glm::floor(place / double(p.mapDivisor))) +
                                     std::max(p.mapGuard, p.guard) / p.mapDivisor;
            answer.rays.push_back({texel, (glm::length(position) - ceiling) * stretch,
                                   (glm::length(position) - end) * stretch});
        }
        const double mean = p.hbao ? 1 - 2 * sum / p.samples : 2 * sum / p.samples;
        answer.visibility = std::pow(std::clamp(mean, 0.0, 1.0), p.exponent);
        return answer;
    }
};

TEST_F(FirstPass, DiscSamplesAreThoseOfTheKernels) {
    const std::vector<std::vector<float>> radii = {
        {.9179f, .5644f, .7345f, .3595f, .8200f, .4701f, .6509f, .2052f},
        {.0199f, .3239f, .1501f, .5609f, .0787f, .4306f, .2316f, .7477f}};
    facing();
    DepthSource::depth = [](int, int) { return 2.0f; };
    for (const bool hbao : {false, true})
        for (const int samples : {8, 16, 32}) {
            GivenRenderer made(graph({.hbao = hbao, .samples = samples}, {settings, visibility}), {8, 8, 1});
            made.frame();
            const auto kernel = as<shared::OcclusionKernel>(made.readBytes(settings)).at(0);
            ASSERT_EQ(kernel.samples, static_cast<std::uint32_t>(samples));
            double mean = 0;
            for (int i = 0; i < samples; ++i) {
                const glm::vec4 s = kernel.disc[i];
                const float r = glm::length(glm::vec2(s));
                if (samples == 8) {
                    EXPECT_NEAR(r, radii[hbao ? 1 : 0][static_cast<size_t>(i)], 6e-5);
                }
                EXPECT_NEAR(s.z, std::sqrt(1 - r * r), 1e-6);
                // The numbers that the radii come of.
                mean += hbao ? std::pow(std::sin(r * std::numbers::pi / 2), 0.8) : std::pow(1 - r * r, 1.5);
            }
            EXPECT_NEAR(mean / samples, 0.5, 1e-6);
        }
}

// At the middle of a picture of odd size the line of sight is the normal of a plane that faces the eye.
TEST_F(FirstPass, AFacingPlaneIsOpenAndMarksNothing) {
    facing();
    DepthSource::depth = [](int, int) { return 2.0f; };
    for (const bool hbao : {false, true}) {
        GivenRenderer made(graph({.hbao = hbao, .mapGuard = 0}, {visibility, mask}), {33, 33, 1});
        made.frame();
        EXPECT_EQ(made.read(visibility).at(16, 16), 1) << hbao;
        EXPECT_EQ(texels<std::uint8_t>(made, mask).at(16, 16), 0) << hbao;
    }
}

TEST_F(FirstPass, WhatFillsTheSphereHidesAllAndWhatIsFarInFrontNothing) {
    facing();
    const double radius = 0.5;
    struct Case {
        double height; // of all that is around the middle, in radii
        double thickness;
        float expected;
        std::uint8_t bits;
    };
    // At exactly the radius the chord is taken whole, and nothing in front of the sphere is asked for yet.
    for (const Case& c :
         {Case{1, 0, 0, 0}, Case{1.2, 0.25, 0, 0}, Case{2.01, 0, 1, 255}, Case{2.26, 0.25, 1, 255}}) {
        DepthSource::depth = [&](int x, int y) {
            return x == 16 && y == 16 ? 2.0f : static_cast<float>(2 - c.height * radius);
        };
        for (const double cutoff : {0.0, 40.0}) {
            GivenRenderer made(
                graph({.radius = radius, .thickness = c.thickness, .cutoff = cutoff}, {visibility, mask}),
                {33, 33, 1});
            made.frame();
            EXPECT_EQ(made.read(visibility).at(16, 16), c.expected) << c.height;
            EXPECT_EQ(texels<std::uint8_t>(made, mask).at(16, 16), cutoff > 0 ? 0 : c.bits) << c.height;
        }
    }
}

TEST_F(FirstPass, EqualsItsFormulasOnRandomDepths) {
    const glm::ivec2 size(40, 28);
    const int band = 8;
    // The same function of the pixel for both writings: smooth, with jumps to the front and holes.
    const auto noise = [](int x, int y, std::uint32_t salt) {
        return shared::unitFloat(shared::pixelSeed({x + 64, y + 64}, salt, 7));
    };
    DepthSource::depth = [&](int x, int y) {
        const float base = 2 + 0.1f * std::sin(0.3f * static_cast<float>(x)) + 0.3f * noise(x / 3, y / 3, 1);
        if (noise(x / 5, y / 5, 2) > 0.8f) return 1.0f + 0.2f * noise(x, y, 3);
        return noise(x / 4, y / 4, 4) > 0.9f ? 0.0f : base;
    };
    DepthSource::second = [&](int x, int y) { return DepthSource::depth(x, y) + 0.6f * noise(x, y, 5); };
    DepthSource::normal = [&](int x, int y) {
        const glm::vec3 n = glm::normalize(glm::vec3(noise(x, y, 6) - 0.5f, noise(x, y, 7) - 0.5f, 0.6f));
        return glm::vec3(glm::unpackHalf(glm::packHalf(glm::vec4(n, 0)))); // as the texture holds it
    };
    std::vector<Parameters> cases;
    for (const bool hbao : {false, true})
        for (const bool dual : {false, true})
            for (const int samples : {8, 16, 32})
                cases.push_back({.hbao = hbao,
                                 .dual = dual,
                                 .samples = samples,
                                 .guard = samples == 8 ? 0 : band,
                                 .mapDivisor = samples / 8,
                                 .exponent = dual ? 2.0 : 1.0,
                                 .thickness = dual ? 0.3 : 0.0,
                                 .cutoff = samples == 16 ? 3.0 : 0.0,
                                 .maximumRadius = dual ? 12.0 : 512.0});
    for (const Parameters& p : cases) {
        SCOPED_TRACE(fmt::format("hbao {} dual {} samples {}", p.hbao, p.dual, p.samples));
        GivenRenderer made(graph(p, {visibility, mask, rayMin, rayMax, sdMask, pixels}),
                           {static_cast<std::uint32_t>(size.x), static_cast<std::uint32_t>(size.y), 1});
        made.frame();
        const Image seen = made.read(visibility);
        const auto low = texels<std::uint32_t>(made, rayMin), high = texels<std::uint32_t>(made, rayMax);
        const auto marked = texels<std::uint8_t>(made, sdMask);
        const auto bytes = made.readBytes(mask);
        const size_t each = static_cast<size_t>(p.samples) / 8;
        int different = 0, far = 0, masked = 0;
        std::vector<std::pair<double, double>> intervals(low.values.size(), {1e9, 0});
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                const Answer expected = replay(p, size, {x, y});
                std::uint32_t bits = 0;
                std::memcpy(&bits, bytes.data() + each * static_cast<size_t>(y * size.x + x), each);
                different += bits != expected.mask ? 1 : 0;
                masked += bits != 0 ? 1 : 0;
                far += std::abs(seen.at(x, size.y - 1 - y) - expected.visibility) > 2e-3 ? 1 : 0;
                for (const Answer::Ray& ray : expected.rays) {
                    auto& [from, to] = intervals[static_cast<size_t>(ray.texel.y * low.width + ray.texel.x)];
                    from = std::min(from, ray.from);
                    to = std::max(to, ray.to);
                }
            }
        // Places that float rounding puts into the neighbouring pixel.
        EXPECT_LE(far, 12);
        EXPECT_LE(different, 12);
        EXPECT_GT(masked, 100);
        EXPECT_EQ(as<std::uint32_t>(made.readBytes(pixels)).at(0), static_cast<std::uint32_t>(masked));
        // The intervals contain those, and are wider by a texel's slack at most.
        int wrong = 0, wide = 0;
        for (size_t i = 0; i < intervals.size(); ++i) {
            const auto [from, to] = intervals[i];
            const float a = std::bit_cast<float>(low.values[i]), b = std::bit_cast<float>(high.values[i]);
            ASSERT_EQ(marked.values[i] != 0, b > 0);
            wrong += (to > 0) != (b > 0) || (to > 0 && (a > from + 1e-4 || b < to - 1e-4)) ? 1 : 0;
            wide += to > 0 && (a < from - 0.1 || b > to + 0.1) ? 1 : 0;
        }
        EXPECT_LE(wrong, 12);
        EXPECT_LE(wide, 12);
    }
}

// Pixels at the border see what lies beyond: as in a frame that is larger by a multiple of the pattern.
TEST_F(FirstPass, AGuardBandMakesBordersAsTheMiddle) {
    facing();
    const auto depth = [](int x, int y) {
        return 2 + 0.3f * std::sin(0.5f * static_cast<float>(x)) * std::cos(0.4f * static_cast<float>(y));
    };
    DepthSource::depth = depth;
    GivenRenderer small(graph({.guard = 16}, {visibility}), {24, 16, 1});
    small.frame();
    const Image inner = small.read(visibility);
    DepthSource::depth = [&](int x, int y) { return depth(x - 16, y - 16); };
    GivenRenderer large(graph({}, {visibility}), {56, 48, 1});
    large.frame();
    EXPECT_LE(difference(inner, crop(large.read(visibility), 16, 16, 24, 16)).largest, 1e-3);
    DepthSource::depth = depth;
    GivenRenderer without(graph({}, {visibility}), {24, 16, 1});
    without.frame();
    EXPECT_GT(difference(inner, without.read(visibility)).largest, 0.01);
}

TEST_F(FirstPass, NothingInViewIsOpenAndNeedsNoWork) {
    Graph graph = parseGraph(R"({"kestrel": 1, "passes": {"gbuffer": {"type": "GBuffer"},
        "first": {"type": "AmbientOcclusionFirst"}},
        "edges": [["gbuffer.view_depth", "first.view_depth"], ["gbuffer.normal", "first.normal"]],
        "outputs": ["first.visibility", "first.mask", "first.pixels", "first.ray_max"]})",
                             "test.json");
    Renderer made = renderer(graph, trianglesScene({}));
    made.frame();
    for (const float value : made.read(visibility).values) ASSERT_EQ(value, 1);
    for (const float value : made.read(mask).values) ASSERT_EQ(value, 0);
    for (const std::uint32_t word : as<std::uint32_t>(made.readBytes(pixels))) ASSERT_EQ(word, 0u);
}

TEST_F(FirstPass, DualNeedsItsDepthConnected) {
    Graph graph = parseGraph(R"({"kestrel": 1, "passes": {"gbuffer": {"type": "GBuffer"},
        "small": {"type": "GBuffer", "properties": {"divisor": 2}},
        "first": {"type": "AmbientOcclusionFirst", "properties": {"dual": true}}},
        "edges": [["gbuffer.view_depth", "first.view_depth"], ["small.normal", "first.normal"]],
        "outputs": ["first.visibility"]})",
                             "test.json");
    try {
        renderer(graph, trianglesScene(square()));
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("normal"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("`dual` needs it connected"), std::string::npos)
            << error.what();
    }
}

} // namespace
} // namespace kestrel::test
