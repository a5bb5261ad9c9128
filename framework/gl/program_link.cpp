#include "gl/program_link.h"
#include "core/error.h"
#include "gl/loader.h"
#include "shader/problems.h"
#include <algorithm>
#include <fmt/format.h>

namespace kestrel::gl {
namespace {

void deleteShader(Name name) { glDeleteShader(name); }
using Shader = Handle<deleteShader>;

GLenum stageEnum(ShaderStage stage) {
    switch (stage) {
    case ShaderStage::Vertex:
        return GL_VERTEX_SHADER;
    case ShaderStage::Geometry:
        return GL_GEOMETRY_SHADER;
    case ShaderStage::Fragment:
        return GL_FRAGMENT_SHADER;
    case ShaderStage::Compute:
        break;
    }
    return GL_COMPUTE_SHADER;
}

std::string shaderLog(Name shader) {
    GLint length = 0;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(length), '\0');
    GLsizei written = 0;
    glGetShaderInfoLog(shader, length, &written, log.data());
    log.resize(static_cast<size_t>(written));
    return log;
}

std::string programLog(Name program) {
    GLint length = 0;
    glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(length), '\0');
    GLsizei written = 0;
    glGetProgramInfoLog(program, length, &written, log.data());
    log.resize(static_cast<size_t>(written));
    return log;
}

// The problems, or a sentence of our own where the compiler said nothing that can be read.
std::vector<Problem> orSilent(std::vector<Problem> problems, const std::string& file, const char* what,
                              const std::string& log) {
    if (problems.empty())
        problems.push_back({{file, 0, 0},
                            log.empty() ? fmt::format("the driver's {} gives no reason", what)
                                        : fmt::format("the driver's {} says: {}", what, log)});
    return problems;
}

// Compiles all stages before it throws, so that all problems are seen at once.
std::vector<Shader> compileStages(const ComposedProgram& composed) {
    std::vector<Shader> shaders;
    std::vector<Problem> problems;
    for (const ComposedStage& stage : composed.stages) {
        Shader shader(glCreateShader(stageEnum(stage.stage)));
        const std::string source = driverText(stage);
        const char* text = source.c_str();
        const auto length = static_cast<GLint>(source.size());
        glShaderSource(shader.get(), 1, &text, &length);
        glCompileShader(shader.get());
        GLint compiled = 0;
        glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &compiled);
        if (compiled != GL_TRUE) {
            const std::string log = shaderLog(shader.get());
            const auto found = orSilent(mapShaderLog(log, stage), stage.file, "compiler", log);
            problems.insert(problems.end(), found.begin(), found.end());
        }
        shaders.push_back(std::move(shader));
    }
    if (!problems.empty()) throw InputError(std::move(problems));
    return shaders;
}

} // namespace

void linkProgram(Name program, const ComposedProgram& composed, const std::vector<std::string>& attachments) {
    const std::vector<Shader> shaders = compileStages(composed);
    for (const Shader& shader : shaders) glAttachShader(program, shader.get());
    for (size_t i = 0; i < attachments.size(); ++i)
        glBindFragDataLocation(program, static_cast<GLuint>(i), ("out_" + attachments[i]).c_str());
    glLinkProgram(program);
    for (const Shader& shader : shaders) glDetachShader(program, shader.get());
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        const std::string log = programLog(program);
        throw InputError(orSilent(mapLinkLog(log, composed), composed.name, "linker", log));
    }
}

void requireAttachments(Name program, const ComposedProgram& composed,
                        const std::vector<std::string>& attachments) {
    if (composed.stages.back().stage != ShaderStage::Fragment) return;
    GLint count = 0;
    glGetProgramInterfaceiv(program, GL_PROGRAM_OUTPUT, GL_ACTIVE_RESOURCES, &count);
    std::vector<Problem> problems;
    for (GLint i = 0; i < count; ++i) {
        char name[256] = {};
        glGetProgramResourceName(program, GL_PROGRAM_OUTPUT, static_cast<GLuint>(i), sizeof name, nullptr,
                                 name);
        const std::string_view output = name;
        if (!output.starts_with("out_")) continue;
        const std::string port(output.substr(4));
        if (std::find(attachments.begin(), attachments.end(), port) == attachments.end())
            problems.push_back({{composed.stages.back().file, 0, 0},
                                fmt::format("output '{}' has no attachment '{}'{}", output, port,
                                            didYouMean(port, attachments))});
    }
    if (!problems.empty()) throw InputError(std::move(problems));
}

} // namespace kestrel::gl
