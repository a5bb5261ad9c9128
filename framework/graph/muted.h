// A pass that is muted in its document: it hands its inputs on and does nothing.
#pragma once
#include "graph/registry.h"
#include <memory>

namespace kestrel {

// The input that stands for an output of this type when the pass is muted: of those that `connected` names,
// in the order of the table, the first of the output's kind that carries the same, else the first whose
// content is not another; nullptr if none can.
const PortInfo* standIn(const PassType& type, const PortInfo& output,
                        const std::function<bool(const std::string&)>& connected);

// An object that declares each output as what its stand-in is.
std::shared_ptr<Pass> mutedPass(const PassType& type);

} // namespace kestrel
