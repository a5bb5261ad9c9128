// What the passes share that shade blended surfaces over an opaque picture.
#pragma once
#include "graph/registry.h"

namespace kestrel {

// The inputs `picture`, `depth` and `radiance`.
template<class T>
Describe<T>& addBlended(Describe<T>& table) {
    return table
        .input("picture", PortKind::Texture,
               "Radiance of what is opaque; a is 1 where something is (GBuffer with `blended` left_out)")
        .carries({.channels = 4})
        .input("depth", PortKind::Texture, "Reversed depth of what is opaque")
        .carries(content::depth)
        .sameExtentAs("picture")
        .optionalInput("radiance", PortKind::Radiance, "The light of the blended surfaces");
}

// Where the scene has no blended material: the output `result` is the input `picture`. Whether it is.
bool leavesOutBlended(const World& world, Declaration& declaration);

// A problem where a depth is not seen by the frame's camera, pixel by pixel.
void checkBlendedView(const Desc& depth, Declaration& declaration);

// Makes a step shade blended surfaces (shaders/transparency/surface.glsl): defines, and the module `radiance`
// where it is connected. With `ambient` other than 0 the step sets the uniform of that name.
void lightBlended(const World& world, const Inputs& inputs, const glm::vec3& ambient, Step& step);

} // namespace kestrel
