// Names that tell the cameras of a scene apart.
#pragma once
#include "scene/scene.h"

namespace kestrel {

// Gives each camera a name of its own: unnamed ones become "camera N" (N: the index), and of several with one
// name the first keeps it and the others become "NAME (2)", "NAME (3)", in their order, passing over names
// that are taken. Idempotent.
void nameCamerasApart(std::vector<Camera>& cameras);

} // namespace kestrel
