// A program parsed and linked by glslang; the one place that touches its set-up.
#pragma once
#include "core/error.h"
#include "shader/compose.h"
#include <glslang/Public/ShaderLang.h>
#include <memory>
#include <vector>

namespace kestrel {

class GlslangProgram {
public:
    // Parses each stage as GLSL 4.60 core for OpenGL, then links if all of them parse.
    explicit GlslangProgram(const ComposedProgram& program);

    // What is wrong; empty if the program is linked.
    [[nodiscard]] const std::vector<Problem>& problems() const { return problems_; }
    [[nodiscard]] glslang::TProgram& linked() { return *linked_; }

private:
    std::vector<Problem> problems_;
    std::vector<std::unique_ptr<glslang::TShader>> shaders_; // outlive linked_, which refers to them
    std::unique_ptr<glslang::TProgram> linked_;
};

EShLanguage glslangStage(ShaderStage stage);

} // namespace kestrel
