// Draw calls and their state.
#pragma once
#include "draw/draw.h"
#include "gl/objects.h"

namespace kestrel {

// Sets all state that DrawState speaks of, but for culling, which drawn classes decide, and the viewport.
void applyDrawState(const DrawState& state);
void setCulling(Cull cull);
void setViewport(const glm::uvec2& size);

// `count` vertices without attributes as triangles; `noVertices` is a VertexArray without attributes.
void drawVertices(const DrawState& state, const gl::VertexArray& noVertices, std::uint32_t count,
                  std::uint32_t instances = 1);
// Counts from a buffer at a byte offset, a multiple of 4: vertices, instances, first vertex, first instance.
void drawVerticesIndirect(const DrawState& state, const gl::VertexArray& noVertices,
                          const gl::Buffer& commands, std::uint64_t offset = 0);
// The triangle of lib/fullscreen.vert.
inline void drawFullscreen(const DrawState& state, const gl::VertexArray& noVertices) {
    drawVertices(state, noVertices, 3);
}

} // namespace kestrel
