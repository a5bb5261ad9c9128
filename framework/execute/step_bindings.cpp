#include "execute/step_bindings.h"
#include "shader/iterations.h"
#include <cctype>
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

// The names that a view block of this binding can have: the binding's name is a module prefix and a port,
// and where one ends and the other begins cannot be seen from it.
bool isViewOf(std::string_view slot, const PlanBinding& binding) {
    const std::string& name = binding.name;
    if (slot == name + "View") return true; // of a block: its name has the capitals already
    for (size_t at = 0; at != std::string::npos;) {
        if (slot == name.substr(0, at) + blockName(name.substr(at)) + "View") return true;
        at = name.find('_', at);
        if (at != std::string::npos) ++at;
    }
    return false;
}

std::optional<StepBindings::ViewSlot> viewOf(const std::string& slot, unsigned int unit, const Plan& plan,
                                             const PlanStep& step) {
    const auto ofResource = [&](int resource, bool previous) {
        const Desc& desc = plan.resources.at(static_cast<size_t>(resource)).desc;
        return StepBindings::ViewSlot{unit, desc.view, desc.extent, resource, previous};
    };
    for (const PlanBinding& binding : step.bindings)
        if (binding.resource >= 0 && isViewOf(slot, binding))
            return ofResource(binding.resource, binding.previous);
    for (const auto& [port, resource] : plan.passes.at(static_cast<size_t>(step.pass)).ports)
        if (resource >= 0 && slot == blockName(port) + "View") return ofResource(resource, false);
    for (const PlanView& view : step.views)
        if (slot == view.name) return StepBindings::ViewSlot{unit, view.view, view.extent, -1, false};
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

std::string blockName(std::string_view port) {
    std::string name;
    bool capital = true;
    for (const char c : port) {
        if (c == '_') {
            capital = true;
            continue;
        }
        name += capital ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        capital = false;
    }
    return name;
}

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
        } else if (const auto view = viewOf(name, slot.unit, plan, step);
                   view && slot.kind == Kind::UniformBlock) {
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
