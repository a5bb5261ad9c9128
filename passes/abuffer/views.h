// The views of an A-buffer: what its passes share.
#pragma once
#include "execute/commands.h"
#include "graph/pass.h"
#include "shared/abuffer.h"
#include <optional>
#include <string>
#include <vector>

namespace kestrel {

// Pixels of all views: the frame's first, where it is among them, then face after face, row after row.
[[nodiscard]] std::uint64_t abufferPixels(const FragmentLists& lists, const Extent& frame);

// Words that a pixel has in `pixels`: SB first node and number of nodes; LL the head; DLL head and tail; LLB
// the bounds and the heads of the buckets; DLLB also their tails. With planes one more: the largest part of
// its depth by which a fragment's plane changes over the pixel, a float.
[[nodiscard]] int abufferPixelWords(const FragmentLists& lists);
// Words of a node in `nodes`: depth, then SB the link to the data, LL and LLB the next node, DLL and DLLB
// next and previous node, with planes the slopes, and where data is not decoupled the triangle.
[[nodiscard]] int abufferNodeWords(const FragmentLists& lists);

// What shaders of the A-buffer need to know of it (shaders/abuffer/lists.glsl).
[[nodiscard]] Defines abufferDefines(const FragmentLists& lists, const Extent& frame);

// How the scene is drawn into several views: one after the other; all at once, by a geometry shader that
// gives each triangle to every view (as in the paper) or by instances whose vertices choose it.
enum class ABufferDrawing : std::uint8_t { ByView, GeometryShader, VertexLayer };

// Blended surfaces alone are drawn view by view: they lie in the frame's view where the ray through a pixel's
// middle meets them, not where the rasterizer finds them, which rounds corners to parts of a pixel.
[[nodiscard]] ABufferDrawing abufferDrawing(ABufferDrawing asked, const FragmentLists& lists);

// Which views a step draws into: the frame's, the faces', or both, which takes another drawing than ByView.
enum class ABufferViews : std::uint8_t { Frame, Faces, All };

// The program of a step that draws the scene's triangles into views, but for its fragment stage, which it
// calls `fragment`. A geometry shader rounds vertices otherwise than none, for one view as for all.
// `layered`: faces are the layers of its attachments; otherwise it has none. `byNumber`: vertices are fetched
// by the triangle's number, so that fragments know it, and between which depths it lies, without
// gl_PrimitiveID.
[[nodiscard]] Step abufferSceneStep(const World& world, const FragmentLists& lists, ABufferViews views,
                                    ABufferDrawing drawing, bool layered, const std::string& fragment,
                                    bool byNumber = false);
// What it does when it runs, once uniforms are set; `state` says it if vertices are fetched by number.
void abufferDrawScene(Commands& commands, DrawState state, const FragmentLists& lists, const Extent& frame,
                      ABufferViews views, ABufferDrawing drawing, bool layered);
// Nothing, or why this machine cannot draw so.
[[nodiscard]] std::optional<std::string> abufferCannotDraw(ABufferDrawing drawing,
                                                           const Capabilities& capabilities);

// All triangles of which fragments may be kept, as rays meet them: passes draw both sides of each.
[[nodiscard]] std::vector<TriangleClass> abufferClasses(Blended blended);
[[nodiscard]] bool abufferHasFragments(const FragmentLists& lists, const SceneFacts& facts);

} // namespace kestrel
