// What holds for a scene over its whole timeline. Passes decide by these facts what to leave out.
#pragma once
#include "scene/bounds.h"
#include "scene/scene.h"
#include <cstdint>
#include <string>
#include <vector>

namespace kestrel {

// A spot light that opens wider to each side, in radians (80 degrees), has a map of several faces: a flat one
// grows without bound, and has few texels left for its middle.
inline constexpr float wideSpotCone = 1.3962634f;

struct SceneFacts {
    std::uint64_t triangles = 0, vertices = 0;
    std::uint32_t materials = 0, images = 0, instances = 0;
    std::uint32_t maskedTriangles = 0; // alpha mode Mask or Blend
    bool hasMasked = false;            // alpha-tested materials (Mask and Blend) that some triangle uses
    bool hasBlend = false;
    bool hasDoubleSided = false;
    bool hasSingleSided = false;
    bool hasTextures = false; // any texture that a used material refers to
    std::uint32_t colourTextureArrays = 0, dataTextureArrays = 0; // textureArrays()
    bool hasTiledTextures = false;                                // some layer of them holds several images
    bool hasNormalMaps = false;
    bool hasVertexColours = false;
    bool hasEmission = false;
    bool hasTransmission = false;
    bool hasUnlit = false;
    bool geometryMoves = false;   // any triangle's position changes along the timeline (nodes, skins, morphs)
    bool geometryDeforms = false; // skins or morph targets that are animated
    bool cameraMoves = false;     // any camera's node is animated
    bool lightsMove = false;
    std::uint32_t pointLights = 0, spotLights = 0, directionalLights = 0, rectangleLights = 0,
                  sphereLights = 0;
    std::uint32_t wideSpotLights = 0; // of the spot lights: those that open beyond wideSpotCone
    std::vector<std::string> cameras; // their names
    double duration = 0;              // seconds
    Box bounds;                       // render space, over the whole timeline; empty if there is no triangle
    Sphere sphere;                    // bounding sphere of all of it; radius 0 if there is no triangle

    [[nodiscard]] std::uint32_t lights() const {
        return pointLights + spotLights + directionalLights + rectangleLights + sphereLights;
    }
};

// Bounds under animation are exact for rigid motion sampled at all keys and between them finely enough that
// the stated box contains every frame (it is widened by the largest step seen); tests hold it against every
// frame.
SceneFacts gatherFacts(const Scene& scene);

} // namespace kestrel
