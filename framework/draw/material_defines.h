// The defines of lib/material.glsl. Needs no GL.
#pragma once
#include "graph/types.h"
#include "scene/facts.h"
#include "shader/source.h"
#include <map>
#include <string>
#include <vector>

namespace kestrel {

// What a scene of these facts needs of lib/material.glsl, so that programs contain nothing else. Library
// files see the defines of the program, not those of a module in it: every program that looks at materials,
// itself or through a tracer, gets these.
Defines materialDefines(const SceneFacts& facts, Blended blended = Blended::Tested);

// The values that each of these defines can take (for allCombinations).
std::map<std::string, std::vector<std::string>> materialDefineChoices();

} // namespace kestrel
