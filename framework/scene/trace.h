// A ray and a hit, as the CPU tracers (bvh_trace.h, reference/tracer.h) take and give them.
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

namespace kestrel {

struct TraceRay {
    glm::vec3 origin{0}, direction{0, 0, -1}; // render space; t counts in lengths of the direction
    float tMin = 0, tMax = std::numeric_limits<float>::infinity(); // both ends belong to the interval
};

struct TraceHit {
    static constexpr std::uint32_t none = 0xffffffffu;
    float t = 0;
    float u = 0, v = 0;            // barycentric weights of the second and third corner
    std::uint32_t triangle = none; // index in the Geometry
    friend bool operator==(const TraceHit&, const TraceHit&) = default;
};

} // namespace kestrel
