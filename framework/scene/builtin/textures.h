// Procedural textures of the built-in scenes: sRGB colour, linear alpha.
#pragma once
#include "scene/material.h"
#include <glm/glm.hpp>

namespace kestrel::builtin {

// A sprig: a stem with pointed leaves; the stem's foot is in the middle of the bottom row. Alpha is 0 around
// it, where the colour goes on so that filtering brings in no fringe.
TextureImage sprigTexture(int size);
// Blades of grass that grow from the bottom row.
TextureImage grassTexture(int size);
// `tiles` by `tiles` square tiles with grout between them, each a little different.
TextureImage tileTexture(int size, int tiles, const glm::vec3& tile, const glm::vec3& grout);

} // namespace kestrel::builtin
