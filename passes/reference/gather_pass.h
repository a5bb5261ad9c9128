// What the reference passes that gather light share.
#pragma once
#include "graph/pass.h"
#include "reference/gather.h"

namespace kestrel {

// One step on the host from `reads` and face_normal to `writes`: "result" in rgba32f, others in r32f.
// Everything is the constant 0, and left out with a reason, where nothing is in view or `leftOut` says why.
Declaration declareGather(const Inputs& inputs, const std::vector<std::string>& reads,
                          const std::vector<std::string>& writes, const std::string& leftOut = {});

GatherSettings gatherSettings(Commands& commands, int samples, float distance);
GatherInputs gatherInputs(const Step& step, Commands& commands); // position, normals
// Writes "result" and reports noise and samples.
void finishGather(Commands& commands, const GatherResult& result);

} // namespace kestrel
