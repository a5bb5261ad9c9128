// The barrier plan: which memory barriers stand before each step.
#pragma once
#include "graph/plan.h"

namespace kestrel {

// The barrier that makes earlier shader writes visible to a following access of this kind.
Barrier barrierFor(Access access);

// Whether a write of this kind is incoherent: later accesses see it only after a barrier. Shader image stores
// and storage block writes (and atomics) are; attachments, copies, clears and uploads are ordered by OpenGL.
bool isIncoherent(Access access);

// What must stand between `first` and `second`, two accesses of the same memory in different steps.
Barrier barrierBetween(Access first, bool firstWrites, Access second, bool secondWrites);

// Fills PlanStep::barrier from the bindings, copies and clears. The frame is taken as a circle: the first
// step follows the last one of the frame before. A barrier that one resource needs also serves the others,
// but only where the step that carries it runs whenever it must (a pass may be skipped in a frame).
void planBarriers(Plan& plan);

std::string barrierText(Barrier barrier); // "TextureFetch|ShaderImage", "none"

} // namespace kestrel
