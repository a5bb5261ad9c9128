#include "shader/validate.h"
#include "shader/glslang_program.h"
#include "shader/lines.h"
#include <algorithm>
#include <array>

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

} // namespace

std::span<const UnknownExtension> unknownExtensions() { return extensionTable; }

bool glslangKnows(const ComposedProgram& program) {
    return std::none_of(program.stages.begin(), program.stages.end(), usesUnknownExtension);
}

std::vector<Problem> validate(const ComposedProgram& program) {
    if (!glslangKnows(program)) return {};
    return GlslangProgram(program).problems();
}

} // namespace kestrel
