// What the reference passes that gather light share.
#pragma once
#include "draw/face_input.h"
#include "reference/gather.h"

namespace kestrel {

// The inputs `position`, `normal` and `face_normal`.
template<class T>
Describe<T>& addPlaces(Describe<T>& table) {
    table.input("position", PortKind::Texture, "Render-space positions of the surfaces")
        .carries(content::position)
        .input("normal", PortKind::Texture, "Their normals, unit, render space; 0 where nothing is")
        .carries(content::normal)
        .sameExtentAs("position");
    return addFaceNormal(table, "position");
}

// One step on the host from `reads` and face_normal to `writes`: "result" in rgba32f, others in r32f.
// Everything is the constant 0, and left out with a reason, where nothing is in view or `leftOut` says why.
Declaration declareGather(const Inputs& inputs, const std::vector<std::string>& reads,
                          const std::vector<std::string>& writes, const std::string& leftOut = {});

GatherSettings gatherSettings(Commands& commands, int samples, float distance);
GatherInputs gatherInputs(const Step& step, Commands& commands); // position, normals
// The input `face_normal`, or where nothing is connected what shaders take for it (lib/face.glsl): the
// normals, and starts of rays by the distance from the eye.
Image facesOf(const Step& step, Commands& commands, const Image& position, const Image& normal);
// Three channels of light as the four of a texture.
Image withOpaqueAlpha(const Image& colour);
// Writes "result" and reports noise and samples.
void finishGather(Commands& commands, const GatherResult& result);

} // namespace kestrel
