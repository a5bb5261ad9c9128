// The same surface in more triangles.
#pragma once
#include "scene/scene.h"
#include <cstdint>

namespace kestrel::builtin {

// Replaces each triangle of each mesh by n * n coplanar ones, n >= 1. Positions, texture coordinates, colours
// and morph displacements are interpolated linearly, normals and tangents too and made unit again. The old
// vertices stay as they are, and triangles that share an edge share its new vertices, also where only the
// positions of its ends are equal: no cracks. A new vertex lies off its triangle by the rounding of float.
// Throws InputError where a mesh is skinned (a skin bends what is between old vertices, so that it would be
// another surface), and above maxTriangles.
void splitTriangles(Scene& scene, int n);

} // namespace kestrel::builtin
