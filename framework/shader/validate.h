// Checking composed programs with glslang: no GL context is needed.
#pragma once
#include "core/error.h"
#include "shader/compose.h"
#include <span>
#include <string>
#include <vector>

namespace kestrel {

// Parses and links the program as desktop GLSL 4.60 core. Empty means no errors, or that a stage uses an
// extension that glslang does not know (see glslangKnows): then only the driver can check the program.
// Warnings are not reported. Safe to call from several threads.
std::vector<Problem> validate(const ComposedProgram& program);

// Whether glslang can judge the program: none of its stages uses an extension of unknownExtensions().
bool glslangKnows(const ComposedProgram& program);

// An extension that glslang lacks, and what Kestrel uses it for.
struct UnknownExtension {
    std::string name;
    std::string reason;
};
std::span<const UnknownExtension> unknownExtensions();

} // namespace kestrel
