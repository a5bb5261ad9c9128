// What the tests of the A-buffer's construction share: its lists, walked as a reader walks them.
#pragma once
#include "shared/abuffer.h"
#include "shipped_fixture.h"
#include <bit>

namespace kestrel::test {

using Structure = FragmentLists::Structure;

struct Fragment {
    float depth = 0;
    std::uint32_t triangle = 0;
    std::uint32_t plane = 0; // where lists keep planes
    friend bool operator==(const Fragment&, const Fragment&) = default;
};
using Lists = std::vector<std::vector<Fragment>>; // by pixel of all views

// What the buffers hold, walked as a reader walks them; linked lists are walked both ways where they can be.
class ReadLists {
public:
    ReadLists(Renderer& made, const std::string& reorder)
        : pixels_(as<std::uint32_t>(made.readBytes({reorder, "pixels"})))
        , nodes_(as<std::uint32_t>(made.readBytes({reorder, "nodes"})))
        , data_(as<std::uint32_t>(made.readBytes({reorder, "triangles"})))
        , lists_(made.desc({reorder, "nodes"}).lists) {}

    [[nodiscard]] Lists all(size_t count) const {
        Lists result(count);
        for (size_t i = 0; i < count; ++i) result[i] = list(i);
        return result;
    }

private:
    [[nodiscard]] bool linkedBack() const {
        return lists_.structure == Structure::DLL || lists_.structure == Structure::DLLB;
    }
    [[nodiscard]] bool bucketed() const {
        return lists_.structure == Structure::LLB || lists_.structure == Structure::DLLB;
    }
    [[nodiscard]] size_t planes() const { return lists_.planes ? 1 : 0; }
    [[nodiscard]] std::uint32_t word(std::uint32_t node, size_t word) const {
        const size_t words = (linkedBack() ? 3 : 2) + planes() +
                             (lists_.decoupled || lists_.structure == Structure::SB ? 0 : 1);
        return nodes_.at((node - 1) * words + word);
    }
    [[nodiscard]] Fragment fragment(std::uint32_t node) const {
        const size_t own = linkedBack() ? 3 : 2;
        const std::uint32_t link = lists_.structure == Structure::SB ? word(node, 1) : node;
        const std::uint32_t triangle = lists_.decoupled                    ? data_.at(link - 1)
                                       : lists_.structure == Structure::SB ? link
                                                                           : word(node, own + planes());
        return {std::bit_cast<float>(word(node, 0)), triangle, lists_.planes ? word(node, own) : 0};
    }
    [[nodiscard]] std::vector<Fragment> list(size_t pixel) const {
        std::vector<Fragment> result;
        const auto buckets = static_cast<size_t>(lists_.buckets);
        if (lists_.structure == Structure::SB) {
            const size_t at = pixel * (2 + planes());
            for (std::uint32_t i = 0; i < pixels_.at(at + 1); ++i)
                result.push_back(fragment(pixels_.at(at) + i));
            return result;
        }
        const size_t words =
            (bucketed() ? 2 + buckets * (linkedBack() ? 2 : 1) : (linkedBack() ? 2 : 1)) + planes();
        const float zMin = bucketed() ? std::bit_cast<float>(pixels_.at(pixel * words)) : 0;
        std::vector<size_t> bucketOf;
        const float zMax = bucketed() ? std::bit_cast<float>(pixels_.at(pixel * words + 1)) : 0;
        for (size_t bucket = 0; bucket < buckets; ++bucket) {
            const size_t head = pixel * words + (bucketed() ? 2 : 0) + bucket;
            std::uint32_t previous = 0;
            for (std::uint32_t node = pixels_.at(head); node != 0; node = word(node, 1)) {
                result.push_back(fragment(node));
                if (linkedBack()) {
                    EXPECT_EQ(word(node, 2), previous) << pixel;
                }
                bucketOf.push_back(bucket);
                if (bucketed()) {
                    if (!lists_.shifted) {
                        EXPECT_EQ(shared::abufferBucket(result.back().depth, zMin, zMax, lists_.buckets),
                                  bucket);
                    }
                    EXPECT_GE(result.back().depth, zMin);
                    EXPECT_LE(result.back().depth, zMax);
                }
                previous = node;
            }
            if (linkedBack()) {
                EXPECT_EQ(pixels_.at(head + buckets), previous) << pixel;
            }
        }
        for (size_t i = 0; lists_.shifted && i < result.size(); ++i)
            EXPECT_EQ(shared::abufferShiftedBucket(static_cast<std::uint32_t>(i),
                                                   static_cast<std::uint32_t>(result.size()),
                                                   static_cast<std::uint32_t>(lists_.buckets)),
                      bucketOf[i])
                << pixel;
        return result;
    }

    std::vector<std::uint32_t> pixels_, nodes_, data_;
    FragmentLists lists_;
};

struct ABufferLists : ShippedTest {
    static constexpr Extent size{48, 27, 1};
    static constexpr int side = 24;
    static constexpr float nearPlane = 0.01f;
    static constexpr size_t mainPixels = 48 * 27, pixels = mainPixels + 6 * 24 * 24;

    static Lists made(const Scene& scene, std::vector<std::string> settings, int frames = 1) {
        settings.insert(settings.begin(), {fmt::format("depth_bounds.side={}", side),
                                           fmt::format("depth_bounds.near={}", nearPlane)});
        Graph graph = shippedGraph("abuffer_ao", settings);
        graph.outputs = {
            {{"reorder", "pixels"}, {}}, {{"reorder", "nodes"}, {}}, {{"reorder", "triangles"}, {}}};
        RenderOptions options;
        options.countIterations = true;
        Renderer renderer = ABufferLists::renderer(graph, scene, options, size);
        for (int i = 0; i < frames; ++i) renderer.frame();
        return ReadLists(renderer, "reorder").all(pixels);
    }
};

// Fragments and hits of one pixel that belong together: the same triangle, or another at the same depth (an
// edge that one side of the comparison gives to a neighbour).
inline size_t unmatched(const std::vector<Fragment>& list, const std::vector<Fragment>& hits,
                        float tolerance) {
    std::vector<bool> taken(hits.size(), false);
    size_t lost = 0;
    for (const Fragment& fragment : list) {
        size_t best = hits.size();
        for (size_t i = 0; i < hits.size(); ++i) {
            if (taken[i] || std::abs(hits[i].depth - fragment.depth) > tolerance * fragment.depth) continue;
            if (best == hits.size() || hits[i].triangle == fragment.triangle) best = i;
        }
        if (best == hits.size())
            ++lost;
        else
            taken[best] = true;
    }
    return lost + static_cast<size_t>(std::count(taken.begin(), taken.end(), false));
}

} // namespace kestrel::test
