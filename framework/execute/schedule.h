// Which passes run in a frame, and why: causes of change travel along the plan's order. Pure: no GL.
#pragma once
#include "graph/plan.h"
#include "scene/geometry.h"
#include <string_view>
#include <vector>

namespace kestrel {

// What tells one frame from the next.
struct FrameConditions {
    int camera = 0;
    CameraState cameraState;
    double time = 0;
    bool jumped = false; // the time did not go on by one step
    Extent size;
    std::vector<LightState> lights;
};

// The causes that come up between two frames. Frame is always among them; a cut is another camera or a jump
// in time. What moves is known from the facts: geometry that moves changes transforms, geometry that deforms
// changes triangles too.
Causes eventsBetween(const FrameConditions& last, const FrameConditions& now, const SceneFacts& facts);

// A camera moved, or things or lights did: what motion vectors tell. None after a cut, where there is no last
// frame.
Causes motionOf(Causes events);

// What the executor remembers of a pass from frame to frame.
struct PassState {
    Causes pending = Causes::All;  // it must run for these, whatever came up: it is new or not as it was
    bool readsLastMotion = false;  // reads last frame's transforms: runs one frame longer than things move
    bool done = false;             // ran in this frame before it was begun again, and its results are there
    bool runs = false;             // in this frame
    Causes causes = Causes::None;  // why it runs in this frame
    Causes changed = Causes::None; // why its outputs differ from the last frame's
};

// Fills runs, causes and changed of every state (as many as plan.passes) for one frame. A pass runs if what
// it depends on came up, an input changed, it always runs, or it is pending. A pass that is done does not run
// again, its `changed` stays. `lastEvents` are those of the frame before.
void schedule(const Plan& plan, Causes events, Causes lastEvents, std::vector<PassState>& states);

// Whether what a pass has made hangs on the frames before: it runs for their number or their camera, or
// always. What is behind it in the graph does so too, by its inputs.
bool dependsOnFrames(const PlanPass& pass);

// Why an input port changed in this frame: the causes of all passes that stand behind it.
Causes inputCauses(const PlanPass& pass, std::string_view port, const std::vector<PassState>& states);

} // namespace kestrel
