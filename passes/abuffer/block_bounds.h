// Depth bounds of ever larger blocks of an A-buffer's pixels, so that a ray passes what it does not meet in
// few steps (Vardis, Vasilakis, Papaioannou 2016, section 4.2, after Uludag, "Hi-Z Screen-Space Cone-Traced
// Reflections", GPU Pro 5, 2014).
#pragma once
#include "graph/registry.h"

namespace kestrel {

// Level 0 is the pixels, each further level has blocks of 4 x 4 of the one before
// (shaders/abuffer/blocks.comp).
inline constexpr int blockLevels = 4;

// Declares the port `block_bounds`, the steps that make it, in the group "levels", and its use by the
// modules. `reads`: what level 0 is made of, the buffers of fragments or, with `primitives`, the cells of
// records.
void declareBlockBounds(Declaration& declaration, const World& world, const FragmentLists& lists,
                        bool primitives, const std::vector<Use>& reads);

} // namespace kestrel
