#include "shader/validate.h"
#include "shader/lines.h"
#include "shader/problems.h"
#include <algorithm>
#include <array>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <memory>

namespace kestrel {
namespace {

const std::array<UnknownExtension, 2> extensionTable{
    {{"GL_EXT_shader_framebuffer_fetch",
      "ordered blending in the fragment shader on drivers without fragment shader interlock"},
     {"GL_NV_shader_atomic_float",
      "atomic sums of floats on drivers without GL_EXT_shader_atomic_float (which glslang knows)"}}};

bool usesUnknownExtension(const ComposedStage& stage) {
    for (const ShaderLine& line : shaderLines(stage.text)) {
        const std::optional<Directive> directive = directiveOf(line.code);
        if (!directive || directive->name != "extension") continue;
        const std::string_view name =
            trimmed(std::string_view(directive->rest).substr(0, directive->rest.find(':')));
        if (std::any_of(extensionTable.begin(), extensionTable.end(),
                        [&](const UnknownExtension& unknown) { return unknown.name == name; }))
            return true;
    }
    return false;
}

// glslang's tables are made once for the process; its parser is safe for threads after that.
void initializeOnce() {
    struct Process {
        Process() { glslang::InitializeProcess(); }
        ~Process() { glslang::FinalizeProcess(); }
    };
    static const Process process;
}

EShLanguage glslangStage(ShaderStage stage) {
    switch (stage) {
    case ShaderStage::Vertex:
        return EShLangVertex;
    case ShaderStage::Geometry:
        return EShLangGeometry;
    case ShaderStage::Fragment:
        return EShLangFragment;
    case ShaderStage::Compute:
        break;
    }
    return EShLangCompute;
}

// Neither SPIR-V rules nor an environment: this is GLSL for a GL driver, where locations and bindings may be
// left out.
constexpr auto messages = static_cast<EShMessages>(EShMsgSuppressWarnings);

} // namespace

std::span<const UnknownExtension> unknownExtensions() { return extensionTable; }

bool glslangKnows(const ComposedProgram& program) {
    return std::none_of(program.stages.begin(), program.stages.end(), usesUnknownExtension);
}

std::vector<Problem> validate(const ComposedProgram& program) {
    if (!glslangKnows(program)) return {};
    initializeOnce();
    std::vector<Problem> problems;
    std::vector<std::unique_ptr<glslang::TShader>> shaders; // outlive `linked`, which refers to them
    glslang::TProgram linked;
    for (const ComposedStage& stage : program.stages) {
        auto shader = std::make_unique<glslang::TShader>(glslangStage(stage.stage));
        const char* text = stage.text.c_str();
        shader->setStrings(&text, 1);
        if (!shader->parse(GetDefaultResources(), 460, ECoreProfile, false, false, messages)) {
            std::vector<Problem> found = mapShaderLog(shader->getInfoLog(), stage);
            if (found.empty()) found.push_back({{stage.file}, "glslang refuses the stage without a reason"});
            problems.insert(problems.end(), found.begin(), found.end());
        }
        linked.addShader(shader.get());
        shaders.push_back(std::move(shader));
    }
    if (!problems.empty() || linked.link(messages)) return problems;
    problems = mapLinkLog(linked.getInfoLog(), program);
    if (problems.empty()) problems.push_back({{program.name}, "glslang cannot link it and gives no reason"});
    return problems;
}

} // namespace kestrel
