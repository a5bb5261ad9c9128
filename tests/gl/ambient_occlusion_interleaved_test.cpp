// Horizon-based ambient occlusion on deinterleaved depths: to the bit what the plain form gives, and against
// a second writing of its formulas, in double precision on the CPU.
#include "depth_source.h"
#include "shared/random.h"
#include <cmath>
#include <numbers>

namespace kestrel::test {
namespace {

struct Interleaved : DepthTest {
    static Image seen(const Extent& size, int guard, const std::vector<std::string>& settings = {}) {
        Graph graph = parseGraph(fmt::format(R"({{"kestrel": 1, "passes": {{
            "source": {{"type": "DepthSource", "properties": {{"guard": {}}}}},
            "hbao": {{"type": "HbaoInterleaved", "properties": {{"radius": 0.5}}}}}},
            "edges": [["source.view_depth", "hbao.view_depth"], ["source.normal", "hbao.normal"]],
            "outputs": ["hbao.visibility"]}})",
                                             guard),
                                 "test.json");
        for (const std::string& setting : settings) applySetting(graph, registry(), setting);
        GivenRenderer made(graph, size);
        made.frame();
        return made.read({"hbao", "visibility"});
    }
    static float noise(int x, int y, std::uint32_t salt) {
        return shared::unitFloat(shared::pixelSeed({x + 64, y + 64}, salt, 7));
    }
    // Smooth, with jumps to the front and holes.
    static void random() {
        DepthSource::depth = [](int x, int y) {
            const float base =
                2 + 0.1f * std::sin(0.3f * static_cast<float>(x)) + 0.3f * noise(x / 3, y / 3, 1);
            if (noise(x / 5, y / 5, 2) > 0.8f) return 1.7f + 0.2f * noise(x, y, 3);
            return noise(x / 4, y / 4, 4) > 0.9f ? 0.0f : base;
        };
        DepthSource::normal = [](int x, int y) {
            const glm::vec3 n = glm::normalize(glm::vec3(noise(x, y, 6) - 0.5f, noise(x, y, 7) - 0.5f, 0.6f));
            return glm::vec3(glm::unpackHalf(glm::packHalf(glm::vec4(n, 0)))); // as the texture holds it
        };
    }
};

TEST_F(Interleaved, EqualsThePlainFormToTheBit) {
    random();
    for (const Extent& size : {Extent{40, 28, 1}, Extent{43, 29, 1}})
        for (const int guard : {0, 6, 8}) {
            const Image plain = seen(size, guard, {"hbao.deinterleaved=false"}), split = seen(size, guard);
            EXPECT_EQ(plain, split) << guard;
            const auto [least, most] = std::minmax_element(plain.values.begin(), plain.values.end());
            EXPECT_LT(*least, 0.7f);
            EXPECT_EQ(*most, 1.0f);
        }
}

TEST_F(Interleaved, AFacingPlaneAndNothingAreOpen) {
    DepthSource::normal = [](int, int) { return glm::vec3(0, 0, 1); };
    DepthSource::depth = [](int x, int) { return x < 20 ? 2.0f : 0.0f; };
    for (const float value : seen({40, 28, 1}, 0).values) ASSERT_EQ(value, 1.0f);
}

TEST_F(Interleaved, EqualsItsFormulasOnRandomDepths) {
    using glm::dvec2, glm::dvec3;
    random();
    const glm::ivec2 size(40, 28);
    const int guard = 8, directions = 6, steps = 3;
    const double radius = 0.5, bias = 0.2, exponent = 1.5, maximum = 20;
    const Image image = seen({40, 28, 1}, guard,
                             {"hbao.directions=6", "hbao.steps=3", "hbao.bias=0.2", "hbao.exponent=1.5",
                              "hbao.maximum_radius=20"});
    const auto reversed = [](int four) {
        return (four & 1) << 3 | (four & 2) << 1 | (four & 4) >> 1 | four >> 3;
    };
    int far = 0, occluded = 0;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const auto at = [&](int px, int py, double z) {
                return dvec3((dvec2(px + 0.5, py + 0.5) - dvec2(size) * 0.5) / double{pixelsPerUnit} * z, -z);
            };
            const double z = double{DepthSource::depth(x, y)};
            double expected = 1;
            if (z > 0) {
                const dvec3 p = at(x, y, z), given = dvec3(DepthSource::normal(x, y)),
                            n = glm::dot(given, p) > 0 ? -given : given;
                const double pixels = std::min(radius * double{pixelsPerUnit} / z, maximum),
                             reach = pixels * z / double{pixelsPerUnit};
                const int ox = x & 3, oy = y & 3;
                const double turn = (reversed((ox ^ oy) | oy << 2) + 0.5) / 16,
                             start = (reversed((ox ^ oy ^ 1) << 2 | ox) + 0.5) / 16;
                double sum = 0;
                for (int i = 0; i < directions; ++i)
                    for (int k = 0; k < steps; ++k) {
                        const double angle = 2 * std::numbers::pi * (i + turn) / directions;
                        const double length = 1 + pixels / 4 / (steps + 1) * (k + start);
                        const int tx = x + 4 * static_cast<int>(std::round(length * std::cos(angle))),
                                  ty = y + 4 * static_cast<int>(std::round(length * std::sin(angle)));
                        if (tx < -guard || ty < -guard || tx >= size.x + guard || ty >= size.y + guard)
                            continue;
                        const double there = double{DepthSource::depth(tx, ty)};
                        if (there == 0) continue;
                        const dvec3 v = at(tx, ty, there) - p;
                        sum += std::clamp(glm::dot(n, v) / glm::length(v) - bias, 0.0, 1.0) *
                               std::clamp(1 - glm::dot(v, v) / (reach * reach), 0.0, 1.0);
                    }
                expected = std::pow(std::clamp(1 - 2 * sum / (directions * steps), 0.0, 1.0), exponent);
            }
            occluded += expected < 0.9 ? 1 : 0;
            far += std::abs(image.at(x, size.y - 1 - y) - expected) > 2e-3 ? 1 : 0;
        }
    EXPECT_GT(occluded, 100);
    // Offsets that float rounding puts onto the neighbouring pixel.
    EXPECT_LE(far, 12);
}

} // namespace
} // namespace kestrel::test
