// Messages of shader compilers, turned back to the files that the composed text came from.
#pragma once
#include "core/error.h"
#include "shader/compose.h"
#include <string>
#include <vector>

namespace kestrel {

// The stage's text for a driver's compiler. Mesa reads `#line N F` and then reports every error in source 0,
// so the line numbers carry the source as well: line N of source F becomes F * linesPerSource + N.
// mapShaderLog() reads both.
std::string driverText(const ComposedStage& stage);
inline constexpr int linesPerSource = 100'000;

// The problems in a compiler's log about one stage: file and line by the stage's sources, then the message
// followed by the source line (" in: x = y;"). Understands Mesa ("1:12(3): error: ..."), glslang ("ERROR:
// 1:12: ..."), and NVIDIA
// ("1(12) : error C1008: ..."). Lines without a place speak of the stage's file; summaries ("2 compilation
// errors") are dropped; warnings keep the word "warning: " in front.
std::vector<Problem> mapShaderLog(const std::string& log, const ComposedStage& stage);

// The problems in a linker's log: each line speaks of the program by its name.
std::vector<Problem> mapLinkLog(const std::string& log, const ComposedProgram& program);

// Line `line` of source `source` as it stands in the stage's text, trimmed; empty if there is none.
std::string composedLine(const ComposedStage& stage, int source, int line);

} // namespace kestrel
