#include "reference/coincident.h"
#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace kestrel {
namespace {

using CornerKey = std::array<std::array<float, 3>, 3>;

CornerKey cornerKey(const Geometry& geometry, std::uint32_t triangle) {
    CornerKey key;
    for (size_t k = 0; k < 3; ++k) {
        const glm::vec3& p = geometry.positions[geometry.indices[3 * static_cast<size_t>(triangle) + k]];
        for (int i = 0; i < 3; ++i) key[k][static_cast<size_t>(i)] = p[i] + 0.0f; // one zero, not two
    }
    std::sort(key.begin(), key.end());
    return key;
}

std::uint64_t hashOf(const CornerKey& key) {
    std::uint64_t hash = 0xcbf29ce484222325u; // FNV-1a, by words
    for (const auto& corner : key)
        for (const float x : corner) hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 0x100000001b3u;
    return hash;
}

} // namespace

CoincidentTriangles::CoincidentTriangles(const Geometry& geometry) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> hashes(geometry.triangleCount());
    for (std::uint32_t i = 0; i < geometry.triangleCount(); ++i)
        hashes[i] = {hashOf(cornerKey(geometry, i)), i};
    std::sort(hashes.begin(), hashes.end());
    for (size_t first = 0, last = 0; first < hashes.size(); first = last) {
        while (last < hashes.size() && hashes[last].first == hashes[first].first) ++last;
        if (last - first < 2) continue;
        // Equal hashes are nearly always equal corners.
        std::vector<std::pair<CornerKey, std::uint32_t>> run;
        for (size_t i = first; i < last; ++i)
            run.emplace_back(cornerKey(geometry, hashes[i].second), hashes[i].second);
        std::sort(run.begin(), run.end());
        for (size_t i = 0, end = 0; i < run.size(); i = end) {
            while (end < run.size() && run[end].first == run[i].first) ++end;
            if (end - i < 2) continue;
            const auto group = static_cast<std::uint32_t>(groups_.size());
            groups_.emplace_back();
            for (size_t k = i; k < end; ++k) {
                groups_.back().push_back(run[k].second);
                groupOf_.emplace(run[k].second, group);
            }
        }
    }
}

std::span<const std::uint32_t> CoincidentTriangles::with(std::uint32_t triangle) const {
    const auto found = groupOf_.find(triangle);
    if (found == groupOf_.end()) return {};
    return groups_[found->second];
}

} // namespace kestrel
