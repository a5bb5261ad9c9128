// Path tracing over a G-buffer by the reference tracer: what PathTrace is measured against.
#pragma once
#include "reference/gather.h"

namespace kestrel {

struct PathInputs : GatherInputs { // `albedo` and `material` are needed
    Image emission;                // 3 or 4: linear radiance. Empty: the surfaces send out none
    Image refraction; // 2 to 4: transmission, and the index of refraction behind the surface over that before
                      // it (relativeIndex() of shared/bsdf.h). Empty: all are opaque, of index 1.5
};

struct PathSettings {
    int samples = 64; // paths a pixel, rounded up to an even number
    int bounces = 2;  // rays of a path after the one that the G-buffer stands for
    std::uint32_t seed = 0;
    int threads = 2;        // the result does not depend on it
    bool areaLights = true; // sampled; off: their meshes shine along every ray instead
    glm::vec3 environment{0};
    Progress progress;
};

struct PathResult {
    Image radiance;   // 3 channels: what reaches the camera; the environment where there is no geometry
    Image indirect;   // 3 channels: the part of it that has come along at least one ray of the path
    double noise = 0; // standard error of a channel of `radiance`, as GatherResult has it
    std::uint64_t samples = 0;
};

// Kajiya, "The Rendering Equation" (1986), with a fixed number of bounces and no roulette. At every surface,
// the first included, all lights are asked for what the diffuse part of the BSDF (shared/bsdf.h) sends on: a
// shadow ray to each point, spot and directional light and one to a point on the area lights. The next ray is
// drawn by the BSDF; it brings what it meets sends out of itself. Meshes that show an area light do not count
// again along a ray that the diffuse part drew. Lights themselves are no surfaces: mirrors and glass see only
// the meshes that show them. An unlit surface shows its colour and ends the path. All results are functions
// of scene, inputs and settings but threads. Throws InputError if the images do not fit.
PathResult tracePaths(const GatherScene& scene, const PathInputs& inputs, const CameraState& camera,
                      const PathSettings& settings);

} // namespace kestrel
