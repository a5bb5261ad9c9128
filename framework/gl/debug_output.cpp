#include "gl/debug_output.h"
#include "core/log.h"
#include "gl/loader.h"
#include <atomic>

namespace kestrel::gl {
namespace {

std::atomic<std::uint64_t> severe{0};
thread_local int expecting = 0;

LogLevel levelOf(GLenum type, GLenum severity) {
    if (severity == GL_DEBUG_SEVERITY_HIGH) return LogLevel::Error;
    if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_MEDIUM) return LogLevel::Warning;
    return LogLevel::Debug;
}

void GLAPIENTRY onMessage(GLenum source, GLenum type, GLuint, GLenum severity, GLsizei length,
                          const GLchar* message, const void*) {
    // The compiler's messages are read from the program's own log and thrown with file and line.
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
    if (type == GL_DEBUG_TYPE_PUSH_GROUP || type == GL_DEBUG_TYPE_POP_GROUP) return;
    if (ExpectErrors::active() && type == GL_DEBUG_TYPE_ERROR) return;
    if (severity == GL_DEBUG_SEVERITY_HIGH) ++severe;
    std::string text(message, length < 0 ? std::string_view(message).size() : static_cast<size_t>(length));
    while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) text.pop_back();
    logMessage(levelOf(type, severity), "OpenGL: " + text);
}

} // namespace

ExpectErrors::ExpectErrors() {
    while (glGetError() != GL_NO_ERROR) {
    } // earlier errors have been told by the debug output
    ++expecting;
}
ExpectErrors::~ExpectErrors() { --expecting; }
bool ExpectErrors::active() { return expecting > 0; }
GLenum ExpectErrors::take() const {
    const GLenum first = glGetError();
    while (glGetError() != GL_NO_ERROR) {
    }
    return first;
}

void enableDebugOutput() {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(onMessage, nullptr);
}

std::uint64_t severeErrorCount() { return severe; }

} // namespace kestrel::gl
