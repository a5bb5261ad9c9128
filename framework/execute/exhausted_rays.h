// Rays that ran out of iterations: counted by the consumers of a tracer in the storage block `Exhausted` of
// its module (define COUNT_EXHAUSTED), port "exhausted", and reported with the next frame.
#pragma once
#include "graph/pass.h"

namespace kestrel::exhaustion {

// Adds the port, its uses by the module and by the step that clears it, and the step "report" in front of
// all.
void declare(Declaration& declaration, Module& tracer, Step& clears);
void clear(Commands& commands);  // in the step that clears it
void report(Commands& commands); // in the step "report": "rays" and "exhausted rays"

} // namespace kestrel::exhaustion
