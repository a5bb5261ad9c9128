// What OpenGL gives on this machine and what Kestrel does with it, for reports of faults.
#pragma once
#include "graph/registry.h"
#include <string>

namespace kestrel {

// The capabilities as JSON, as `check --capabilities` reads them: so the machine of a report stands in for
// its reader's. Under "kestrel": version, parts, driver, clock, and `differs`: by pass type and setting
// ("method=interlock"; empty: the graph as it stands) what is refused or left out here and would not be on a
// device without limits, in the passes' own words, wherever a shipped graph has such a pass. Throws
// MachineError where there is no OpenGL 4.6.
std::string machineJson(const Registry& registry);

} // namespace kestrel
