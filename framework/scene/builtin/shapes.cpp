#include "scene/builtin/shapes.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <unordered_map>

namespace kestrel::builtin {
namespace {

constexpr float twoPi = 2 * std::numbers::pi_v<float>;

struct PositionHash {
    size_t operator()(const glm::vec3& p) const {
        size_t h = 0;
        for (int i = 0; i < 3; ++i) h = h * 0x9e3779b97f4a7c15ull + std::bit_cast<std::uint32_t>(p[i] + 0.0f);
        return h ^ (h >> 29);
    }
};

std::uint32_t vertexCount(const Primitive& p) { return static_cast<std::uint32_t>(p.positions.size()); }

void addVertex(Primitive& to, const glm::vec3& position, const glm::vec3& normal, const glm::vec2& texCoord) {
    to.positions.push_back(position);
    to.normals.push_back(normal);
    to.texCoords.push_back(texCoord);
}

void addTriangle(Primitive& to, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto& p = to.positions;
    if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) return;
    to.indices.insert(to.indices.end(), {a, b, c});
}

// The triangles of a grid of nu by nv cells whose vertices start at `first`, column by column.
void addGridTriangles(Primitive& to, std::uint32_t first, int nu, int nv) {
    const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(i * (nv + 1) + j); };
    for (int i = 0; i < nu; ++i) {
        for (int j = 0; j < nv; ++j) {
            addTriangle(to, at(i, j), at(i + 1, j), at(i + 1, j + 1));
            addTriangle(to, at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
}

// Gives each triangle from `firstIndex` on vertices of its own with the triangle's normal.
void flatNormals(Primitive& p, size_t firstIndex) {
    Primitive own;
    for (size_t i = firstIndex; i + 2 < p.indices.size(); i += 3) {
        const auto corner = [&](size_t k) { return p.positions[p.indices[i + k]]; };
        const glm::vec3 normal = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
        for (size_t k = 0; k < 3; ++k) addVertex(own, corner(k), normal, p.texCoords[p.indices[i + k]]);
    }
    p.indices.resize(firstIndex);
    for (size_t i = 0; i < own.positions.size(); ++i) {
        p.indices.push_back(vertexCount(p));
        addVertex(p, own.positions[i], own.normals[i], own.texCoords[i]);
    }
}

} // namespace

void smoothNormals(Primitive& primitive, size_t firstVertex, size_t firstIndex) {
    std::unordered_map<glm::vec3, glm::vec3, PositionHash> sums;
    sums.reserve(primitive.positions.size() - firstVertex);
    const auto& positions = primitive.positions;
    for (size_t i = firstIndex; i + 2 < primitive.indices.size(); i += 3) {
        const glm::vec3 a = positions[primitive.indices[i]];
        const glm::vec3 b = positions[primitive.indices[i + 1]];
        const glm::vec3 c = positions[primitive.indices[i + 2]];
        const glm::vec3 area = glm::cross(b - a, c - a);
        for (const glm::vec3& p : {a, b, c}) sums[p] += area;
    }
    for (size_t i = firstVertex; i < positions.size(); ++i) {
        const glm::vec3 sum = sums[positions[i]];
        const float length = glm::length(sum);
        if (length > 0) primitive.normals[i] = sum / length;
    }
}

void addGrid(Primitive& to, int nu, int nv, const SurfaceFunction& surface, const GridOptions& options) {
    const std::uint32_t first = vertexCount(to);
    const size_t firstIndex = to.indices.size();
    for (int i = 0; i <= nu; ++i) {
        for (int j = 0; j <= nv; ++j) {
            const glm::vec2 uv(static_cast<float>(i) / static_cast<float>(nu),
                               static_cast<float>(j) / static_cast<float>(nv));
            const float u = options.closedU && i == nu ? 0 : uv.x;
            const float v = options.closedV && j == nv ? 0 : uv.y;
            addVertex(to, surface(u, v), {0, 1, 0}, uv * options.texScale);
        }
    }
    addGridTriangles(to, first, nu, nv);
    if (options.flat) {
        // The grid's own vertices are the last ones: take them away again.
        flatNormals(to, firstIndex);
        const auto grid = static_cast<std::ptrdiff_t>(nu + 1) * (nv + 1);
        to.positions.erase(to.positions.begin() + first, to.positions.begin() + first + grid);
        to.normals.erase(to.normals.begin() + first, to.normals.begin() + first + grid);
        to.texCoords.erase(to.texCoords.begin() + first, to.texCoords.begin() + first + grid);
        for (size_t i = firstIndex; i < to.indices.size(); ++i)
            to.indices[i] -= static_cast<std::uint32_t>(grid);
    } else {
        smoothNormals(to, first, firstIndex);
    }
}

void addCubeSphere(Primitive& to, int n, const std::function<glm::vec3(const glm::vec3&)>& place) {
    const size_t firstVertex = to.positions.size(), firstIndex = to.indices.size();
    // Equal angles instead of equal lengths make the cells nearly equal; the ends are exact so that the
    // sides meet.
    const auto spread = [n](int i) {
        if (i == 0 || i == n) return i == 0 ? -1.0f : 1.0f;
        return std::tan((static_cast<float>(i) / static_cast<float>(n) - 0.5f) * twoPi / 4);
    };
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const float sign = side % 2 == 0 ? 1.0f : -1.0f;
        const std::uint32_t first = vertexCount(to);
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; j <= n; ++j) {
                glm::vec3 d;
                d[axis] = sign;
                d[(axis + 1) % 3] = sign * spread(i);
                d[(axis + 2) % 3] = spread(j);
                const glm::vec2 uv = glm::vec2(i, j) / static_cast<float>(n);
                addVertex(to, place(glm::normalize(d)), {0, 1, 0}, uv);
            }
        }
        addGridTriangles(to, first, n, n);
    }
    smoothNormals(to, firstVertex, firstIndex);
}

void addQuad(Primitive& to, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
             const glm::vec2& texScale, int nu, int nv) {
    const std::uint32_t first = vertexCount(to);
    const glm::vec3 normal = glm::normalize(glm::cross(u, v));
    for (int i = 0; i <= nu; ++i) {
        for (int j = 0; j <= nv; ++j) {
            const glm::vec2 st = glm::vec2(i, j) / glm::vec2(nu, nv);
            addVertex(to, corner + u * st.x + v * st.y, normal, st * texScale);
        }
    }
    addGridTriangles(to, first, nu, nv);
}

void addBox(Primitive& to, const glm::mat4& frame, const glm::vec3& halfSize, float texPerUnit) {
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2, second = (axis + 1) % 3, third = (axis + 2) % 3;
        const float sign = side % 2 == 0 ? 1.0f : -1.0f;
        glm::vec3 centre(0), u(0), v(0);
        centre[axis] = sign * halfSize[axis];
        u[second] = sign * 2 * halfSize[second];
        v[third] = 2 * halfSize[third];
        const glm::vec3 corner = centre - 0.5f * (u + v);
        addQuad(to, glm::vec3(frame * glm::vec4(corner, 1)), glm::vec3(frame * glm::vec4(u, 0)),
                glm::vec3(frame * glm::vec4(v, 0)),
                texPerUnit * 2.0f * glm::vec2(halfSize[second], halfSize[third]));
    }
}

void addLathe(Primitive& to, const glm::mat4& frame, const std::vector<glm::vec2>& profile, int sides) {
    constexpr float sharp = 0.766f; // cosine of 40 degrees
    const auto direction = [&](size_t i) { return glm::normalize(profile[i + 1] - profile[i]); };
    for (size_t begin = 0; begin + 1 < profile.size();) {
        size_t end = begin + 1;
        while (end + 1 < profile.size() && glm::dot(direction(end - 1), direction(end)) > sharp) ++end;
        const auto rows = static_cast<int>(end - begin);
        const auto place = [&](float u, float v) {
            const glm::vec2 p =
                profile[begin + static_cast<size_t>(std::lround(u * static_cast<float>(rows)))];
            const float angle = twoPi * v;
            return glm::vec3(frame * glm::vec4(p.x * std::sin(angle), p.y, p.x * std::cos(angle), 1));
        };
        addGrid(to, rows, sides, [&](float u, float v) { return place(u, 1 - v); },
                {.closedU = false, .closedV = true, .texScale = glm::vec2(1), .flat = false});
        begin = end;
    }
}

void addTube(Primitive& to, const std::vector<glm::vec3>& path, const std::vector<float>& radii, int sides) {
    const size_t n = path.size();
    const auto tangent = [&](size_t i) {
        return glm::normalize(path[std::min(i + 1, n - 1)] - path[i == 0 ? 0 : i - 1]);
    };
    // Frames by parallel transport: the normal is carried along and made perpendicular again, so that the
    // tube does not twist.
    std::vector<glm::vec3> normals(n), binormals(n);
    const glm::vec3 start = tangent(0);
    glm::vec3 carried = std::abs(start.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    for (size_t i = 0; i < n; ++i) {
        const glm::vec3 t = tangent(i);
        carried = glm::normalize(carried - t * glm::dot(t, carried));
        normals[i] = carried;
        binormals[i] = glm::cross(t, carried);
    }
    const auto ring = [&](size_t i, float v) {
        const float angle = twoPi * v;
        return path[i] + radii[i] * (normals[i] * std::cos(angle) + binormals[i] * std::sin(angle));
    };
    const auto rows = static_cast<float>(n - 1);
    addGrid(to, static_cast<int>(n - 1), sides,
            [&](float u, float v) {
                return ring(static_cast<size_t>(std::lround(u * rows)), v == 0 ? 0 : 1 - v);
            },
            {.closedU = false, .closedV = true, .texScale = glm::vec2(1), .flat = false});
    for (const size_t end : {size_t{0}, n - 1}) {
        if (radii[end] <= 0) continue;
        const std::uint32_t first = vertexCount(to);
        const glm::vec3 out = end == 0 ? -tangent(0) : tangent(n - 1);
        for (int k = 0; k < sides; ++k) {
            const float v = static_cast<float>(k) / static_cast<float>(sides);
            addVertex(to, ring(end, end == 0 ? 1 - v : v), out, {v, 0});
        }
        for (int k = 1; k + 1 < sides; ++k)
            addTriangle(to, first, first + static_cast<std::uint32_t>(k),
                        first + static_cast<std::uint32_t>(k) + 1);
    }
}

glm::vec3 splinePoint(const std::vector<glm::vec3>& points, float t) {
    const auto last = static_cast<int>(points.size()) - 1;
    const float x = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(last);
    const int i = std::min(static_cast<int>(x), last - 1);
    const float f = x - static_cast<float>(i);
    const auto at = [&](int k) { return points[static_cast<size_t>(std::clamp(k, 0, last))]; };
    const glm::vec3 a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
    return 0.5f * (2.0f * b +
                   f * ((c - a) + f * ((2.0f * a - 5.0f * b + 4.0f * c - d) + f * (3.0f * (b - c) + d - a))));
}

} // namespace kestrel::builtin
