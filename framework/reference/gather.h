// One bounce, soft shadows and glossy reflection over a G-buffer by the reference tracer: what the effects of
// passes/ray_effects are measured against.
#pragma once
#include "image/image.h"
#include "reference/rows.h"
#include "reference/tracer.h"
#include "scene/geometry.h"
#include <cstdint>
#include <limits>
#include <span>

namespace kestrel {

// Images of one size, rows in any order (the result has the same).
struct GatherInputs {
    Image position;   // 3 or 4 channels: render space
    Image normal;     // 3 or 4: unit; zero where there is no geometry
    Image faceNormal; // 3: the surface itself, unit, on the same side; 4: and how far along it rays start
                      // (rayStart() of shared/ray.h). Empty: the same as `normal`
    Image albedo;     // 3 or 4, for glossy reflection: linear base colour
    Image material;   // 2 to 4, for glossy reflection: roughness, metallic, unlit if above 0.5
};

struct GatherSettings {
    int samples = 256; // a pixel, rounded up to an even number
    std::uint32_t seed = 0;
    int threads = 2;                                                // the result does not depend on it
    float maximumDistance = std::numeric_limits<float>::infinity(); // surfaces farther away are not met
    bool emission = false;    // emissive surfaces send out their emission too
    glm::vec3 environment{0}; // radiance that arrives where nothing is met
    // How far a ray starts off the surface along the face normal where the input does not tell it, relative
    // to the largest of the position's components and the radius of the geometry's bounds: above the rounding
    // of a position that went through a depth buffer.
    float relativeOffset = 0x1p-15f;
    Progress progress;
};

struct GatherResult {
    Image light;      // 3 channels; 0 without geometry
    Image visibility; // 1 channel, of soft shadows: 1 without geometry
    // Standard error of a channel of `light`: half the root mean square difference, over pixels with
    // geometry, of the means of two independent halves of the samples. 0 without geometry.
    double noise = 0;
    std::uint64_t samples = 0; // of all pixels
};

// What light falls on: the geometry must be what the tracer was built from, and all must outlive the calls.
struct GatherScene {
    const ReferenceTracer& tracer;
    const Geometry& geometry;
    const Scene& scene;
    std::span<const LightState> lights;
};

// All results are functions of scene, inputs and settings but threads (scrambled Sobol points, a scramble for
// each pixel and half). Nothing arrives at a point, first or second, from below its face (leavesFace() of
// shared/ray.h). They throw InputError if the images do not fit.

// The cosine-weighted mean of the radiance that arrives (irradiance over pi) after one bounce. A surface that
// is met sends out its diffuse albedo (base colour times one minus metallic) times the irradiance over pi
// that all lights of the scene give it, with a shadow ray to each point, spot and directional light and one
// to a point on the area lights.
GatherResult gatherIndirectDiffuse(const GatherScene& scene, const GatherInputs& inputs,
                                   const GatherSettings& settings);

// The irradiance over pi that arrives straight from area lights (and emissive meshes, with `emission`), and
// how bright it is over what it would be without shadows (1 where nothing shines).
GatherResult gatherSoftShadow(const GatherScene& scene, const GatherInputs& inputs,
                              const GatherSettings& settings);

// The radiance that leaves towards the camera by the specular lobe (shared/ggx.h); what is met shines as for
// one bounce.
GatherResult gatherGlossyReflection(const GatherScene& scene, const GatherInputs& inputs,
                                    const CameraState& camera, const GatherSettings& settings);

} // namespace kestrel
