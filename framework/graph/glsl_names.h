// How the resources of ports are called in GLSL: the one place that knows.
#pragma once
#include "graph/pass.h"

namespace kestrel {

// The path of a module instance in front of a name: "" in the step itself, "tracer_", "tracer_near_"…

// "ray_buffer" -> "RayBuffer": a capital at the begin and after each underscore, no underscores.
std::string blockName(std::string_view port);

// The sampler, image, block or fragment output of a use; empty for accesses that no shader sees.
// `readBeside`: the same step or module reads the port as texels by another use. The rule stands at struct
// Use.
std::string glslName(const std::string& path, const Use& use, ResourceKind kind, bool readBeside);

// The uniform block that receives a port's ViewData: "DepthView", "tracer_DepthView", "PreviousDepthView".
std::string viewBlockName(const std::string& path, std::string_view port, bool previous);

} // namespace kestrel
