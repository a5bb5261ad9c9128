// How an executor takes over a plan, and what it keeps of the one before.
#include "draw/gpu_scene.h"
#include "execute/executor.h"
#include <fmt/format.h>
#include <set>

namespace kestrel {

namespace {

void addUses(std::string& text, const std::vector<PlanBinding>& bindings, const Plan& plan) {
    for (const PlanBinding& use : bindings) {
        const PlanResource& resource = plan.resources.at(static_cast<size_t>(use.resource));
        text += fmt::format(" {}={} {} {}{}{}{}{}.{}", use.name, resource.port.text(),
                            describe(resource.desc), static_cast<int>(use.access), use.write ? 'w' : 'r',
                            use.previous ? 'p' : 'c', use.linear ? 'l' : 'n', use.mip, use.layer);
    }
}

} // namespace

std::string Executor::signature(const Plan& plan, const PlanPass& pass, const Programs& programs) {
    std::string text =
        fmt::format("{} {} {}", pass.type, static_cast<std::uint32_t>(pass.depends), pass.always);
    for (const auto& [port, desc] : pass.descs)
        text += fmt::format("\n{} {} {} {}", port, describe(desc), desc.provides, desc.required);
    for (const auto& [port, resource] : pass.ports)
        if (resource >= 0)
            text +=
                fmt::format("\n{} {}", port, plan.resources.at(static_cast<size_t>(resource)).port.text());
    for (int i = pass.firstStep; i < pass.firstStep + pass.stepCount; ++i) {
        const PlanStep& step = plan.steps.at(static_cast<size_t>(i));
        const Programs::Entry* program = programs.of(i);
        text += fmt::format("\n{} {}", step.step.name, program != nullptr ? program->key : 0);
        addUses(text, step.bindings, plan);
    }
    return text;
}

void Executor::keepStates(const Plan& next, const Programs& programs, const StateText& stateText) {
    std::map<std::string, PassState> old;
    if (plan_)
        for (size_t i = 0; i < states_.size(); ++i) old[plan_->passes[i].name] = states_[i];
    std::map<std::string, Kept> kept;
    std::vector<PassState> states(next.passes.size());
    for (size_t i = 0; i < states.size(); ++i) {
        const PlanPass& pass = next.passes[i];
        PassState& state = states[i];
        Kept& now = kept[pass.name] = {signature(next, pass, programs), stateText ? stateText(pass) : ""};
        for (int step = pass.firstStep; step < pass.firstStep + pass.stepCount; ++step)
            if (const Programs::Entry* program = programs.of(step))
                state.readsLastMotion = state.readsLastMotion || program->readsLastMotion;

        const auto before = kept_.find(pass.name);
        if (before == kept_.end()) continue; // new: pending for all causes
        // What every frame makes anew is missed only by the rest of a frame that has begun.
        bool contentKept = true;
        for (const auto& [port, resource] : pass.ports)
            if (resource >= 0 && resources_.info(resource).port.pass == pass.name)
                contentKept = contentKept && (resources_.kept(resource) ||
                                              (!unfinished_ && resources_.info(resource).transient));
        if (!contentKept) continue;
        const bool same = before->second.signature == now.signature && before->second.state == now.state;
        const PassState& last = old[pass.name];
        state.pending = last.pending | (same ? Causes::None : Causes::Properties);
        if (!unfinished_ || !last.done) continue;
        // Results of this frame that would be made again must not be added to what they already hold.
        if (any(state.pending)) {
            state.pending = Causes::All;
        } else {
            state.done = true;
            state.changed = last.changed;
        }
    }
    std::erase_if(report_.values, [&](const auto& item) { return !kept.contains(item.first); });
    states_ = std::move(states);
    kept_ = std::move(kept);
}

void Executor::adopt(std::shared_ptr<const Plan> next, const StateText& stateText) {
    // Whatever can fail for the user's reasons comes first, on copies: the old plan stays then.
    Programs programs = programs_;
    programs.adopt(*next, library_, capabilities_, options.countIterations);
    std::vector<StepBindings> bindings;
    std::vector<std::string> labels;
    std::vector<Problem> problems;
    bool countsIterations = false;
    for (size_t i = 0; i < next->steps.size(); ++i) {
        const auto index = static_cast<int>(i);
        const PlanStep& step = next->steps[i];
        labels.push_back(fmt::format("pass '{}', step '{}'",
                                     next->passes.at(static_cast<size_t>(step.pass)).name, step.step.name));
        try {
            bindings.push_back(resolveBindings(*next, index, programs.of(index), GpuScene::reserves));
            countsIterations = countsIterations || bindings.back().iterations;
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.problems().begin(), error.problems().end());
        }
    }
    if (!problems.empty()) throw InputError(std::move(problems));
    resources_.adopt(*next, capabilities_);

    framebuffers_.clear();
    views_.adopt(*next);
    iterations_ = countsIterations
                      ? gl::Buffer(next->steps.size() * static_cast<size_t>(iterationsStride), "Iterations")
                      : gl::Buffer();
    keepStates(*next, programs, stateText);
    programs_ = std::move(programs);
    bindings_ = std::move(bindings);
    labels_ = std::move(labels);
    plan_ = std::move(next);
    countersBehind_.assign(plan_->passes.size(), {});
    for (size_t i = 0; i < plan_->passes.size(); ++i) { // in order: what stands behind an input is complete
        std::set<int> behind;
        for (const int input : plan_->passes[i].inputs) {
            const std::vector<int>& further = countersBehind_[static_cast<size_t>(input)];
            behind.insert(further.begin(), further.end());
            if (!plan_->passes[static_cast<size_t>(input)].counters.empty()) behind.insert(input);
        }
        countersBehind_[i].assign(behind.begin(), behind.end());
    }
}

} // namespace kestrel
