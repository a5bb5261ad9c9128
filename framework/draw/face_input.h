// The optional input `face_normal` of what traces from a G-buffer (shaders/lib/face.glsl). Needs no GL.
#pragma once
#include "graph/pass.h"

namespace kestrel {

inline constexpr const char* faceNormalDescription =
    "Normals of their faces, unit, render space: no ray leaves below them; without it the normals stand for "
    "them";

// Makes `step` read the port where it is connected (define FACE_NORMAL, and the use), and says what is left
// out where it is not.
void useFaceNormal(Declaration& declaration, Step& step, const Inputs& inputs, Access access = Access::Fetch);

[[nodiscard]] bool usesFaceNormal(const Step& step);

} // namespace kestrel
