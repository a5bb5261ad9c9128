#include "execute/schedule.h"
#include "core/check.h"

namespace kestrel {

Causes eventsBetween(const FrameConditions& last, const FrameConditions& now, const SceneFacts& facts) {
    Causes events = Causes::Frame;
    if (now.camera != last.camera || now.jumped) events |= Causes::Cut;
    if (now.cameraState != last.cameraState) events |= Causes::Camera;
    if (now.time != last.time) {
        if (facts.geometryMoves) events |= Causes::Transforms;
        if (facts.geometryDeforms) events |= Causes::Geometry;
        if (facts.cameraMoves) events |= Causes::Cameras;
    }
    if (now.lights != last.lights) events |= Causes::Lights;
    if (now.size != last.size) events |= Causes::Size;
    return events;
}

Causes motionOf(Causes events) {
    if (any(events & Causes::Cut)) return Causes::None;
    return events &
           (Causes::Camera | Causes::Geometry | Causes::Transforms | Causes::Cameras | Causes::Lights);
}

void schedule(const Plan& plan, Causes events, Causes lastEvents, std::vector<PassState>& states) {
    KESTREL_CHECK_EQ(states.size(), plan.passes.size());
    const Causes lasting = motionOf(lastEvents);
    for (size_t i = 0; i < plan.passes.size(); ++i) {
        const PlanPass& pass = plan.passes[i];
        PassState& state = states[i];
        if (state.done) {
            state.runs = false;
            continue;
        }
        state.causes = (pass.depends & events) | state.pending;
        // Views of cameras and lights move too, but only of those passes that have one.
        if (state.readsLastMotion)
            state.causes |= lasting & (pass.depends | ~(Causes::Cameras | Causes::Lights));
        for (const int input : pass.inputs) state.causes |= states.at(static_cast<size_t>(input)).changed;
        state.runs = pass.always || any(state.causes);
        // What always runs may hold something new each frame, even where no cause came up.
        state.changed = !state.runs ? Causes::None : any(state.causes) ? state.causes : Causes::Frame;
    }
}

bool dependsOnFrames(const PlanPass& pass) {
    return pass.always ||
           any(pass.depends & (Causes::Frame | Causes::Camera | Causes::Cut | Causes::Cameras));
}

Causes inputCauses(const PlanPass& pass, std::string_view port, const std::vector<PassState>& states) {
    const auto found = pass.inputPasses.find(std::string(port));
    if (found == pass.inputPasses.end()) return Causes::None;
    Causes causes = Causes::None;
    for (const int producer : found->second) causes |= states.at(static_cast<size_t>(producer)).changed;
    return causes;
}

} // namespace kestrel
