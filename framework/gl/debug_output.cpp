#include "gl/debug_output.h"
#include "core/log.h"
#include "gl/loader.h"
#include <atomic>
#include <string>

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

// Bounded: a lost context may have an error for every call.
void dropErrors() {
    constexpr int most = 100;
    for (int i = 0; i < most && glGetError() != GL_NO_ERROR;) ++i;
}

// A limit counts the final zero, whether one is passed or not.
std::string_view cutTo(GLenum limit, std::string_view text) {
    GLint most = 0;
    glGetIntegerv(limit, &most);
    return cutText(text, most > 0 ? static_cast<std::size_t>(most) - 1 : 0);
}

} // namespace

ExpectErrors::ExpectErrors() {
    dropErrors(); // earlier errors have been told by the debug output
    ++expecting;
}
ExpectErrors::~ExpectErrors() { --expecting; }
bool ExpectErrors::active() { return expecting > 0; }
GLenum ExpectErrors::take() const {
    const GLenum first = glGetError();
    dropErrors();
    return first;
}

void enableDebugOutput() {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(onMessage, nullptr);
}

std::uint64_t severeErrorCount() { return severe; }

void setLabel(unsigned int kind, unsigned int name, std::string_view text) {
    const std::string_view cut = cutTo(GL_MAX_LABEL_LENGTH, text);
    glObjectLabel(kind, name, static_cast<GLsizei>(cut.size()), cut.data());
}

void pushDebugGroup(unsigned int id, std::string_view text) {
    const std::string_view cut = cutTo(GL_MAX_DEBUG_MESSAGE_LENGTH, text);
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, id, static_cast<GLsizei>(cut.size()), cut.data());
}

std::string_view cutText(std::string_view text, std::size_t most) {
    if (text.size() <= most) return text;
    const auto continues = [&](std::size_t at) {
        return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
    };
    while (most > 0 && continues(most)) --most;
    return text.substr(0, most);
}

} // namespace kestrel::gl
