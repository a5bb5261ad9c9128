// The parts of glTF's JSON schema that Kestrel relies on.
#pragma once
#include "scene/gltf_container.h"

namespace kestrel {

// How far beyond its range a number may lie, relative to the bound (to 1 where that is less), to be read as
// the bound with a warning.
inline constexpr double gltfRounding = 1e-3;

// Checks types, required members, ranges, and that every index is in range: what follows reads the document
// without asking again. Numbers that are whole though written as floats become integers where integers are
// due. Numbers out of range by a
// rounding, or in materials that nothing uses, become the bound, with a warning. Also checks asset.version.
// Throws InputError for the first thing that is wrong, with its path: "meshes[0].primitives[1].indices is 12,
// but there are 4 accessors".
void checkGltfSchema(GltfFile& file);

} // namespace kestrel
