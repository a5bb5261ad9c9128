#include "execute/executor.h"
#include "core/check.h"
#include "draw/gpu_scene.h"
#include "gl/debug_output.h"
#include "gl/loader.h"
#include "graph/guard.h"
#include "shader/iterations.h"
#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <set>
#include <utility>

namespace kestrel {

namespace {

// What views look from in this frame and in the last one.
FrameViews viewsOf(const FrameScene& frame) {
    const Sphere bounds = frame.facts != nullptr ? frame.facts->sphere : Sphere{};
    const std::vector<LightState>* before = frame.previousLights;
    return {frame.info,
            {frame.scene, frame.info.time, frame.lights, bounds, frame.info.cameraState},
            {frame.scene, frame.previousTime, before != nullptr ? before : frame.lights, bounds,
             frame.info.previousCameraState}};
}

class DebugGroup {
public:
    DebugGroup(int id, const std::string& label) { gl::pushDebugGroup(static_cast<unsigned int>(id), label); }
    ~DebugGroup() { glPopDebugGroup(); }
    DebugGroup(const DebugGroup&) = delete;
    DebugGroup& operator=(const DebugGroup&) = delete;
};

GLbitfield barrierBits(Barrier barrier) {
    static constexpr std::pair<Barrier, GLbitfield> table[] = {
        {Barrier::VertexAttrib, GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT},
        {Barrier::Uniform, GL_UNIFORM_BARRIER_BIT},
        {Barrier::TextureFetch, GL_TEXTURE_FETCH_BARRIER_BIT},
        {Barrier::ShaderImage, GL_SHADER_IMAGE_ACCESS_BARRIER_BIT},
        {Barrier::Command, GL_COMMAND_BARRIER_BIT},
        {Barrier::BufferUpdate, GL_BUFFER_UPDATE_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                                    GL_PIXEL_BUFFER_BARRIER_BIT | GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT},
        {Barrier::Framebuffer, GL_FRAMEBUFFER_BARRIER_BIT},
        {Barrier::ShaderStorage, GL_SHADER_STORAGE_BARRIER_BIT},
    };
    GLbitfield bits = 0;
    for (const auto& [name, bit] : table)
        if ((barrier & name) != Barrier::None) bits |= bit;
    return bits;
}

} // namespace

Executor::Executor(const Capabilities& capabilities, std::vector<std::filesystem::path> shaderFolders)
    : capabilities_(capabilities)
    , library_(std::move(shaderFolders))
    , noVertices_("no attributes")
    , frameBlock_(sizeof(shared::FrameData), "Frame") {}

Executor::~Executor() = default;

const Plan& Executor::plan() const {
    KESTREL_CHECK(plan_ != nullptr);
    return *plan_;
}

// ---- frames

void Executor::beginFrame(const FrameScene& frame) {
    const FrameInfo& info = frame.info;
    const Sphere& sphere = frame.facts->sphere;
    shared::FrameData data{};
    data.size = {info.size.width, info.size.height};
    data.index = info.index;
    data.seed = info.seed;
    data.time = static_cast<float>(info.time);
    data.sceneBounds = glm::vec4(sphere.centre, sphere.radius);
    frameBlock_.upload(std::as_bytes(std::span(&data, 1)));
    if (iterations_.bytes() > 0) iterations_.clear(0);
    if (options.timing && !clock_) clock_ = std::make_unique<gl::StepClock>(makeClock());
    if (options.timing) clock_->beginFrame(info.index);
}

bool Executor::run(const FrameScene& frame, Causes events) {
    const Plan& current = plan();
    if (!unfinished_) {
        for (PassState& state : states_) state.done = false;
        samples_.clear();
        report_.bad.clear();
    }
    report_.overflows.clear();
    uncounted_.clear();
    schedule(current, events, lastEvents_, states_);
    // What came up stays pending until the pass has run, also if the frame is left early.
    for (PassState& state : states_)
        if (state.runs) state.pending |= state.causes;

    try {
        beginFrame(frame);
        unfinished_ = true;
        for (size_t i = 0; i < current.passes.size(); ++i) {
            if (!states_[i].runs) continue;
            // What keeps something cannot run twice: what it builds on is known to be whole first.
            const bool counted =
                uncounted_.empty() || current.passes[i].repeatable || countersBehind_[i].empty();
            if (!counted && !countersFit()) return false;
            if (!runPass(static_cast<int>(i), frame)) return false;
            states_[i].pending = Causes::None;
            states_[i].done = true;
            if (!current.passes[i].counters.empty()) uncounted_.push_back(static_cast<int>(i));
        }
        if (!countersFit()) return false;
        collectSamples(frame.info.index);
        // Whoever reads the results back sees what shaders wrote.
        glMemoryBarrier(barrierBits(Barrier::BufferUpdate));
        checkIterations();
    } catch (...) {
        abandonFrame();
        throw;
    }
    unfinished_ = false;
    lastEvents_ = events;
    return true;
}

void Executor::rewind() {
    for (size_t i = 0; i < states_.size(); ++i)
        if (dependsOnFrames(plan().passes[i])) states_[i].pending = Causes::All;
    lastEvents_ = Causes::All;
}

void Executor::abandonFrame() {
    unfinished_ = false;
    clock_.reset(); // it may stand in the middle of a step
}

bool Executor::runPass(int index, const FrameScene& frame) {
    const PlanPass& pass = plan().passes.at(static_cast<size_t>(index));
    swapHistories(pass);
    for (const auto& [port, resource] : pass.ports)
        if (resource >= 0 && resources_.info(resource).port.pass == pass.name)
            views_.produced(resource, resources_.info(resource).desc.view, viewsOf(frame));
    for (int step = pass.firstStep; step < pass.firstStep + pass.stepCount; ++step) {
        runStep(step, frame);
        if (report_.overflows.empty()) continue;
        swapHistories(pass); // back: the pass runs again
        return false;
    }
    if (options.checkFinite) checkOutputs(pass);
    return true;
}

bool Executor::countersFit() {
    std::vector<std::pair<int, const PlanCounter*>> counters;
    for (const int pass : std::exchange(uncounted_, {}))
        for (const PlanCounter& counter : plan().passes[static_cast<size_t>(pass)].counters)
            counters.emplace_back(pass, &counter);
    if (counters.empty()) return true;
    if (counts_.bytes() < 4 * counters.size()) counts_ = gl::Buffer(4 * counters.size(), "Counters");
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    for (size_t i = 0; i < counters.size(); ++i) {
        const gl::Buffer& from = resources_.buffer(counters[i].second->resource);
        glCopyNamedBufferSubData(from.name(), counts_.name(), static_cast<GLintptr>(from.offset()),
                                 static_cast<GLintptr>(4 * i), 4);
    }
    const std::vector<std::byte> bytes = counts_.download();
    std::set<int> tooSmall;
    for (size_t i = 0; i < counters.size(); ++i) {
        std::uint32_t wanted = 0;
        std::memcpy(&wanted, bytes.data() + 4 * i, 4);
        const auto& [pass, counter] = counters[i];
        report_.values[plan().passes[static_cast<size_t>(pass)].name]["elements of " + counter->port] =
            wanted;
        if (wanted <= counter->capacity) continue;
        report_.overflows[plan().passes[static_cast<size_t>(pass)].name][counter->port] = wanted;
        tooSmall.insert(pass);
    }
    if (tooSmall.empty()) return true;
    for (size_t i = 0; i < states_.size(); ++i) {
        PassState& state = states_[i];
        const auto reached = [&](int pass) { return tooSmall.contains(pass); };
        if (!state.runs || !state.done) continue;
        if (!reached(static_cast<int>(i)) && std::ranges::none_of(countersBehind_[i], reached)) continue;
        swapHistories(plan().passes[i]); // back: the pass runs again
        state.done = false;
        state.pending |= state.causes;
    }
    return false;
}

void Executor::swapHistories(const PlanPass& pass) {
    for (const auto& [port, resource] : pass.ports)
        if (resource >= 0 && resources_.info(resource).port.pass == pass.name)
            resources_.swapHistory(resource);
}

void Executor::runStep(int index, const FrameScene& frame) {
    const PlanStep& step = plan().steps.at(static_cast<size_t>(index));
    const PlanPass& pass = plan().passes.at(static_cast<size_t>(step.pass));
    const DebugGroup group(index, labels_[static_cast<size_t>(index)]);
    if (options.timing) clock_->begin(static_cast<std::uint32_t>(index));
    if (step.barrier != Barrier::None) glMemoryBarrier(barrierBits(step.barrier));
    for (const auto& [from, to] : step.copies) resources_.copy(from, to);
    if (index == pass.firstStep) clearOutputs(pass);

    gl::Target attachments;
    const std::optional<glm::uvec2> target = bind(index, frame, attachments);
    report_.step = labels_[static_cast<size_t>(index)];
    if (report_.begins) report_.begins(report_.step);
    const StepCommands::Context context{plan(),        frame,       capabilities_, states_, resources_,
                                        framebuffers_, noVertices_, attachments,   report_};
    StepCommands commands(context, index, programs_.of(index), target);
    guarded(pass.name, "step '" + step.step.name + "'", [&] { pass.instance->execute(step.step, commands); });
    restrictMips(step, bindings_[static_cast<size_t>(index)], false);
    if (options.timing) clock_->end();
}

void Executor::clearOutputs(const PlanPass& pass) {
    bool barrier = false;
    for (const auto& [port, resource] : pass.ports) {
        if (resource < 0) continue;
        const PlanResource& info = resources_.info(resource);
        if (info.port.pass != pass.name || !info.clear) continue;
        // The clear follows what shaders wrote there in earlier frames.
        if (!std::exchange(barrier, true)) glMemoryBarrier(barrierBits(Barrier::BufferUpdate));
        resources_.fill(resource, *info.clear);
    }
}

// ---- binding

std::optional<glm::uvec2> Executor::bind(int index, const FrameScene& frame, gl::Target& target) {
    const PlanStep& step = plan().steps.at(static_cast<size_t>(index));
    const StepBindings& bindings = bindings_.at(static_cast<size_t>(index));
    restrictMips(step, bindings, true);
    if (const Programs::Entry* program = programs_.of(index)) {
        program->program->use();
        for (const StepBindings::Slot& slot : bindings.slots)
            bindSlot(step.bindings.at(static_cast<size_t>(slot.binding)), slot.where);
        for (const StepBindings::ViewSlot& view : bindings.views)
            glBindBufferBase(GL_UNIFORM_BUFFER, view.unit, views_.block(view, viewsOf(frame)));
        if (bindings.frame) glBindBufferBase(GL_UNIFORM_BUFFER, *bindings.frame, frameBlock_.name());
        if (bindings.iterations)
            glBindBufferRange(GL_SHADER_STORAGE_BUFFER, *bindings.iterations, iterations_.name(),
                              static_cast<GLintptr>(index) * iterationsStride, sizeof(IterationsBlock));
        if (bindings.scene) frame.gpu->bind(*program->program);
    }
    return bindTarget(step, bindings, target);
}

void Executor::bindSlot(const PlanBinding& binding, const gl::Program::Slot& slot) {
    const int resource = binding.resource;
    const Desc& desc = resources_.info(resource).desc;
    const bool isBuffer = resources_.isBuffer(resource);
    const auto imageName = [&] {
        return isBuffer ? resources_.buffer(resource, binding.previous).texelView(desc.format)
                        : resources_.texture(resource, binding.previous).name();
    };
    switch (slot.kind) {
    case gl::Program::Slot::Kind::Sampler:
        glBindTextureUnit(slot.unit, imageName());
        glBindSampler(slot.unit,
                      isBuffer ? 0 : samplers_.get({.linear = binding.linear, .mips = desc.mips > 1}));
        break;
    case gl::Program::Slot::Kind::Image: {
        const bool layered = !isBuffer && desc.kind != ResourceKind::Texture2D && binding.layer < 0;
        glBindImageTexture(slot.unit, imageName(), std::max(binding.mip, 0), layered ? GL_TRUE : GL_FALSE,
                           std::max(binding.layer, 0), binding.write ? GL_READ_WRITE : GL_READ_ONLY,
                           gl::glFormat(desc.format).internal);
        break;
    }
    case gl::Program::Slot::Kind::UniformBlock:
        resources_.buffer(resource, binding.previous).bind(GL_UNIFORM_BUFFER, slot.unit);
        break;
    case gl::Program::Slot::Kind::StorageBlock:
        resources_.buffer(resource, binding.previous).bind(GL_SHADER_STORAGE_BUFFER, slot.unit);
        break;
    }
}

std::optional<glm::uvec2> Executor::bindTarget(const PlanStep& step, const StepBindings& bindings,
                                               gl::Target& target) {
    if (bindings.colour.empty() && bindings.depth < 0) return std::nullopt;
    glm::uvec2 size(0);
    const auto attachment = [&](int index) {
        const PlanBinding& binding = step.bindings.at(static_cast<size_t>(index));
        const gl::Texture& texture = resources_.texture(binding.resource, binding.previous);
        const int mip = std::max(binding.mip, 0);
        const Extent extent = texture.extentOf(mip);
        size = {extent.width, extent.height};
        return gl::Attachment{&texture, mip, binding.layer};
    };
    for (const int colour : bindings.colour) target.colours.push_back(attachment(colour));
    if (bindings.depth >= 0) target.depth = attachment(bindings.depth);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers_.get(target.colours, target.depth, {size.x, size.y, 1}));
    glViewport(0, 0, static_cast<GLsizei>(size.x), static_cast<GLsizei>(size.y));
    return size;
}

void Executor::restrictMips(const PlanStep& step, const StepBindings& bindings, bool restrict) {
    if (!bindings.restrictsMips) return;
    for (const PlanBinding& binding : step.bindings) {
        if (binding.access != Access::Fetch || binding.mip < 0 || resources_.isBuffer(binding.resource))
            continue;
        const gl::Texture& texture = resources_.texture(binding.resource, binding.previous);
        const int last = texture.desc().mips - 1;
        glTextureParameteri(texture.name(), GL_TEXTURE_BASE_LEVEL, restrict ? binding.mip : 0);
        glTextureParameteri(texture.name(), GL_TEXTURE_MAX_LEVEL, restrict ? binding.mip : last);
    }
}

// ---- after the frame

void Executor::collectSamples(std::uint32_t frameIndex) {
    if (!options.timing) return;
    for (const gl::StepClock::Sample& sample : clock_->take(true)) {
        const PlanStep& step = plan().steps.at(sample.step);
        const PlanPass& pass = plan().passes.at(static_cast<size_t>(step.pass));
        samples_.push_back({pass.name, pass.type, step.step.name,
                            step.step.group.empty() ? pass.name : step.step.group, frameIndex, sample.ms,
                            step.preview});
    }
}

} // namespace kestrel
