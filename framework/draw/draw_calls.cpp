#include "draw/draw_calls.h"
#include "gl/loader.h"

namespace kestrel {
namespace {

void enable(GLenum what, bool on) {
    if (on)
        glEnable(what);
    else
        glDisable(what);
}

GLenum compareEnum(Compare compare) {
    switch (compare) {
    case Compare::Greater:
        return GL_GREATER;
    case Compare::GreaterEqual:
        return GL_GEQUAL;
    case Compare::Equal:
        return GL_EQUAL;
    case Compare::Less:
        return GL_LESS;
    case Compare::Always:
        break;
    }
    return GL_ALWAYS;
}

void applyBlend(Blend blend) {
    enable(GL_BLEND, blend != Blend::None);
    glBlendEquation(blend == Blend::Min ? GL_MIN : blend == Blend::Max ? GL_MAX : GL_FUNC_ADD);
    if (blend == Blend::MaxAndSum) glBlendEquationSeparate(GL_MAX, GL_FUNC_ADD);
    if (blend == Blend::Add || blend == Blend::MaxAndSum) glBlendFunc(GL_ONE, GL_ONE);
    // Colours premultiplied by alpha.
    if (blend == Blend::Over) glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

} // namespace

void applyDrawState(const DrawState& state) {
    // Depth is written only while the test is enabled.
    const bool depth = state.depth != Compare::Always || state.depthWrite;
    enable(GL_DEPTH_TEST, depth);
    glDepthFunc(compareEnum(state.depth));
    glDepthMask(state.depthWrite ? GL_TRUE : GL_FALSE);
    applyBlend(state.blend);
    const GLboolean colour = state.colourWrite ? GL_TRUE : GL_FALSE;
    glColorMask(colour, colour, colour, colour);
    enable(GL_COLOR_LOGIC_OP, state.logicOr);
    if (state.logicOr) glLogicOp(GL_OR);
    enable(GL_DEPTH_CLAMP, state.depthClamp);
}

void setCulling(Cull cull) {
    enable(GL_CULL_FACE, cull != Cull::None);
    if (cull != Cull::None) glCullFace(cull == Cull::Back ? GL_BACK : GL_FRONT);
}

void setViewport(const glm::uvec2& size) {
    glViewport(0, 0, static_cast<GLsizei>(size.x), static_cast<GLsizei>(size.y));
}

void drawVertices(const DrawState& state, const gl::VertexArray& noVertices, std::uint32_t count,
                  std::uint32_t instances) {
    applyDrawState(state);
    setCulling(state.cull);
    glBindVertexArray(noVertices.name());
    if (count == 0 || instances == 0) return;
    glDrawArraysInstanced(GL_TRIANGLES, 0, static_cast<GLsizei>(count), static_cast<GLsizei>(instances));
}

void drawVerticesIndirect(const DrawState& state, const gl::VertexArray& noVertices,
                          const gl::Buffer& commands, std::uint64_t offset) {
    applyDrawState(state);
    setCulling(state.cull);
    glBindVertexArray(noVertices.name());
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands.name());
    glDrawArraysIndirect(GL_TRIANGLES, reinterpret_cast<const void*>(commands.offset() + offset));
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}

} // namespace kestrel
