// The same scene of glass.
#pragma once
#include "scene/scene.h"

namespace kestrel::builtin {

// Every material becomes blended, of this alpha (of masked ones it multiplies their own), and is seen from
// both sides.
void blend(Scene& scene, float alpha);

} // namespace kestrel::builtin
