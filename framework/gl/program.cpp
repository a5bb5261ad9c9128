#include "gl/program.h"
#include "core/error.h"
#include "gl/debug_output.h"
#include "gl/loader.h"
#include "gl/program_cache.h"
#include "gl/program_link.h"
#include "shader/lines.h"
#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace kestrel::gl {

void deleteProgram(Name name) { glDeleteProgram(name); }

namespace {

enum class Family : std::uint8_t { Plain, Sampler, Image };

struct UniformType {
    Family family = Family::Plain;
    bool layered = false, texels = false;
};

UniformType uniformType(GLenum type) {
    switch (type) {
    case GL_SAMPLER_1D:
    case GL_SAMPLER_2D:
    case GL_SAMPLER_2D_SHADOW:
    case GL_SAMPLER_2D_MULTISAMPLE:
    case GL_INT_SAMPLER_2D:
    case GL_UNSIGNED_INT_SAMPLER_2D:
    case GL_UNSIGNED_INT_SAMPLER_2D_MULTISAMPLE:
        return {Family::Sampler};
    case GL_SAMPLER_3D:
    case GL_INT_SAMPLER_3D:
    case GL_UNSIGNED_INT_SAMPLER_3D:
    case GL_SAMPLER_CUBE:
    case GL_SAMPLER_CUBE_SHADOW:
    case GL_INT_SAMPLER_CUBE:
    case GL_UNSIGNED_INT_SAMPLER_CUBE:
    case GL_SAMPLER_2D_ARRAY:
    case GL_SAMPLER_2D_ARRAY_SHADOW:
    case GL_INT_SAMPLER_2D_ARRAY:
    case GL_UNSIGNED_INT_SAMPLER_2D_ARRAY:
    case GL_SAMPLER_CUBE_MAP_ARRAY:
        return {Family::Sampler, true};
    case GL_SAMPLER_BUFFER:
    case GL_INT_SAMPLER_BUFFER:
    case GL_UNSIGNED_INT_SAMPLER_BUFFER:
        return {Family::Sampler, false, true};
    case GL_IMAGE_1D:
    case GL_IMAGE_2D:
    case GL_INT_IMAGE_2D:
    case GL_UNSIGNED_INT_IMAGE_2D:
        return {Family::Image};
    case GL_IMAGE_3D:
    case GL_INT_IMAGE_3D:
    case GL_UNSIGNED_INT_IMAGE_3D:
    case GL_IMAGE_CUBE:
    case GL_INT_IMAGE_CUBE:
    case GL_UNSIGNED_INT_IMAGE_CUBE:
    case GL_IMAGE_2D_ARRAY:
    case GL_INT_IMAGE_2D_ARRAY:
    case GL_UNSIGNED_INT_IMAGE_2D_ARRAY:
        return {Family::Image, true};
    case GL_IMAGE_BUFFER:
    case GL_INT_IMAGE_BUFFER:
    case GL_UNSIGNED_INT_IMAGE_BUFFER:
        return {Family::Image, false, true};
    default:
        return {};
    }
}

constexpr GLenum stageReferences[] = {GL_REFERENCED_BY_VERTEX_SHADER, GL_REFERENCED_BY_GEOMETRY_SHADER,
                                      GL_REFERENCED_BY_FRAGMENT_SHADER, GL_REFERENCED_BY_COMPUTE_SHADER};
constexpr size_t stageCount = std::size(stageReferences);

// Hands out the units of one kind and counts what each stage needs.
struct Units {
    const char* what;
    unsigned int next = 0;
    unsigned int perStage[stageCount] = {};

    unsigned int take(unsigned int count, const GLint (&references)[stageCount]) {
        for (size_t i = 0; i < stageCount; ++i)
            if (references[i] != 0) perStage[i] += count;
        return std::exchange(next, next + count);
    }
    void require(const std::string& program, int stageLimit, int totalLimit,
                 std::vector<Problem>& problems) const {
        const unsigned int largest = *std::max_element(std::begin(perStage), std::end(perStage));
        if (largest > static_cast<unsigned int>(stageLimit))
            problems.push_back(
                {{program, 0, 0},
                 fmt::format("a stage uses {} {}, the device has {} a stage", largest, what, stageLimit)});
        else if (next > static_cast<unsigned int>(totalLimit))
            problems.push_back(
                {{program, 0, 0},
                 fmt::format("the program uses {} {}, the device has {}", next, what, totalLimit)});
    }
};

// One active resource of a program interface.
struct Resource {
    std::string name;
    GLint location = -1, type = 0, arraySize = 1, block = -1;
    GLint references[stageCount] = {};
};

template<class Visit>
void forEachResource(Name program, GLenum interface, Visit visit) {
    GLint count = 0;
    GLint longestName = 0;
    glGetProgramInterfaceiv(program, interface, GL_ACTIVE_RESOURCES, &count);
    glGetProgramInterfaceiv(program, interface, GL_MAX_NAME_LENGTH, &longestName);
    std::string name(static_cast<size_t>(std::max(longestName, 1)), '\0');
    for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
        Resource resource;
        GLsizei written = 0;
        glGetProgramResourceName(program, interface, i, longestName, &written, name.data());
        resource.name.assign(name.data(), static_cast<size_t>(written));
        if (interface == GL_UNIFORM) {
            constexpr GLenum asked[] = {GL_LOCATION, GL_TYPE, GL_ARRAY_SIZE, GL_BLOCK_INDEX};
            GLint values[4] = {};
            glGetProgramResourceiv(program, interface, i, 4, asked, 4, nullptr, values);
            resource.location = values[0];
            resource.type = values[1];
            resource.arraySize = values[2];
            resource.block = values[3];
        }
        glGetProgramResourceiv(program, interface, i, stageCount, stageReferences, stageCount, nullptr,
                               resource.references);
        visit(i, resource);
    }
}

// GL lists an array of uniforms by its first element.
std::string withoutBrackets(const std::string& name) {
    return name.ends_with("[0]") ? name.substr(0, name.size() - 3) : name;
}

} // namespace

Program::Program(const ComposedProgram& composed, const std::vector<std::string>& attachments,
                 const Capabilities& capabilities) {
    handle_ = Handle<deleteProgram>(glCreateProgram());
    setLabel(GL_PROGRAM, name(), composed.name);
    const ProgramCache cache(composed, attachments);
    fromCache_ = cache.load(name());
    if (!fromCache_) {
        cache.prepare(name());
        linkProgram(name(), composed, attachments);
        cache.store(name());
    }
    requireAttachments(name(), composed, attachments);
    if (composed.stages.front().stage == ShaderStage::Compute) {
        GLint size[3] = {1, 1, 1};
        glGetProgramiv(name(), GL_COMPUTE_WORK_GROUP_SIZE, size);
        localSize_ = {size[0], size[1], size[2]};
    }
    for (const ComposedStage& stage : composed.stages) texts_.push_back(stage.text);
    readResources(composed, capabilities);
}

void Program::readResources(const ComposedProgram& composed, const Capabilities& capabilities) {
    Units samplers{"samplers"};
    Units images{"images"};
    Units uniformBlocks{"uniform blocks"};
    Units storageBlocks{"storage blocks"};
    forEachResource(name(), GL_UNIFORM, [&](GLuint, const Resource& resource) {
        if (resource.block >= 0 || resource.location < 0) return;
        const UniformType type = uniformType(static_cast<GLenum>(resource.type));
        const std::string plain = withoutBrackets(resource.name);
        if (type.family == Family::Plain) {
            uniforms_[resource.name] = resource.location;
            uniforms_[plain] = resource.location;
            return;
        }
        Units& units = type.family == Family::Sampler ? samplers : images;
        Slot slot;
        slot.kind = type.family == Family::Sampler ? Slot::Kind::Sampler : Slot::Kind::Image;
        slot.array3D = type.layered;
        slot.texels = type.texels;
        slot.count = resource.arraySize;
        slot.unit = units.take(static_cast<unsigned int>(resource.arraySize), resource.references);
        std::vector<GLint> numbers(static_cast<size_t>(resource.arraySize));
        for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<GLint>(slot.unit + i);
        glProgramUniform1iv(name(), resource.location, resource.arraySize, numbers.data());
        slots_[plain] = slot;
    });
    forEachResource(name(), GL_UNIFORM_BLOCK, [&](GLuint index, const Resource& resource) {
        Slot slot;
        slot.kind = Slot::Kind::UniformBlock;
        slot.unit = uniformBlocks.take(1, resource.references);
        glUniformBlockBinding(name(), index, slot.unit);
        slots_[resource.name] = slot;
    });
    forEachResource(name(), GL_SHADER_STORAGE_BLOCK, [&](GLuint index, const Resource& resource) {
        Slot slot;
        slot.kind = Slot::Kind::StorageBlock;
        slot.unit = storageBlocks.take(1, resource.references);
        glShaderStorageBlockBinding(name(), index, slot.unit);
        slots_[resource.name] = slot;
    });

    std::vector<Problem> problems;
    samplers.require(composed.name, capabilities.maxTextureUnits,
                     glInteger(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS), problems);
    images.require(composed.name, capabilities.maxComputeImages, glInteger(GL_MAX_IMAGE_UNITS), problems);
    uniformBlocks.require(composed.name, capabilities.maxUniformBlocks,
                          glInteger(GL_MAX_UNIFORM_BUFFER_BINDINGS), problems);
    storageBlocks.require(composed.name, capabilities.maxStorageBlocks,
                          glInteger(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS), problems);
    if (!problems.empty()) throw InputError(std::move(problems));
}

void Program::use() const { glUseProgram(name()); }

std::optional<Program::Slot> Program::slot(std::string_view name) const {
    const auto found = slots_.find(name);
    if (found == slots_.end()) return std::nullopt;
    return found->second;
}

std::vector<std::string> Program::slotNames() const {
    std::vector<std::string> names;
    for (const auto& [name, slot] : slots_) names.push_back(name);
    return names;
}

int Program::uniform(std::string_view name) const {
    const auto found = uniforms_.find(name);
    return found == uniforms_.end() ? -1 : found->second;
}

bool Program::mentions(std::string_view name) const {
    if (!identifiers_) {
        identifiers_.emplace();
        for (const std::string& text : texts_)
            for (const ShaderLine& line : shaderLines(text))
                for (const std::string_view identifier : identifiersOf(line.code))
                    identifiers_->emplace(identifier);
    }
    return identifiers_->contains(name);
}

} // namespace kestrel::gl
