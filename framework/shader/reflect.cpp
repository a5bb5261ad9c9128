#include "shader/reflect.h"
#include "shader/glslang_program.h"
#include "shader/validate.h"
#include <algorithm>
#include <fmt/format.h>
#include <glslang/Include/Types.h>

namespace kestrel {
namespace {

// Buffers apart from uniforms, all members of a block whether read or not, and one entry for the elements of
// an array of structs.
constexpr int options =
    EShReflectionSeparateBuffers | EShReflectionAllBlockVariables | EShReflectionStrictArraySuffix;

std::string vectorPrefix(glslang::TBasicType type) {
    switch (type) {
    case glslang::EbtDouble:
        return "d";
    case glslang::EbtInt:
        return "i";
    case glslang::EbtUint:
        return "u";
    case glslang::EbtBool:
        return "b";
    case glslang::EbtInt64:
        return "i64";
    case glslang::EbtUint64:
        return "u64";
    default:
        return {};
    }
}

// glslang's strings have an allocator of their own.
std::string plain(const glslang::TString& text) { return {text.begin(), text.end()}; }

// A type as GLSL writes it, without array brackets.
std::string typeName(const glslang::TType& type) {
    if (type.isMatrix()) {
        const int columns = type.getMatrixCols();
        const int rows = type.getMatrixRows();
        const std::string prefix = vectorPrefix(type.getBasicType()) + "mat";
        return columns == rows ? fmt::format("{}{}", prefix, columns)
                               : fmt::format("{}{}x{}", prefix, columns, rows);
    }
    if (type.isVector())
        return fmt::format("{}vec{}", vectorPrefix(type.getBasicType()), type.getVectorSize());
    if (type.getBasicType() == glslang::EbtSampler) return plain(type.getSampler().getString());
    if (type.isStruct()) return plain(type.getTypeName());
    return plain(type.getBasicTypeString());
}

std::vector<ShaderStage> stagesOf(EShLanguageMask mask) {
    std::vector<ShaderStage> stages;
    for (const ShaderStage stage :
         {ShaderStage::Vertex, ShaderStage::Geometry, ShaderStage::Fragment, ShaderStage::Compute}) {
        if (mask & (1 << glslangStage(stage))) stages.push_back(stage);
    }
    return stages;
}

int arraySizeOf(const glslang::TType& type) {
    if (!type.isArray()) return 0;
    return type.isUnsizedArray() ? -1 : type.getCumulativeArraySize();
}

// Whether a member lies in another than the first struct of an array: in uniform blocks glslang lists them
// all.
bool isFurtherElement(const std::string& name) {
    for (size_t open = name.find('['); open != std::string::npos; open = name.find('[', open + 1)) {
        if (name.compare(open, 3, "[0]") != 0) return true;
    }
    return false;
}

BlockMember memberOf(const glslang::TObjectReflection& variable, const std::string& block) {
    const glslang::TType& type = *variable.getType();
    BlockMember member;
    // Members of a block with an instance name are called "Block.member".
    member.name =
        variable.name.starts_with(block + ".") ? variable.name.substr(block.size() + 1) : variable.name;
    member.type = typeName(type);
    member.offset = static_cast<std::size_t>(variable.offset);
    member.arraySize = arraySizeOf(type);
    member.arrayStride = type.isArray() ? variable.arrayStride : 0;
    member.topLevelStride = member.name.find('[') == std::string::npos ? 0 : variable.topLevelArrayStride;
    return member;
}

ShaderResource blockOf(const glslang::TObjectReflection& block, ShaderResource::Kind kind) {
    ShaderResource resource;
    resource.kind = kind;
    resource.name = block.name;
    resource.type = block.name;
    resource.size = static_cast<std::size_t>(block.size);
    resource.arraySize = arraySizeOf(*block.getType());
    resource.stages = stagesOf(block.stages);
    return resource;
}

ShaderResource looseUniformOf(const glslang::TObjectReflection& uniform) {
    const glslang::TType& type = *uniform.getType();
    ShaderResource resource;
    resource.name = uniform.name;
    resource.type = typeName(type);
    resource.arraySize = arraySizeOf(type);
    resource.stages = stagesOf(uniform.stages);
    if (type.getBasicType() == glslang::EbtSampler) {
        const bool image = type.getSampler().isImage();
        resource.kind = image ? ShaderResource::Image : ShaderResource::Sampler;
        if (image && type.getQualifier().hasFormat())
            resource.format = glslang::TQualifier::getLayoutFormatString(type.getQualifier().getFormat());
    }
    return resource;
}

// glslang lists the blocks of a kind, and apart from them the variables, each with the index of its block.
class Collector {
public:
    explicit Collector(glslang::TProgram& program)
        : program_(program) {}

    Reflection collect() {
        for (int i = 0; i < program_.getNumUniformBlocks(); ++i)
            addBlock(program_.getUniformBlock(i), ShaderResource::UniformBlock);
        for (int i = 0; i < program_.getNumBufferBlocks(); ++i)
            addBlock(program_.getBufferBlock(i), ShaderResource::StorageBlock);
        for (int i = 0; i < program_.getNumUniformVariables(); ++i) addUniform(program_.getUniform(i));
        for (int i = 0; i < program_.getNumBufferVariables(); ++i)
            addMember(program_.getBufferVariable(i),
                      program_.getBufferBlock(program_.getBufferVariable(i).index));
        finish();
        return std::move(reflection_);
    }

private:
    void addBlock(const glslang::TObjectReflection& block, ShaderResource::Kind kind) {
        reflection_.resources.push_back(blockOf(block, kind));
    }
    void addUniform(const glslang::TObjectReflection& uniform) {
        if (uniform.index >= 0) {
            addMember(uniform, program_.getUniformBlock(uniform.index));
        } else {
            reflection_.resources.push_back(looseUniformOf(uniform));
        }
    }
    void addMember(const glslang::TObjectReflection& variable, const glslang::TObjectReflection& block) {
        if (isFurtherElement(variable.name)) return;
        for (ShaderResource& resource : reflection_.resources) {
            if (resource.name == block.name) resource.members.push_back(memberOf(variable, block.name));
        }
    }
    void finish() {
        for (ShaderResource& resource : reflection_.resources)
            std::stable_sort(resource.members.begin(), resource.members.end(),
                             [](const auto& a, const auto& b) { return a.offset < b.offset; });
        std::sort(reflection_.resources.begin(), reflection_.resources.end(),
                  [](const auto& a, const auto& b) { return a.name < b.name; });
    }

    glslang::TProgram& program_;
    Reflection reflection_;
};

} // namespace

const BlockMember* ShaderResource::member(std::string_view wanted) const {
    const auto found = std::find_if(members.begin(), members.end(),
                                    [&](const BlockMember& candidate) { return candidate.name == wanted; });
    return found == members.end() ? nullptr : &*found;
}

const ShaderResource* Reflection::find(std::string_view name) const {
    const auto found = std::find_if(resources.begin(), resources.end(),
                                    [&](const ShaderResource& candidate) { return candidate.name == name; });
    return found == resources.end() ? nullptr : &*found;
}

Reflection reflect(const ComposedProgram& program) {
    if (!glslangKnows(program))
        throw InputError({program.name}, "uses an extension that glslang does not know: only the driver can "
                                         "list its resources");
    GlslangProgram parsed(program);
    if (!parsed.problems().empty()) throw InputError(parsed.problems());
    if (!parsed.linked().buildReflection(options))
        throw InputError({program.name}, "glslang cannot list the resources of the program");
    Reflection reflection = Collector(parsed.linked()).collect();
    if (program.stages.front().stage == ShaderStage::Compute) {
        for (int i = 0; i < 3; ++i)
            reflection.localSize[static_cast<size_t>(i)] = static_cast<int>(parsed.linked().getLocalSize(i));
    }
    return reflection;
}

} // namespace kestrel
