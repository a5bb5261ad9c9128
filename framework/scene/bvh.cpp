#include "scene/bvh.h"
#include "core/check.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <future>
#include <limits>
#include <utility>

namespace kestrel {
namespace {

constexpr int maxBins = 32;
// Below this a second thread costs more than it saves.
constexpr std::size_t parallelTriangles = 8192;

struct Item {
    Box box;
    glm::vec3 centroid;
    std::uint32_t triangle;
};

// A part of the tree with node indices that count from its own root; parts are joined by adding an offset.
struct Part {
    std::vector<BvhNode> nodes;
    int depth = 0;
};

float halfArea(const Box& box) {
    if (box.empty()) return 0;
    const glm::vec3 s = box.size();
    return s.x * s.y + s.y * s.z + s.z * s.x;
}

struct Split {
    int axis = 0;
    int bin = 0; // the last bin on the left
    float cost = std::numeric_limits<float>::infinity();
};

// Where the centroids of a range fall on each axis.
class Binning {
public:
    Binning(const Box& centroids, int bins)
        : bins_(bins)
        , low_(centroids.min) {
        const glm::vec3 size = centroids.size();
        for (int axis = 0; axis < 3; ++axis) {
            const float scale = static_cast<float>(bins) / size[axis];
            scale_[axis] = size[axis] > 0 && std::isfinite(scale) ? scale : 0;
        }
    }
    [[nodiscard]] int bins() const { return bins_; }
    [[nodiscard]] bool usable(int axis) const { return scale_[axis] > 0; }
    [[nodiscard]] int bin(const glm::vec3& centroid, int axis) const {
        return std::clamp(static_cast<int>((centroid[axis] - low_[axis]) * scale_[axis]), 0, bins_ - 1);
    }

private:
    int bins_;
    glm::vec3 low_, scale_{0};
};

class Builder {
public:
    Builder(std::vector<Item>& items, const BvhSettings& settings)
        : items_(items)
        , settings_(settings) {}

    // Builds the node over [first, last) into `part` and returns its index there. Room: inner nodes that may
    // still lie on the way down, this one included.
    std::uint32_t buildNode(Part& part, std::size_t first, std::size_t last, const Box& centroids, int room,
                            int threads) {
        const auto index = static_cast<std::uint32_t>(part.nodes.size());
        part.nodes.emplace_back();
        const std::size_t middle = divide(first, last, centroids, room);
        const bool parallel = threads > 1 && last - first >= parallelTriangles;
        int below = 0;
        if (parallel) {
            Part right;
            auto other = std::async(std::launch::async,
                                    [&] { return makeChild(right, middle, last, room - 1, threads / 2); });
            Part left;
            const auto leftChild = makeChild(left, first, middle, room - 1, threads - threads / 2);
            const auto rightChild = other.get();
            part.nodes[index].children[0] = appended(part, left, leftChild);
            part.nodes[index].children[1] = appended(part, right, rightChild);
            below = std::max(left.depth, right.depth);
        } else {
            Part counted; // depth only; nodes go to `part`
            std::swap(counted.nodes, part.nodes);
            const auto leftChild = makeChild(counted, first, middle, room - 1, 1);
            const auto rightChild = makeChild(counted, middle, last, room - 1, 1);
            std::swap(counted.nodes, part.nodes);
            part.nodes[index].children[0] = leftChild;
            part.nodes[index].children[1] = rightChild;
            below = counted.depth;
        }
        part.depth = std::max(part.depth, below + 1);
        return index;
    }

private:
    BvhNode::Child makeChild(Part& part, std::size_t first, std::size_t last, int room, int threads) {
        BvhNode::Child child;
        Box box, centroids;
        for (std::size_t i = first; i < last; ++i) {
            box.add(items_[i].box);
            centroids.add(items_[i].centroid);
        }
        if (first < last) {
            child.min = box.min;
            child.max = box.max;
        }
        const std::size_t count = last - first;
        if (count <= static_cast<std::size_t>(settings_.maxLeaf)) {
            child.reference =
                shared::bvhLeaf(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count));
        } else {
            child.reference = buildNode(part, first, last, centroids, room, threads);
        }
        return child;
    }

    // Appends a part and returns its child reference as seen from the whole.
    static BvhNode::Child appended(Part& to, const Part& part, BvhNode::Child child) {
        const auto offset = static_cast<std::uint32_t>(to.nodes.size());
        const auto shifted = [offset](BvhNode::Child c) {
            if (!shared::bvhIsLeaf(c.reference)) c.reference += offset;
            return c;
        };
        for (const BvhNode& node : part.nodes)
            to.nodes.push_back({{shifted(node.children[0]), shifted(node.children[1])}});
        return shifted(child);
    }

    // Reorders [first, last) into two parts and returns where the second begins.
    std::size_t divide(std::size_t first, std::size_t last, const Box& centroids, int room) {
        const std::size_t count = last - first;
        // The root of a scene of a few triangles: one leaf, and an absent one.
        if (count <= static_cast<std::size_t>(settings_.maxLeaf)) return last;
        // What fits into one node of a wide tree needs no choice, and three quarters of all nodes lie there.
        if (count <= 4) return halve(centroids, first, last);
        // Halving needs one level for every doubling above the leaf's size.
        const std::size_t leaves = (count - 1) / static_cast<std::size_t>(settings_.maxLeaf);
        const bool roomToChoose = static_cast<int>(std::bit_width(leaves)) < room;
        if (roomToChoose) {
            const Binning binning(
                centroids, std::min(settings_.bins, static_cast<int>(std::min<std::size_t>(count, maxBins))));
            const Split split = bestSplit(binning, first, last);
            if (std::isfinite(split.cost)) {
                const auto begin = items_.begin();
                const auto middle = std::partition(
                    begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last),
                    [&](const Item& item) { return binning.bin(item.centroid, split.axis) <= split.bin; });
                return static_cast<std::size_t>(middle - begin);
            }
        }
        return halve(centroids, first, last);
    }

    std::size_t halve(const Box& centroids, std::size_t first, std::size_t last) {
        const glm::vec3 size = centroids.size();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        const std::size_t middle = first + (last - first) / 2;
        const auto at = [&](std::size_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(first), at(middle), at(last), [axis](const Item& a, const Item& b) {
            if (a.centroid[axis] != b.centroid[axis]) return a.centroid[axis] < b.centroid[axis];
            return a.triangle < b.triangle;
        });
        return middle;
    }

    // Without initial values: most nodes are small, and would pay for all bins that there could be.
    struct Bin {
        glm::vec3 min, max;
        std::uint32_t count;
    };
    using Bins = std::array<Bin, maxBins>;

    [[nodiscard]] Split bestSplit(const Binning& binning, std::size_t first, std::size_t last) const {
        std::array<Bins, 3> bins;
        const Box none;
        for (Bins& axis : bins) std::fill_n(axis.begin(), binning.bins(), Bin{none.min, none.max, 0});
        // All axes in one pass, since items come from memory.
        for (std::size_t i = first; i < last; ++i) {
            const Item& item = items_[i];
            for (int axis = 0; axis < 3; ++axis) {
                Bin& bin = bins[static_cast<std::size_t>(axis)]
                               [static_cast<std::size_t>(binning.bin(item.centroid, axis))];
                bin.min = glm::min(bin.min, item.box.min);
                bin.max = glm::max(bin.max, item.box.max);
                ++bin.count;
            }
        }
        Split best;
        for (int axis = 0; axis < 3; ++axis)
            if (binning.usable(axis))
                improve(best, axis, bins[static_cast<std::size_t>(axis)], binning.bins());
        return best;
    }

    // Sweeps over the bins of one axis from both ends; keeps the cheapest border that has triangles on both
    // sides.
    static void improve(Split& best, int axis, const Bins& bins, int count) {
        const auto last = static_cast<std::size_t>(count) - 1;
        std::array<float, maxBins> rightCost;
        std::array<std::uint32_t, maxBins> rightCount;
        Box box;
        std::uint32_t triangles = 0;
        for (std::size_t k = last; k > 0; --k) {
            box.add(Box{bins[k].min, bins[k].max});
            triangles += bins[k].count;
            rightCost[k - 1] = cost(box, triangles);
            rightCount[k - 1] = triangles;
        }
        box = {};
        triangles = 0;
        for (std::size_t k = 0; k < last; ++k) {
            box.add(Box{bins[k].min, bins[k].max});
            triangles += bins[k].count;
            const float total = cost(box, triangles) + rightCost[k];
            if (triangles > 0 && rightCount[k] > 0 && total < best.cost)
                best = {axis, static_cast<int>(k), total};
        }
    }

    static float cost(const Box& box, std::uint32_t count) {
        return halfArea(box) * static_cast<float>(count);
    }

    std::vector<Item>& items_;
    const BvhSettings& settings_;
};

std::vector<Item> itemsOf(const Geometry& geometry) {
    std::vector<Item> items(geometry.triangleCount());
    for (std::uint32_t i = 0; i < geometry.triangleCount(); ++i) {
        Item& item = items[i];
        for (std::uint32_t k = 0; k < 3; ++k) item.box.add(geometry.positions[geometry.indices[3 * i + k]]);
        // Half of each corner, since the sum of two huge coordinates could overflow.
        item.centroid = 0.5f * item.box.min + 0.5f * item.box.max;
        item.triangle = i;
    }
    return items;
}

std::vector<std::uint32_t> classesOf(const Geometry& geometry) {
    std::vector<std::uint32_t> classes(geometry.triangleCount(), 0);
    for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(TriangleClass::Count); ++c) {
        const Geometry::Range range = geometry.ranges[c];
        std::fill_n(classes.begin() + range.first, range.count, c);
    }
    return classes;
}

} // namespace

Bvh buildBvh(const Geometry& geometry, const BvhSettings& settings) {
    KESTREL_CHECK(settings.maxLeaf >= 1 && settings.maxLeaf <= static_cast<int>(shared::bvhMaxLeaf));
    KESTREL_CHECK(settings.bins >= 2 && settings.bins <= maxBins);
    std::vector<Item> items = itemsOf(geometry);
    Part part;
    part.nodes.reserve(items.size() / 2 + 1);
    Box centroids;
    for (const Item& item : items) centroids.add(item.centroid);
    Builder(items, settings)
        .buildNode(part, 0, items.size(), centroids, static_cast<int>(shared::bvhStackSize),
                   settings.threads);
    KESTREL_CHECK_LE(part.depth, static_cast<int>(shared::bvhStackSize));

    const std::vector<std::uint32_t> classes = classesOf(geometry);
    Bvh bvh{std::move(part.nodes), {}, part.depth};
    bvh.triangles.reserve(items.size());
    for (const Item& item : items) {
        const std::uint32_t* corner = &geometry.indices[3 * static_cast<std::size_t>(item.triangle)];
        bvh.triangles.push_back({geometry.positions[corner[0]], item.triangle, geometry.positions[corner[1]],
                                 geometry.materials[item.triangle], geometry.positions[corner[2]],
                                 classes[item.triangle]});
    }
    return bvh;
}

} // namespace kestrel
