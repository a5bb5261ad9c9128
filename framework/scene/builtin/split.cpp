#include "scene/builtin/split.h"
#include "core/check.h"
#include "core/error.h"
#include "scene/geometry.h"
#include <array>
#include <fmt/format.h>
#include <map>
#include <tuple>
#include <utility>

namespace kestrel::builtin {
namespace {

// A new vertex: the mean of old ones with these weights, which sum to n.
struct Blend {
    std::array<std::uint32_t, 3> of;
    std::array<int, 3> weight;
};

// Splits the index list of one primitive and notes which vertices that needs.
class Splitter {
public:
    Splitter(const Primitive& primitive, int n)
        : primitive_(primitive)
        , n_(n) {}

    void split() {
        const size_t corners = primitive_.indices.size();
        indices.reserve(corners * static_cast<size_t>(n_) * static_cast<size_t>(n_));
        for (size_t i = 0; i + 2 < corners; i += 3) splitTriangle(primitive_.indices.data() + i);
    }

    std::vector<Blend> added;
    std::vector<std::uint32_t> indices;

private:
    std::uint32_t append(const Blend& blend) {
        added.push_back(blend);
        return static_cast<std::uint32_t>(primitive_.positions.size() + added.size() - 1);
    }

    // Whether a's position comes before b's: an order that two edges with equal ends agree on, so that the
    // same sums are rounded on both.
    [[nodiscard]] bool before(std::uint32_t a, std::uint32_t b) const {
        const glm::vec3 &p = primitive_.positions[a], &q = primitive_.positions[b];
        return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
    }

    // The vertex k steps of n from a to b.
    std::uint32_t onEdge(std::uint32_t a, std::uint32_t b, int k) {
        if (!before(a, b)) {
            std::swap(a, b);
            k = n_ - k;
        }
        const auto [found, isNew] = edges_.try_emplace({a, b}, 0);
        if (isNew) {
            found->second = append({{a, b, b}, {n_ - 1, 1, 0}});
            for (int step = 2; step < n_; ++step) append({{a, b, b}, {n_ - step, step, 0}});
        }
        return found->second + static_cast<std::uint32_t>(k - 1);
    }

    void splitTriangle(const std::uint32_t* corner) {
        const auto [a, b, c] = std::array{corner[0], corner[1], corner[2]};
        // Rows from the edge a-b towards c: row j has the n - j + 1 vertices with j parts of c.
        std::vector<std::uint32_t> below, row;
        for (int j = 0; j <= n_; ++j) {
            row.clear();
            for (int i = 0; i <= n_ - j; ++i) {
                const int rest = n_ - i - j;
                row.push_back(i == n_      ? b
                              : j == n_    ? c
                              : rest == n_ ? a
                              : j == 0     ? onEdge(a, b, i)
                              : i == 0     ? onEdge(a, c, j)
                              : rest == 0  ? onEdge(b, c, j)
                                           : append({{a, b, c}, {rest, i, j}}));
            }
            for (size_t i = 0; j > 0 && i < row.size(); ++i) {
                indices.insert(indices.end(), {below[i], below[i + 1], row[i]});
                if (i + 1 < row.size()) indices.insert(indices.end(), {below[i + 1], row[i + 1], row[i]});
            }
            std::swap(below, row);
        }
    }

    const Primitive& primitive_;
    int n_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges_; // to the first of its n - 1
};

// In double: products and most sums are exact there, so that coordinates that are equal stay so.
template<int Length>
glm::vec<Length, float> blended(const std::vector<glm::vec<Length, float>>& values, const Blend& blend,
                                int n) {
    glm::vec<Length, double> sum(0);
    for (size_t k = 0; k < 3; ++k)
        sum += static_cast<double>(blend.weight[k]) * glm::vec<Length, double>(values[blend.of[k]]);
    return glm::vec<Length, float>(sum / static_cast<double>(n));
}

glm::vec3 unitOr(const glm::vec3& v, const glm::vec3& otherwise) {
    const float length = glm::length(v);
    return length > 0 ? v / length : otherwise;
}

template<int Length>
void appendLinear(std::vector<glm::vec<Length, float>>& values, const std::vector<Blend>& added, int n) {
    if (values.empty()) return;
    values.reserve(values.size() + added.size());
    for (const Blend& blend : added) values.push_back(blended(values, blend, n));
}

void splitPrimitive(Primitive& p, int n) {
    Splitter splitter(p, n);
    splitter.split();
    const std::vector<Blend>& added = splitter.added;
    for (const Blend& blend : added) {
        if (!p.normals.empty())
            p.normals.push_back(unitOr(blended(p.normals, blend, n), p.normals[blend.of[0]]));
        if (!p.tangents.empty()) {
            const glm::vec4 first = p.tangents[blend.of[0]];
            p.tangents.emplace_back(unitOr(glm::vec3(blended(p.tangents, blend, n)), glm::vec3(first)),
                                    first.w);
        }
    }
    appendLinear(p.positions, added, n);
    appendLinear(p.texCoords, added, n);
    appendLinear(p.texCoords1, added, n);
    appendLinear(p.colours, added, n);
    for (Primitive::MorphTarget& target : p.targets) {
        appendLinear(target.positions, added, n);
        appendLinear(target.normals, added, n);
        appendLinear(target.tangents, added, n);
    }
    p.indices = std::move(splitter.indices);
}

} // namespace

void splitTriangles(Scene& scene, int n) {
    KESTREL_CHECK(n >= 1);
    if (n == 1) return;
    std::uint64_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) {
        for (const Primitive& primitive : mesh.primitives) {
            triangles += primitive.indices.size() / 3 * static_cast<std::uint64_t>(n) * n;
            if (!primitive.joints.empty())
                throw InputError(
                    fmt::format("the mesh '{}' is skinned: split, its surface would be another", mesh.name));
        }
    }
    if (triangles > maxTriangles)
        throw InputError(fmt::format("split into {} times {} parts, the scene has {} triangles; at most {}",
                                     n, n, triangles, maxTriangles));
    for (Mesh& mesh : scene.meshes)
        for (Primitive& primitive : mesh.primitives) splitPrimitive(primitive, n);
}

} // namespace kestrel::builtin
