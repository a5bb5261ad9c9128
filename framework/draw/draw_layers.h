// Drawing into arrays and cubes layer by layer.
#pragma once
#include "gl/objects.h"
#include <cstdint>
#include <functional>

namespace kestrel {

// Binds layer 0, 1, … of every attachment in turn, calls `draw` for each of `count`, and binds `target`
// again. The viewport stays. The attachments are layered and have as many layers.
void eachLayer(gl::FramebufferCache& framebuffers, const gl::Target& target, std::uint32_t count,
               const std::function<void(std::uint32_t layer)>& draw);

} // namespace kestrel
