// The views of an A-buffer: what its passes share.
#pragma once
#include "execute/commands.h"
#include "graph/pass.h"
#include "shared/abuffer.h"
#include <vector>

namespace kestrel {

// Pixels of all views: the frame's first, where it is among them, then face after face, row after row.
[[nodiscard]] std::uint64_t abufferPixels(const FragmentLists& lists, const Extent& frame);

// Words that a pixel has in `pixels`: SB first node and number of nodes; LL the head; DLL head and tail; LLB
// the bounds and the heads of the buckets; DLLB also their tails.
[[nodiscard]] int abufferPixelWords(const FragmentLists& lists);
// Words of a node in `nodes`: depth, then SB the link to the data, LL and LLB the next node, DLL and DLLB
// next and previous node, and where data is not decoupled the triangle.
[[nodiscard]] int abufferNodeWords(const FragmentLists& lists);

// What shaders of the A-buffer need to know of it (shaders/abuffer/lists.glsl).
[[nodiscard]] Defines abufferDefines(const FragmentLists& lists, const Extent& frame);

// The program that draws the scene into the frame's view or a face of the cube. Blended surfaces alone lie in
// the frame's view where the ray through a pixel's middle meets them, not where the rasterizer finds them,
// which rounds corners to parts of a pixel.
[[nodiscard]] std::vector<std::string> abufferShaders(const FragmentLists& lists, bool ofCube,
                                                      const char* fragment);

// All triangles of which fragments may be kept, as rays meet them: passes draw both sides of each.
[[nodiscard]] std::vector<TriangleClass> abufferClasses(Blended blended);
[[nodiscard]] bool abufferHasFragments(const FragmentLists& lists, const SceneFacts& facts);

} // namespace kestrel
