#include "execute/programs.h"
#include "gl/loader.h"
#include "shader/iterations.h"
#include <algorithm>
#include <optional>
#include <string_view>

namespace kestrel {

namespace {

// What shaders/lib/last_view.glsl writes into every text that includes it.
constexpr std::string_view lastViewMark = "READS_LAST_VIEW";

// Members of uniform blocks all count as active, so a shader that reads the last frame's view says so by
// including lib/last_view.glsl, which alone knows the member's name (a test holds the shaders to that).
bool readsLastMotion(const ComposedProgram& composed, const gl::Program& program) {
    if (glGetAttribLocation(program.name(), "in_previous_position") >= 0) return true;
    if (program.slot("scene_previous_positions") || program.slot("ScenePreviousPositions")) return true;
    for (const ComposedStage& stage : composed.stages)
        if (stage.text.find(lastViewMark) != std::string::npos) return true;
    return false;
}

} // namespace

std::vector<std::string> colourAttachments(const PlanStep& step, const Plan& plan) {
    std::vector<std::string> ports;
    for (const PlanBinding& binding : step.bindings) {
        if (binding.access != Access::Attachment) continue;
        const Desc& desc = plan.resources.at(static_cast<size_t>(binding.resource)).desc;
        if (!formatInfo(desc.format).depth) ports.push_back(binding.port);
    }
    return ports;
}

void Programs::adopt(const Plan& plan, ShaderLibrary& library, const Capabilities& capabilities,
                     bool countIterations) {
    std::vector<Problem> problems;
    const auto note = [&](const InputError& error) {
        problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    };

    std::vector<std::optional<ComposedProgram>> composed(plan.programs.size());
    for (size_t i = 0; i < composed.size(); ++i) try {
            ProgramRequest request = plan.programs[i];
            if (countIterations) request.defines[iterationsDefine] = "1";
            composed[i] = compose(request, library);
        } catch (const InputError& error) {
            note(error);
        }

    ++plans_;
    std::vector<std::shared_ptr<Entry>> steps(plan.steps.size());
    for (size_t i = 0; i < steps.size(); ++i) {
        const int request = plan.steps[i].program;
        if (request < 0 || !composed.at(static_cast<size_t>(request))) continue;
        const ComposedProgram& text = *composed[static_cast<size_t>(request)];
        const Key key{text.key, colourAttachments(plan.steps[i], plan)};
        Cached& cached = cache_[key];
        cached.lastUse = plans_;
        std::shared_ptr<Entry>& entry = cached.entry;
        if (!entry) try {
                auto made = std::make_shared<Entry>();
                made->program = std::make_unique<gl::Program>(text, key.second, capabilities);
                made->name = text.name;
                made->key = text.key;
                made->countsIterations = made->program->slot(iterationsBlockName).has_value();
                made->readsLastMotion = readsLastMotion(text, *made->program);
                entry = std::move(made);
            } catch (const InputError& error) {
                note(error);
            }
        steps[i] = entry;
    }
    std::erase_if(cache_, [](const auto& item) { return item.second.entry == nullptr; });
    if (!problems.empty()) throw InputError(std::move(problems));
    steps_ = std::move(steps);
    forgetOld();
}

void Programs::forgetOld() {
    std::vector<std::pair<std::uint64_t, Key>> unused;
    for (const auto& [key, cached] : cache_)
        if (cached.lastUse != plans_) unused.emplace_back(cached.lastUse, key);
    if (unused.size() <= maxUnused) return;
    std::ranges::sort(unused);
    for (size_t i = 0; i < unused.size() - maxUnused; ++i) cache_.erase(unused[i].second);
}

} // namespace kestrel
