// What the passes share that draw blended surfaces into layers.
#pragma once
#include "graph/pass.h"
#include "scene/geometry.h"

namespace kestrel {

// A step that draws them with shaders/transparency/scene.vert, and reads the input `depth`.
[[nodiscard]] Step blendedStep(const World& world, std::string name, const char* fragmentShader);
// The triangles that may be blended.
[[nodiscard]] std::vector<TriangleClass> blendedClasses();

inline constexpr Causes blendedCauses = Causes::Camera | Causes::Cut | Causes::Geometry | Causes::Transforms |
                                        Causes::Materials | Causes::Properties | Causes::Size;

// The output `layers` over the arrays `depths` ("peeled": reversed depths; else bits) and `triangles`, seen
// as `depth` is. A problem where that is not the frame's camera, pixel by pixel.
void declareBlendedLayers(const Desc& depth, int count, const char* depths, const Demand& demand,
                          Declaration& declaration);

} // namespace kestrel
