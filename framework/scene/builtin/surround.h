// The same scene as the middle of a larger one.
#pragma once
#include "scene/scene.h"

namespace kestrel::builtin {

// Sets up four small posts around the scene, extent times its bounding sphere's radius from its centre along
// x and z, so that its bounds grow about as much while what cameras show hardly changes. An extent of 1
// changes nothing, nor does a scene without triangles change.
void surround(Scene& scene, double extent);

} // namespace kestrel::builtin
