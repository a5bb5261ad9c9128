// Which depths a ray's collection keeps, on hits that a test lists: exactly where it is determined, by
// statistics where it is random.
#include "core/files.h"
#include "depth_source.h"
#include "shared/stochastic_depth.h"
#include "support/gltf_builder.h"
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <set>

namespace kestrel::test {
namespace {

// Hits at the distances 1 to `count` along every ray, in an order that is the same for all rays or random for
// each.
struct ListedHits final : Pass {
    static PassType type() {
        return Describe<ListedHits>("ListedHits", "Hits of a test")
            .output("hits", PortKind::Hits, "At whole distances")
            .number("count", &ListedHits::count, 1, 64, "", "Hits")
            .flag("shuffled", &ListedHits::shuffled, "Another order for each ray");
    }
    static constexpr const char* text = R"(#include "lib/tracer.glsl"
        #include "shared/random.h"
        void M(all)(Ray ray) {
            int order[COUNT];
            for (int i = 0; i < COUNT; ++i) order[i] = (7 * i + 3) % COUNT;
        #ifdef SHUFFLED
            uint seed = hashCombine(floatBitsToUint(ray.direction.x), floatBitsToUint(ray.direction.y));
            for (int i = COUNT - 1; i > 0; --i) {
                int j = int(unitFloat(hashCombine(seed, uint(i))) * float(i + 1));
                int other = order[j];
                order[j] = order[i];
                order[i] = other;
            }
        #endif
            for (int i = 0; i < COUNT; ++i) {
                float t = float(order[i] + 1);
                if (t >= ray.tMin && t <= ray.tMax && M(visit)(ray, Hit(t, 0.0, 0u, uvec2(0u)))) return;
            }
        })";
    [[nodiscard]] Declaration declare(const World&, const Inputs&, const Demand&) const override {
        Declaration declaration;
        declaration.outputs = {{.port = "hits", .desc = Desc::module(0)}};
        Module hits{.port = "hits", .shader = "listed_hits.glsl"};
        hits.defines.emplace("COUNT", std::to_string(count));
        if (shuffled) hits.defines.emplace("SHUFFLED", "1");
        declaration.modules = {hits};
        return declaration;
    }
    int count = 10;
    bool shuffled = false;
};

// Asks for every texel, between two distances.
struct GivenMask final : Pass {
    static PassType type() {
        return Describe<GivenMask>("GivenMask", "A mask of a test")
            .output("sd_mask", PortKind::Texture, "1")
            .output("ray_min", PortKind::Texture, "From")
            .output("ray_max", PortKind::Texture, "To")
            .number("from", &GivenMask::from, 0, 100, "", "Distance")
            .number("to", &GivenMask::to, 0, 100, "", "Distance");
    }
    [[nodiscard]] Declaration declare(const World& world, const Inputs&,
                                      const Demand& demand) const override {
        Declaration declaration;
        const auto output = [&](const char* port, Format format, float value) {
            if (!demand.reads(port)) return;
            declaration.outputs.push_back({.port = port, .desc = Desc::texture2D(format, world.size)});
            declaration.outputs.back().constant = glm::vec4(value);
        };
        // Bits of whole and half numbers are whole multiples of 2^16: exact as floats.
        output("sd_mask", Format::R8UI, 1);
        output("ray_min", Format::R32UI, static_cast<float>(std::bit_cast<std::uint32_t>(from)));
        output("ray_max", Format::R32UI, static_cast<float>(std::bit_cast<std::uint32_t>(to)));
        return declaration;
    }
    float from = 0, to = 64;
};

struct RayMap : DepthTest {
    static const Registry& mapRegistry() {
        static const TemporaryFolder folder;
        static const Registry instance = [] {
            Registry made = registry();
            made.add(ListedHits::type());
            made.add(GivenMask::type());
            writeFile(folder / "listed_hits.glsl", ListedHits::text);
            made.shaderFolders.push_back((folder / "listed_hits.glsl").parent_path());
            return made;
        }();
        return instance;
    }
    // Distances that each texel keeps, 0 where a slot is empty; texels row by row from the lower left.
    static std::vector<std::vector<float>> kept(int slots, const std::vector<std::string>& settings,
                                                const Extent& size = {16, 12, 1}) {
        Graph graph = parseGraph(R"({"kestrel": 1, "passes": {
            "source": {"type": "DepthSource"}, "listed": {"type": "ListedHits"}, "mask": {"type": "GivenMask"},
            "map": {"type": "StochasticDepthRay", "properties": {"max_count": 0}}},
            "edges": [["source.view_depth", "map.view_depth"], ["listed.hits", "map.hits"],
                ["mask.sd_mask", "map.sd_mask"], ["mask.ray_min", "map.ray_min"], ["mask.ray_max", "map.ray_max"]],
            "outputs": ["map.depths"]})",
                                 "test.json");
        applySetting(graph, mapRegistry(), fmt::format("map.layers_per_texel={}", slots));
        for (const std::string& setting : settings) applySetting(graph, mapRegistry(), setting);
        RenderOptions options;
        options.size = size;
        Renderer made(graph, mapRegistry(), trianglesScene(square()), context().capabilities(), options);
        made.setFreeCamera(straightCamera(size));
        made.frame();
        const int width = static_cast<int>(size.width), height = static_cast<int>(size.height);
        std::vector<std::vector<float>> all;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const glm::vec2 way =
                    (glm::vec2(x, y) + 0.5f - 0.5f * glm::vec2(width, height)) / pixelsPerUnit;
                all.emplace_back();
                for (int slot = 0; slot < slots; ++slot) {
                    static std::map<int, Image> images;
                    if (all.size() == 1 && slot % 4 == 0)
                        images[slot / 4] = made.read({"map", "depths"}, slot / 4);
                    const float depth = images[slot / 4].at(x, height - 1 - y, slot % 4);
                    all.back().push_back(depth < 1e38f ? depth * std::sqrt(1 + glm::dot(way, way)) : 0);
                }
            }
        return all;
    }
    // How many texels keep each of the distances 1 to `count`.
    static std::vector<double> histogram(const std::vector<std::vector<float>>& texels, int count) {
        std::vector<double> seen(static_cast<size_t>(count), 0.0);
        for (const auto& slots : texels)
            for (const float t : slots)
                if (t > 0) seen.at(static_cast<size_t>(std::lround(t)) - 1) += 1;
        return seen;
    }
    void SetUp() override {
        DepthTest::SetUp();
        DepthSource::depth = [](int, int) { return 0.2f; }; // nearer than 1 along every ray
    }
};

// One point in each row and column of the 16 x 16 grid; of each row of texels one in every quarter of their
// height, of each column one in every quarter of their width.
TEST(StochasticDepthNumbers, JitterSpreadsAlongRowsAndColumns) {
    std::set<int> right, up;
    for (int i = 0; i < 4; ++i) {
        std::set<int> quarters[2];
        for (int k = 0; k < 4; ++k) {
            const glm::vec2 point = shared::sobolJitter({i, k});
            right.insert(static_cast<int>(point.x * 16));
            up.insert(static_cast<int>(point.y * 16));
            quarters[0].insert(static_cast<int>(point.x * 4));
            quarters[1].insert(static_cast<int>(shared::sobolJitter({k, i}).y * 4));
        }
        EXPECT_EQ(quarters[0].size(), 4u) << i;
        EXPECT_EQ(quarters[1].size(), 4u) << i;
    }
    EXPECT_EQ(right.size(), 16u);
    EXPECT_EQ(up.size(), 16u);
}

TEST(StochasticDepthNumbers, MasksAreSortedByTheirBits) {
    const std::array<unsigned int, 9> first = {0, 1, 9, 37, 93, 163, 219, 247, 255};
    for (unsigned int bits = 0; bits < first.size(); ++bits)
        EXPECT_EQ(shared::firstMask(8, bits), first[bits]);
    for (const unsigned int slots : {1u, 2u, 4u, 8u}) {
        std::set<unsigned int> seen;
        for (unsigned int bits = 0; bits <= slots; ++bits) {
            unsigned int before = 0;
            for (unsigned int i = 0; i < shared::binomial(slots, bits); ++i) {
                const unsigned int mask = shared::maskAt(slots, bits, i);
                EXPECT_EQ(static_cast<unsigned int>(std::popcount(mask)), bits);
                EXPECT_TRUE(i == 0 || mask > before);
                before = mask;
                seen.insert(mask);
            }
        }
        EXPECT_EQ(seen.size(), size_t{1} << slots);
    }
}

TEST(StochasticDepthNumbers, JitterTakesEachRowAndColumnOnce) {
    std::set<int> rows, columns;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) {
            const glm::vec2 at = shared::sobolJitter({x, y});
            columns.insert(static_cast<int>(at.x * 16));
            rows.insert(static_cast<int>(at.y * 16));
            EXPECT_EQ(at, shared::sobolJitter({x - 8, y + 4}));
        }
    EXPECT_EQ(rows.size(), 16u);
    EXPECT_EQ(columns.size(), 16u);
}

TEST_F(RayMap, AKBufferHoldsExactlyTheNextLayers) {
    for (const int slots : {1, 2, 4, 8})
        for (const char* order : {"listed.shuffled=false", "listed.shuffled=true"})
            for (const float first : {0.5f, 2.5f, 5.5f}) {
                DepthSource::depth = [first](int, int) { return first; };
                for (const auto& texel : kept(slots, {"map.collection=k_buffer", order}))
                    for (int i = 0; i < slots; ++i) {
                        // Ten layers; those before the first surface do not count.
                        const float expected = std::ceil(first) + static_cast<float>(i);
                        ASSERT_NEAR(texel[static_cast<size_t>(i)], expected <= 10 ? expected : 0, 1e-5);
                    }
            }
}

TEST_F(RayMap, TheIntervalBoundsWhatIsSeen) {
    const auto seen = histogram(kept(8, {"map.collection=k_buffer", "mask.from=3.5", "mask.to=6.5"}), 10);
    for (size_t i = 0; i < 10; ++i) EXPECT_EQ(seen[i], i >= 3 && i <= 5 ? 192 : 0) << i;
    const auto all = histogram(
        kept(8, {"map.collection=k_buffer", "mask.from=3.5", "mask.to=6.5", "map.interval=false"}), 10);
    for (size_t i = 0; i < 8; ++i) EXPECT_EQ(all[i], 192) << i;
}

// Without a mask every texel is traced, whether an interval is asked for or not.
TEST_F(RayMap, WithoutAMaskItIsTheMapOfAMaskThatIsFull) {
    const std::vector<std::string> cut = {"map.sd_mask=", "map.ray_min=", "map.ray_max="};
    for (const char* collection : {"reservoir", "k_buffer"}) {
        std::vector<std::string> settings = {fmt::format("map.collection={}", collection),
                                             "map.interval=false", "map.jitter=false"};
        const auto masked = kept(4, settings);
        settings.insert(settings.end(), cut.begin(), cut.end());
        settings.emplace_back("map.divisor=1");
        const auto whole = kept(4, settings);
        settings.emplace_back("map.interval=true");
        EXPECT_EQ(masked, whole) << collection;
        EXPECT_EQ(masked, kept(4, settings)) << collection;
    }
}

TEST_F(RayMap, HalfAMaskIsAMistake) {
    for (const char* left : {"map.ray_min=", "map.ray_max="})
        EXPECT_THROW(kept(4, {left}), InputError) << left;
    EXPECT_THROW(kept(4, {"map.interval=false", "map.sd_mask="}), InputError);
}

TEST_F(RayMap, AReservoirWithoutCullingIsUniform) {
    const Extent size{64, 64, 1};
    for (const int slots : {1, 2, 4, 8}) {
        const auto seen = histogram(kept(slots, {"map.z_cull=false"}, size), 10);
        // Of so many draws without replacement the sum of squares, scaled by (n - 1) / n, has 9 degrees of
        // freedom: 33.7 is exceeded once in ten thousand; four tests.
        const double share = slots / 10.0, draws = 64 * 64;
        double chi = 0;
        for (const double n : seen) chi += std::pow(n - draws * share, 2) / (draws * share * (1 - share));
        EXPECT_LE(chi * 0.9, 33.7) << slots;
    }
}

// Listing 1 of the paper, line by line.
TEST_F(RayMap, TheReservoirEqualsItsListing) {
    const Extent size{16, 12, 1};
    for (const std::uint32_t slots : {1u, 2u, 4u, 8u})
        for (const std::uint32_t maxCount : {4u, 8u, 16u}) {
            const auto texels = kept(static_cast<int>(slots),
                                     {"map.z_cull=true", fmt::format("map.max_count={}", maxCount)}, size);
            for (std::uint32_t y = 0; y < size.height; ++y)
                for (std::uint32_t x = 0; x < size.width; ++x) {
                    const std::uint32_t seed = shared::pixelSeed({x, y}, shared::randomStochasticDepth, 0);
                    std::vector<float> depths(slots, 1e30f);
                    std::uint32_t count = 0;
                    float farEnd = 64;
                    for (int i = 0; i < 10; ++i) {
                        const auto t = static_cast<float>((7 * i + 3) % 10 + 1);
                        if (t > farEnd) continue;
                        std::uint32_t slot = count;
                        count += 1;
                        if (count > slots)
                            slot = static_cast<std::uint32_t>(
                                shared::unitFloat(shared::hashCombine(seed, count)) *
                                static_cast<float>(count));
                        if (slot < slots && t < depths[slot]) depths[slot] = t;
                        if (count >= maxCount) farEnd = t;
                    }
                    for (std::uint32_t i = 0; i < slots; ++i)
                        ASSERT_NEAR(texels[y * size.width + x][i], depths[i] < 1e30f ? depths[i] : 0, 1e-5)
                            << x << " " << y << " slots " << slots << " of " << maxCount;
                }
        }
}

// Three layers in random order, one slot, every hit shortens the ray. The orders that begin with layer 1 keep
// it; those that begin with 2 keep 1 or 2 alike; 3 1 2 keeps 1 or 3 alike, and 3 2 1 keeps each alike.
TEST_F(RayMap, TheBiasOfAShortenedRayIsTheClosedForm) {
    const Extent size{192, 192, 1};
    const auto seen =
        histogram(kept(1, {"map.max_count=1", "listed.count=3", "listed.shuffled=true"}, size), 3);
    const double rays = size.width * size.height, shares[] = {23.0 / 36, 8.0 / 36, 5.0 / 36};
    for (size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(seen[i] / rays, shares[i], 4 * std::sqrt(shares[i] * (1 - shares[i]) / rays)) << i;
}

// Of the masks of one and of two bits each slot has three eighths: a slot keeps the nearest of those that it
// is offered.
TEST_F(RayMap, CoverageMasksKeepTheNearestOfARandomSubset) {
    const Extent size{64, 64, 1};
    const auto texels = kept(4, {"map.collection=coverage_mask", "listed.shuffled=true"}, size);
    const auto seen = histogram(texels, 10);
    double chance = 3.0 / 8;
    for (size_t i = 0; i < 10; ++i) {
        const double slots = 4.0 * 64 * 64;
        EXPECT_NEAR(seen[i] / slots, chance, 5 * std::sqrt(chance * (1 - chance) / slots)) << i;
        chance *= 5.0 / 8;
    }
}

} // namespace
} // namespace kestrel::test
