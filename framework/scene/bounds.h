// Axis-aligned boxes and bounding spheres.
#pragma once
#include <glm/glm.hpp>
#include <limits>

namespace kestrel {

// An axis-aligned box; empty until something is added.
struct Box {
    glm::vec3 min{std::numeric_limits<float>::infinity()};
    glm::vec3 max{-std::numeric_limits<float>::infinity()};

    [[nodiscard]] bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    [[nodiscard]] glm::vec3 centre() const { return 0.5f * (min + max); }
    [[nodiscard]] glm::vec3 size() const { return max - min; }
    void add(const glm::vec3& point) {
        min = glm::min(min, point);
        max = glm::max(max, point);
    }
    void add(const Box& box) {
        min = glm::min(min, box.min);
        max = glm::max(max, box.max);
    }
};

struct Sphere {
    glm::vec3 centre{0};
    float radius = 0;
};

} // namespace kestrel
