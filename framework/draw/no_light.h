// The constant of a light texture where nothing arrives.
#pragma once
#include <glm/glm.hpp>

namespace kestrel {

// Irradiance and radiance textures have an alpha of 1 everywhere, lit or not: a pass that is left out gives
// the same.
inline constexpr glm::vec4 noLight{0, 0, 0, 1};

} // namespace kestrel
