// The surfaces of a G-buffer that rays start from: depth, normals, and optionally the normals of their faces
// (shaders/lib/face.glsl). Needs no GL.
#pragma once
#include "graph/registry.h"

namespace kestrel {

inline constexpr const char* faceNormalDescription =
    "Normals of their faces, unit, render space: no ray leaves below them; without it the normals stand for "
    "them";

// The input `face_normal` of surfaces that lie where the input `place` says.
template<class T>
Describe<T>& addFaceNormal(Describe<T>& table, const std::string& place) {
    return table.optionalInput("face_normal", PortKind::Texture, faceNormalDescription)
        .carries(content::normal)
        .sameExtentAs(place);
}

// The inputs `depth`, `normal` and `face_normal`.
template<class T>
Describe<T>& addSurface(Describe<T>& table) {
    table.input("depth", PortKind::Texture, "Reversed depth of the surfaces")
        .carries(content::depth)
        .input("normal", PortKind::Texture, "Their normals, unit, render space")
        .carries(content::normal)
        .sameExtentAs("depth");
    return addFaceNormal(table, "depth");
}

// Makes `step` read the port where it is connected (define FACE_NORMAL, and the use), and says what is left
// out where it is not.
void useFaceNormal(Declaration& declaration, Step& step, const Inputs& inputs, Access access = Access::Fetch);

[[nodiscard]] bool usesFaceNormal(const Step& step);

} // namespace kestrel
