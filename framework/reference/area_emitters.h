// Everything that shines from an area, as one list to choose from.
#pragma once
#include "image/image.h"
#include "scene/geometry.h"
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace kestrel {

// A parallelogram or triangle at `corner` with two edges, shining to the side of cross(u, v) or to both; or a
// sphere at `corner` of radius u.x.
struct AreaEmitter {
    enum class Kind : std::uint8_t { Parallelogram, Triangle, Sphere };
    Kind kind = Kind::Parallelogram;
    bool bothSides = false;
    glm::vec3 corner{0}, u{0}, v{0}; // render space
    glm::vec3 radiance{0};
    // Choosing with a number in [0, 1): the emitter whose `upper` is the first above it. Its probability is
    // exactly the distance to the `upper` before it.
    float upper = 1, probability = 1;
};

// The rectangle and sphere lights, and with `emissiveMeshes` the triangles of emissive materials (from both
// sides where the material is double-sided), chosen by area times luminance. A textured emission counts with
// its mean over the triangle. A mesh that lies on an area light and glows alike is that light's visible panel
// and left out. Empty if nothing shines.
std::vector<AreaEmitter> areaEmitters(std::span<const LightState> lights, const Geometry& geometry,
                                      const Scene& scene, bool emissiveMeshes);

// Of each triangle whether it is such a panel: where area lights are sampled, it must not shine a second
// time.
std::vector<bool> areaLightPanels(std::span<const LightState> lights, const Geometry& geometry,
                                  const Scene& scene);

// A point on the emitters, seen from a surface.
struct EmitterSample {
    glm::vec3 direction{0}; // unit, towards the emitter
    float distance = 0;     // up to it
    glm::vec3 light{0}; // what it brings over the probability of the choice: irradiance over pi, unoccluded
};

// `u` uniform in [0, 1)^2 chooses an emitter and a point: uniform by area, of a sphere uniform in the cone
// that it fills. Where the point shines away or lies below the surface's horizon, `light` is 0.
EmitterSample sampleEmitters(std::span<const AreaEmitter> emitters, const glm::vec3& position,
                             const glm::vec3& normal, glm::vec2 u);

inline float luminance(const glm::vec3& rgb) { return luminance(rgb.r, rgb.g, rgb.b); }

} // namespace kestrel
