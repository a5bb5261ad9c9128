#include "scene/wide_bvh.h"
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

using Child = BvhNode::Child;

// By how many steps a plane lies outside of what it bounds, at least (shared/wide_bvh.h: wideMet()).
constexpr double margin = 1.0 / 256;
constexpr double mostSteps = 255;

// The planes of up to four boxes along one axis.
struct Planes {
    float origin = 0;
    std::uint32_t exponent = 1; // biased, as in a float
    std::uint32_t low = 0, high = 0;
};

bool absent(const Child& child) {
    return shared::bvhIsLeaf(child.reference) && shared::bvhLeafCount(child.reference) == 0;
}

// By bits, since std::frexp() and std::ldexp() took a third of the time.
double powerOfTwo(int exponent) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}
int exponentAbove(double x) { return static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52) - 1022; }

Planes quantized(const Child* children, int count, int axis) {
    double low = children[0].min[axis], high = children[0].max[axis];
    for (int i = 1; i < count; ++i) {
        low = std::min<double>(low, children[i].min[axis]);
        high = std::max<double>(high, children[i].max[axis]);
    }
    Planes planes;
    // The smallest power of two that leaves room for the margins, which may be an ulp of the origin.
    int exponent = high > low ? exponentAbove((high - low) / (mostSteps - 1)) : -125;
    double step = 0, steps = 0; // and how many go into 1
    for (exponent = std::clamp(exponent, -125, 127);; ++exponent) {
        step = powerOfTwo(exponent);
        steps = powerOfTwo(-exponent);
        planes.origin = static_cast<float>(low - 2 * margin * step);
        if (planes.origin > low - 1.5 * margin * step)
            planes.origin = std::nextafter(planes.origin, -std::numeric_limits<float>::infinity());
        if ((high - planes.origin) * steps + margin < mostSteps) break;
    }
    planes.exponent = static_cast<std::uint32_t>(exponent + 127);
    for (int i = 0; i < count; ++i) {
        const auto at = [&](float x) { return (static_cast<double>(x) - planes.origin) * steps; };
        const auto low8 =
            static_cast<std::uint32_t>(at(children[i].min[axis]) - margin); // down, since it is positive
        const auto high8 = static_cast<std::uint32_t>(at(children[i].max[axis]) + margin) + 1u;
        planes.low |= low8 << (8 * i);
        planes.high |= high8 << (8 * i);
    }
    return planes;
}

// A node over up to four children.
WideItem innerItem(const Child* children, std::size_t count, std::uint32_t first) {
    WideItem item{};
    item.texels[0].w = shared::wideNode;
    item.texels[1].w = shared::wideTexels * first;
    item.texels[2].w = (1u << count) - 1u;
    if (count == 0) return item;
    for (int axis = 0; axis < 3; ++axis) {
        const Planes planes = quantized(children, static_cast<int>(count), axis);
        item.texels[0][axis] = std::bit_cast<std::uint32_t>(planes.origin);
        item.texels[0].w |= planes.exponent << (8 * axis);
        item.texels[1][axis] = planes.low;
        item.texels[2][axis] = planes.high;
    }
    return item;
}

bool isNode(const WideItem& item) { return (item.texels[0].w & shared::wideNode) != 0; }
std::uint32_t firstChild(const WideItem& node) { return node.texels[1].w / shared::wideTexels; }
std::uint32_t childCount(const WideItem& node) {
    return static_cast<std::uint32_t>(std::popcount(node.texels[2].w & 15u));
}

float halfArea(const Child& child) {
    const glm::vec3 s = child.max - child.min;
    return s.x * s.y + s.y * s.z + s.z * s.x;
}

// What the levels below a node of the binary tree are made into, from the bottom up: by the fewest visits
// that the surface area heuristic expects (Ylitie, Karras and Laine 2017, section 3.1, with leaves of one
// triangle).
struct Below {
    float cost[5] = {}; // of the whole as 1 to 4 children of one node; [0] unused
    // How many of them come of the left child; 0: it is a child itself. [0]: where it is a node, of four.
    std::uint8_t left[5] = {};
    float area = 0; // of all triangles, twice
    std::uint32_t triangles = 0;
};

class Widener {
public:
    explicit Widener(const Bvh& binary)
        : binary_(binary)
        , below_(binary.nodes.size()) {}

    WideBvh operator()() {
        // What lies below the root's second child comes behind what lies below the first.
        const auto weighed = [this](std::size_t first, std::size_t end) {
            while (end-- > first) weigh(end);
        };
        const std::uint32_t second = binary_.nodes[0].children[1].reference;
        const std::size_t middle = shared::bvhIsLeaf(second) ? below_.size() : second;
        auto other = std::async(policy(), weighed, middle, below_.size());
        weighed(1, middle);
        other.get();
        weigh(0);
        WideBvh wide;
        wide.items.reserve(binary_.triangles.size() + binary_.nodes.size() / 2 + 1);
        wide.items.emplace_back();
        node(wide, 0, 0, 1);
        return wide;
    }

private:
    struct Found {
        Child child;
        float size; // of its triangles, in the mean
    };

    // Of an inner node what is known, of a leaf what is made here.
    const Below& below(const Child& child, Below& leaf) const {
        if (!shared::bvhIsLeaf(child.reference)) return below_[child.reference];
        if (absent(child)) return leaf;
        std::fill(std::begin(leaf.cost), std::end(leaf.cost), halfArea(child));
        const BvhTriangle& t = binary_.triangles[shared::bvhLeafFirst(child.reference)];
        leaf.area = glm::length(glm::cross(t.p1 - t.p0, t.p2 - t.p0));
        leaf.triangles = 1;
        return leaf;
    }

    void weigh(std::size_t index) {
        const auto& children = binary_.nodes[index].children;
        Below leaves[2];
        const Below& left = below(children[0], leaves[0]);
        const Below& right = below(children[1], leaves[1]);
        Below& whole = below_[index];
        for (std::size_t count = 2; count <= 4; ++count) {
            whole.cost[count] = std::numeric_limits<float>::infinity();
            for (std::size_t k = 1; k < count; ++k) {
                const float cost = left.cost[k] + right.cost[count - k];
                if (whole.left[count] != 0 && !(cost < whole.cost[count])) continue;
                whole.cost[count] = cost;
                whole.left[count] = static_cast<std::uint8_t>(k);
            }
        }
        Box box;
        for (const Child& child : children)
            if (!absent(child)) {
                box.add(child.min);
                box.add(child.max);
            }
        const glm::vec3 s = box.empty() ? glm::vec3(0) : box.size();
        whole.cost[1] = whole.cost[4] + s.x * s.y + s.y * s.z + s.z * s.x;
        whole.left[0] = whole.left[4];
        for (std::size_t count = 2; count <= 4; ++count)
            if (whole.cost[1] <= whole.cost[count]) {
                whole.cost[count] = whole.cost[1];
                whole.left[count] = 0;
            }
        whole.area = left.area + right.area;
        whole.triangles = left.triangles + right.triangles;
    }

    // The children that the parts of a binary node become, where there may be so many.
    void take(const Child& child, std::size_t most, std::array<Found, 4>& found, std::size_t& count) const {
        if (absent(child)) return;
        Below leaf;
        const Below& whole = below(child, leaf);
        if (most == 1 || whole.left[most] == 0) {
            found[count++] = {child, whole.area / static_cast<float>(whole.triangles)};
            return;
        }
        const auto& parts = binary_.nodes[child.reference].children;
        take(parts[0], whole.left[most], found, count);
        take(parts[1], most - whole.left[most], found, count);
    }

    // A thread costs more than it saves where there is little to do.
    [[nodiscard]] std::launch policy() const {
        return binary_.triangles.size() < 8192 ? std::launch::deferred : std::launch::async;
    }

    void node(WideBvh& wide, std::uint32_t from, std::size_t to, int depth) const {
        wide.depth = std::max(wide.depth, depth);
        std::array<Found, 4> children;
        std::size_t count = 0;
        const std::size_t left = below_[from].left[0];
        take(binary_.nodes[from].children[0], left, children, count);
        take(binary_.nodes[from].children[1], 4 - left, children, count);
        // Large triangles first, which are what stops a ray soonest: a fifth fewer visits in a hall, by any
        // hits.
        for (std::size_t i = 1; i < count; ++i)
            for (std::size_t k = i; k > 0 && children[k].size > children[k - 1].size; --k)
                std::swap(children[k], children[k - 1]);
        const std::size_t first = wide.items.size();
        wide.items.resize(first + count);
        std::array<Child, 4> boxes;
        for (std::size_t i = 0; i < count; ++i) boxes[i] = children[i].child;
        wide.items[to] = innerItem(boxes.data(), count, static_cast<std::uint32_t>(first));
        // Below the root each by itself, whatever the threads, so that the items are always in the same
        // order.
        std::array<std::future<WideBvh>, 4> parts;
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t reference = children[i].child.reference;
            if (shared::bvhIsLeaf(reference))
                wide.items[first + i] = triangle(binary_.triangles[shared::bvhLeafFirst(reference)]);
            else if (depth > 1)
                node(wide, reference, first + i, depth + 1);
            else
                parts[i] = std::async(policy(), [this, reference] {
                    WideBvh part;
                    part.items.emplace_back();
                    node(part, reference, 0, 2);
                    return part;
                });
        }
        for (std::size_t i = 0; i < count; ++i)
            if (parts[i].valid()) append(wide, first + i, parts[i].get());
    }

    // A part's root goes where room was left for it, what lies below behind all that there is.
    static void append(WideBvh& wide, std::size_t root, WideBvh part) {
        const auto shift = static_cast<std::uint32_t>(wide.items.size() - 1) * shared::wideTexels;
        for (WideItem& item : part.items)
            if (isNode(item)) item.texels[1].w += shift;
        wide.items[root] = part.items.front();
        wide.items.insert(wide.items.end(), part.items.begin() + 1, part.items.end());
        wide.depth = std::max(wide.depth, part.depth);
    }

    static WideItem triangle(const BvhTriangle& t) {
        const auto texel = [](const glm::vec3& p, std::uint32_t w) {
            return glm::uvec4(std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                              std::bit_cast<std::uint32_t>(p.z), w);
        };
        return {{texel(t.p0, t.triangle), texel(t.p1, t.material), texel(t.p2, t.triangleClass)}};
    }

    const Bvh& binary_;
    std::vector<Below> below_;
};

} // namespace

std::uint64_t mostWideItems(std::uint64_t triangles) {
    // Every inner node but the root has two children or more.
    return 1 + 2 * std::max<std::uint64_t>(1, triangles);
}

void refit(WideBvh& wide, const Geometry& geometry) {
    std::vector<Box> boxes(wide.items.size());
    // Children lie behind their parent.
    for (std::size_t at = wide.items.size(); at-- > 0;) {
        WideItem& item = wide.items[at];
        if (!isNode(item)) {
            const std::size_t triangle = item.texels[0].w;
            KESTREL_CHECK_LT(triangle, geometry.indices.size() / 3);
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::vec3& p = geometry.positions[geometry.indices[3 * triangle + k]];
                for (int axis = 0; axis < 3; ++axis)
                    item.texels[k][axis] = std::bit_cast<std::uint32_t>(p[axis]);
                boxes[at].add(p);
            }
            continue;
        }
        const std::uint32_t first = firstChild(item), count = childCount(item);
        std::array<Child, 4> children;
        for (std::uint32_t i = 0; i < count; ++i) {
            children[i].min = boxes[first + i].min;
            children[i].max = boxes[first + i].max;
            boxes[at].add(boxes[first + i]);
        }
        item = innerItem(children.data(), count, first);
    }
}

double expectedVisits(const WideBvh& wide) {
    double sum = 0, root = 0;
    for (const WideItem& item : wide.items) {
        if (!isNode(item)) continue;
        const auto step = [&](int axis) {
            return std::bit_cast<float>((item.texels[0].w >> (8 * axis) & 255u) << 23);
        };
        glm::vec3 whole(0);
        for (std::uint32_t k = 0; k < childCount(item); ++k) {
            glm::vec3 size(0);
            for (int axis = 0; axis < 3; ++axis) {
                const auto plane = [&](std::uint32_t word) {
                    return step(axis) * static_cast<float>(word >> (8 * k) & 255u);
                };
                size[axis] = plane(item.texels[2][axis]) - plane(item.texels[1][axis]);
                whole[axis] = std::max(whole[axis], plane(item.texels[2][axis]));
            }
            sum += double{size.x} * size.y + double{size.y} * size.z + double{size.z} * size.x;
        }
        if (&item == &wide.items.front())
            root = double{whole.x} * whole.y + double{whole.y} * whole.z + double{whole.z} * whole.x;
    }
    return root > 0 ? 1 + sum / root : 1;
}

WideBvh widened(const Bvh& binary) {
    KESTREL_CHECK(std::ranges::all_of(binary.nodes, [](const BvhNode& node) {
        return std::ranges::all_of(node.children, [](const Child& child) {
            return !shared::bvhIsLeaf(child.reference) || shared::bvhLeafCount(child.reference) <= 1;
        });
    }));
    WideBvh wide = Widener(binary)();
    KESTREL_CHECK_LE(wide.items.size() * shared::wideTexels, shared::wideMostTexels);
    KESTREL_CHECK_LE(wide.depth, static_cast<int>(shared::wideStackSize));
    return wide;
}

} // namespace kestrel
