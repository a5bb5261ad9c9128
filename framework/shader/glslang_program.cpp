#include "shader/glslang_program.h"
#include "shader/problems.h"
#include <glslang/Public/ResourceLimits.h>

namespace kestrel {
namespace {

// glslang's tables are made once for the process; its parser is safe for threads after that.
void initializeOnce() {
    struct Process {
        Process() { glslang::InitializeProcess(); }
        ~Process() { glslang::FinalizeProcess(); }
    };
    static const Process process;
}

// Neither SPIR-V rules nor an environment: this is GLSL for a GL driver, where locations and bindings may be
// left out.
constexpr auto messages = static_cast<EShMessages>(EShMsgSuppressWarnings);

} // namespace

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

GlslangProgram::GlslangProgram(const ComposedProgram& program)
    : linked_(std::make_unique<glslang::TProgram>()) {
    initializeOnce();
    for (const ComposedStage& stage : program.stages) {
        auto shader = std::make_unique<glslang::TShader>(glslangStage(stage.stage));
        const char* text = stage.text.c_str();
        shader->setStrings(&text, 1);
        if (!shader->parse(GetDefaultResources(), 460, ECoreProfile, false, false, messages)) {
            std::vector<Problem> found = mapShaderLog(shader->getInfoLog(), stage);
            if (found.empty()) found.push_back({{stage.file}, "glslang refuses the stage without a reason"});
            problems_.insert(problems_.end(), found.begin(), found.end());
        }
        linked_->addShader(shader.get());
        shaders_.push_back(std::move(shader));
    }
    if (!problems_.empty() || linked_->link(messages)) return;
    problems_ = mapLinkLog(linked_->getInfoLog(), program);
    if (problems_.empty())
        problems_.push_back({{program.name}, "glslang cannot link it and gives no reason"});
}

} // namespace kestrel
