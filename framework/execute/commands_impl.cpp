#include "execute/commands_impl.h"
#include "core/check.h"
#include "draw/draw_calls.h"
#include "draw/draw_layers.h"
#include "draw/gpu_scene.h"
#include "gl/loader.h"
#include <algorithm>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

namespace kestrel {

StepCommands::StepCommands(const Context& context, int step, Programs::Entry* program,
                           std::optional<glm::uvec2> targetSize)
    : context_(context)
    , step_(step)
    , program_(program)
    , targetSize_(targetSize) {}

const PlanStep& StepCommands::step() const { return context_.plan.steps.at(static_cast<size_t>(step_)); }

const PlanPass& StepCommands::pass() const {
    return context_.plan.passes.at(static_cast<size_t>(step().pass));
}

void StepCommands::fail(const std::string& message) const {
    throw InputError(fmt::format("pass '{}', step '{}': {}", pass().name, step().step.name, message));
}

// ---- what is known

bool StepCommands::uses(std::string_view port) const {
    const std::vector<Use>& all = step().step.uses;
    return std::any_of(all.begin(), all.end(), [&](const Use& use) { return use.port == port; });
}

const Desc& StepCommands::desc(std::string_view port) const {
    const auto found = pass().descs.find(std::string(port));
    if (found == pass().descs.end()) fail(fmt::format("nothing stands behind port '{}'", port));
    return found->second;
}

Causes StepCommands::causes() const { return context_.states.at(static_cast<size_t>(step().pass)).causes; }

Causes StepCommands::causes(std::string_view input) const {
    return inputCauses(pass(), input, context_.states);
}

// ---- the program

gl::Program& StepCommands::program() {
    if (program_ == nullptr) fail("the step has no program");
    return *program_->program;
}

int StepCommands::uniform(std::string_view name) {
    const int location = program().uniform(name);
    if (location < 0 && !program().mentions(name))
        fail(fmt::format("{} has no uniform '{}'", program_->name, name));
    return location;
}

void StepCommands::set(std::string_view name, int value) {
    glProgramUniform1i(program().name(), uniform(name), value);
}
void StepCommands::set(std::string_view name, std::uint32_t value) {
    glProgramUniform1ui(program().name(), uniform(name), value);
}
void StepCommands::set(std::string_view name, float value) {
    glProgramUniform1f(program().name(), uniform(name), value);
}
void StepCommands::set(std::string_view name, const glm::vec2& value) {
    glProgramUniform2fv(program().name(), uniform(name), 1, glm::value_ptr(value));
}
void StepCommands::set(std::string_view name, const glm::vec3& value) {
    glProgramUniform3fv(program().name(), uniform(name), 1, glm::value_ptr(value));
}
void StepCommands::set(std::string_view name, const glm::vec4& value) {
    glProgramUniform4fv(program().name(), uniform(name), 1, glm::value_ptr(value));
}
void StepCommands::set(std::string_view name, const glm::ivec2& value) {
    glProgramUniform2iv(program().name(), uniform(name), 1, glm::value_ptr(value));
}
void StepCommands::set(std::string_view name, const glm::ivec3& value) {
    glProgramUniform3iv(program().name(), uniform(name), 1, glm::value_ptr(value));
}
void StepCommands::set(std::string_view name, const glm::mat3& value) {
    glProgramUniformMatrix3fv(program().name(), uniform(name), 1, GL_FALSE, glm::value_ptr(value));
}
void StepCommands::set(std::string_view name, const glm::mat4& value) {
    glProgramUniformMatrix4fv(program().name(), uniform(name), 1, GL_FALSE, glm::value_ptr(value));
}

// ---- work

void StepCommands::dispatch(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    static_cast<void>(program());
    if (x == 0 || y == 0 || z == 0) return;
    constexpr std::uint32_t most = 65535; // what OpenGL guarantees per axis
    if (std::max({x, y, z}) > most)
        fail(fmt::format("a dispatch of {} x {} x {} work groups, the most per axis is {}", x, y, z, most));
    glDispatchCompute(x, y, z);
}

void StepCommands::dispatchOver(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const glm::uvec3 local = program().localSize();
    const auto groups = [](std::uint32_t count, std::uint32_t size) { return (count + size - 1) / size; };
    dispatch(groups(x, local.x), groups(y, local.y), groups(z, local.z));
}

void StepCommands::dispatchIndirect(std::string_view port, std::uint64_t offset) {
    static_cast<void>(program());
    const gl::Buffer& counts = bufferOf(port);
    if (offset % 4 != 0 || offset + 12 > counts.bytes())
        fail(fmt::format("an indirect dispatch at byte {} of '{}', which has {}", offset, port,
                         counts.bytes()));
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, counts.name());
    glDispatchComputeIndirect(static_cast<GLintptr>(counts.offset() + offset));
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, 0);
}

void StepCommands::beginDraw(const DrawState& state) {
    static_cast<void>(program());
    if (targetSize_) return;
    if (!state.viewport) fail("a draw without attachments needs DrawState::viewport");
    const glm::uvec2 size = *state.viewport, second = state.secondViewport.value_or(size);
    const glm::uvec2 area = glm::max(size, second);
    glBindFramebuffer(GL_FRAMEBUFFER, context_.framebuffers.get({}, {}, {area.x, area.y, 1}));
    setViewport(size);
    if (state.secondViewport)
        glViewportIndexedf(1, 0, 0, static_cast<float>(second.x), static_cast<float>(second.y));
}

void StepCommands::drawScene(const DrawState& state, const std::vector<TriangleClass>& classes) {
    beginDraw(state);
    context_.frame.gpu->draw(state, classes, program());
}

void StepCommands::drawSceneLayers(const DrawState& state, const std::vector<TriangleClass>& classes,
                                   std::uint32_t count,
                                   const std::function<void(std::uint32_t layer)>& perLayer) {
    static_cast<void>(program());
    if (context_.target.empty()) fail("a draw of layers needs attachments");
    for (const gl::Attachment* attachment : context_.target.attachments()) {
        const std::uint32_t layers = attachment->layer < 0 ? attachment->texture->layers(attachment->mip) : 1;
        if (count > layers)
            fail(fmt::format("a draw of {} layers into {}, of which {} are attached", count,
                             describe(attachment->texture->desc()), layers));
    }
    eachLayer(context_.framebuffers, context_.target, count, [&](std::uint32_t layer) {
        perLayer(layer);
        context_.frame.gpu->draw(state, classes, program());
    });
}

void StepCommands::drawFullscreen(const DrawState& state) {
    beginDraw(state);
    kestrel::drawFullscreen(state, context_.noVertices);
}

void StepCommands::drawVertices(const DrawState& state, std::uint32_t count, std::uint32_t instances) {
    beginDraw(state);
    kestrel::drawVertices(state, context_.noVertices, count, instances);
}

void StepCommands::drawVerticesIndirect(const DrawState& state, std::string_view port, std::uint64_t offset) {
    const gl::Buffer& counts = bufferOf(port);
    if (offset % 4 != 0 || offset + 16 > counts.bytes())
        fail(fmt::format("an indirect draw at byte {} of '{}', which has {}", offset, port, counts.bytes()));
    beginDraw(state);
    kestrel::drawVerticesIndirect(state, context_.noVertices, counts, offset);
}

// ---- data

int StepCommands::resourceOf(std::string_view port) const {
    for (const PlanBinding& binding : step().bindings)
        if (binding.path.empty() && binding.port == port && !binding.previous) return binding.resource;
    fail(fmt::format("port '{}' is not among the step's uses", port));
}

gl::Texture& StepCommands::textureOf(std::string_view port) const {
    const int resource = resourceOf(port);
    if (context_.resources.isBuffer(resource)) fail(fmt::format("port '{}' holds a buffer", port));
    return context_.resources.texture(resource);
}

gl::Buffer& StepCommands::bufferOf(std::string_view port) const {
    const int resource = resourceOf(port);
    if (!context_.resources.isBuffer(resource)) fail(fmt::format("port '{}' holds a texture", port));
    return context_.resources.buffer(resource);
}

const gl::Texture& StepCommands::texture(std::string_view port) const { return textureOf(port); }
const gl::Buffer& StepCommands::buffer(std::string_view port) const { return bufferOf(port); }

void StepCommands::upload(std::string_view port, std::span<const std::byte> bytes, std::uint64_t offset) {
    if (bytes.empty()) return;
    gl::Buffer& target = bufferOf(port);
    if (offset + bytes.size() > target.bytes())
        fail(fmt::format("{} bytes at {} do not fit into '{}', which has {}", bytes.size(), offset, port,
                         target.bytes()));
    target.upload(bytes, offset);
}

void StepCommands::uploadImage(std::string_view port, const Image& image) {
    textureOf(port).uploadImage(image);
}

std::vector<std::byte> StepCommands::download(std::string_view port) {
    const int resource = resourceOf(port);
    if (context_.resources.isBuffer(resource)) return context_.resources.buffer(resource).download();
    return context_.resources.texture(resource).download();
}

Image StepCommands::downloadImage(std::string_view port, int layer, int mip) {
    return textureOf(port).downloadImage(layer, mip);
}

void StepCommands::clear(std::string_view port, const glm::vec4& value) {
    context_.resources.fill(resourceOf(port), value);
}

void StepCommands::generateMips(std::string_view port) { textureOf(port).generateMips(); }

// ---- what the pass tells

void StepCommands::overflow(std::string_view port, std::uint64_t elements) {
    if (!pass().descs.contains(std::string(port)))
        fail(fmt::format("an overflow of port '{}', which it does not have", port));
    std::uint64_t& needed = context_.report.overflows[pass().name][std::string(port)];
    needed = std::max(needed, elements);
}

void StepCommands::report(std::string_view key, double value) {
    context_.report.values[pass().name][std::string(key)] = value;
}

void StepCommands::progress(double fraction) {
    if (context_.report.progress) context_.report.progress(context_.report.step, fraction);
}

} // namespace kestrel
