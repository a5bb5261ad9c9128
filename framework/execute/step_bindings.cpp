#include "execute/step_bindings.h"
#include "shader/iterations.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kestrel {

namespace {

using Kind = gl::Program::Slot::Kind;

std::optional<Kind> kindOf(Access access) {
    switch (access) {
    case Access::Fetch:
        return Kind::Sampler;
    case Access::Image:
        return Kind::Image;
    case Access::Storage:
        return Kind::StorageBlock;
    case Access::Uniform:
        return Kind::UniformBlock;
    default:
        return std::nullopt;
    }
}

const char* kindText(Kind kind) {
    switch (kind) {
    case Kind::Sampler:
        return "a sampler";
    case Kind::Image:
        return "an image";
    case Kind::StorageBlock:
        return "a storage block";
    case Kind::UniformBlock:
        return "a uniform block";
    }
    return "";
}

std::optional<StepBindings::ViewSlot> viewOf(const std::string& slot, unsigned int unit,
                                             const PlanStep& step) {
    for (const PlanView& view : step.views)
        if (view.name == slot)
            return StepBindings::ViewSlot{unit, view.view, view.extent, view.resource, view.previous};
    return std::nullopt;
}

void resolveAttachments(const Plan& plan, const PlanStep& step, StepBindings& result) {
    for (size_t i = 0; i < step.bindings.size(); ++i) {
        const PlanBinding& binding = step.bindings[i];
        if (binding.access == Access::Attachment) {
            const Desc& desc = plan.resources.at(static_cast<size_t>(binding.resource)).desc;
            if (formatInfo(desc.format).depth)
                result.depth = static_cast<int>(i);
            else
                result.colour.push_back(static_cast<int>(i));
        }
        if (binding.access == Access::Fetch && binding.mip >= 0) result.restrictsMips = true;
    }
}

} // namespace

StepBindings resolveBindings(const Plan& plan, int stepIndex, const Programs::Entry* program,
                             const std::function<bool(std::string_view)>& boundByScene) {
    const PlanStep& step = plan.steps.at(static_cast<size_t>(stepIndex));
    const PlanPass& pass = plan.passes.at(static_cast<size_t>(step.pass));
    StepBindings result;
    resolveAttachments(plan, step, result);
    if (program == nullptr) return result;

    std::vector<Problem> problems;
    const auto problem = [&](const std::string& message) {
        problems.push_back({{}, fmt::format("pass '{}', step '{}': {}", pass.name, step.step.name, message)});
    };
    for (const std::string& name : program->program->slotNames()) {
        const gl::Program::Slot slot = program->program->slot(name).value();
        bool bound = false;
        for (size_t i = 0; i < step.bindings.size(); ++i) {
            const PlanBinding& binding = step.bindings[i];
            if (binding.name != name || !kindOf(binding.access)) continue;
            if (kindOf(binding.access) != slot.kind) continue;
            result.slots.push_back({slot, static_cast<int>(i)});
            bound = true;
        }
        if (bound) continue;
        if (slot.kind == Kind::UniformBlock && name == "Frame") {
            result.frame = slot.unit;
        } else if (slot.kind == Kind::StorageBlock && name == iterationsBlockName) {
            result.iterations = slot.unit;
        } else if (boundByScene(name)) {
            result.scene = true;
        } else if (const auto view = viewOf(name, slot.unit, step); view && slot.kind == Kind::UniformBlock) {
            result.views.push_back(*view);
        } else {
            std::vector<std::string> names;
            for (const PlanBinding& binding : step.bindings) names.push_back(binding.name);
            problem(fmt::format("nothing binds '{}', {} of {} (bound are: {})", name, kindText(slot.kind),
                                program->name, fmt::join(names, ", ")));
        }
    }
    if (!problems.empty()) throw InputError(std::move(problems));
    return result;
}

} // namespace kestrel
