#include "gl/debug_output.h"
#include "gl/loader.h"
#include "gl/objects.h"

namespace kestrel::gl {

void deleteVertexArray(Name name) { glDeleteVertexArrays(1, &name); }
void deleteSampler(Name name) { glDeleteSamplers(1, &name); }

VertexArray::VertexArray(const std::string& label) {
    Name name = 0;
    glCreateVertexArrays(1, &name);
    handle_ = Handle<deleteVertexArray>(name);
    setLabel(GL_VERTEX_ARRAY, name, label);
}

void VertexArray::setIndices(const Buffer& buffer) { glVertexArrayElementBuffer(name(), buffer.name()); }

void VertexArray::setAttribute(unsigned int location, const Buffer& buffer, int components,
                               std::uint32_t stride, std::uint32_t offset) {
    // One binding point an attribute: no two attributes need share one.
    const GLuint binding = location;
    glEnableVertexArrayAttrib(name(), location);
    glVertexArrayVertexBuffer(name(), binding, buffer.name(), 0, static_cast<GLsizei>(stride));
    glVertexArrayAttribFormat(name(), location, components, GL_FLOAT, GL_FALSE, offset);
    glVertexArrayAttribBinding(name(), location, binding);
}

namespace {

GLint wrapOf(Wrapping wrapping) {
    switch (wrapping) {
    case Wrapping::Repeat:
        return GL_REPEAT;
    case Wrapping::MirroredRepeat:
        return GL_MIRRORED_REPEAT;
    case Wrapping::ClampToEdge:
        break;
    }
    return GL_CLAMP_TO_EDGE;
}

GLint minFilterOf(const SamplerState& state) {
    if (state.mips) return state.linear ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_NEAREST;
    return state.linear ? GL_LINEAR : GL_NEAREST;
}

} // namespace

Name SamplerCache::get(const SamplerState& state) {
    for (const auto& [made, sampler] : samplers_)
        if (made == state) return sampler.get();
    Name name = 0;
    glCreateSamplers(1, &name);
    samplers_.emplace_back(state, Handle<deleteSampler>(name));
    glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, minFilterOf(state));
    glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, state.linear ? GL_LINEAR : GL_NEAREST);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glSamplerParameteri(name, axis, wrapOf(state.wrapping));
    return name;
}

} // namespace kestrel::gl
