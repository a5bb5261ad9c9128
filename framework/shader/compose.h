// Composition: a program's files, with what they include, become one text a stage.
//
// The rules (a shader file states none of this itself):
//   - `#version 460 core` comes first, then every `#extension` line of any file (they must precede code),
//   then the
//     program's defines, then the file. A file carries no #version and no #line of its own.
//   - `#include "lib/tracer.glsl"` names a library file, by its path in the ShaderLibrary. It is included
//   once a
//     stage and sees the program's defines only, whoever includes it first.
//   - `#include <port:NAME>` names what is connected to a port: a module file, included once an instance.
//   Inside it
//     M(x) puts the port path in front of x (`tracer_near_x`), and its own defines hold, no others: what a
//   consumer
//     calls its own switches is nothing to its providers. Both end with the module's text. A library file
//     that a module includes sees the program's defines, as everywhere.
//   - `#include <part:FILE>` in a module file goes on in another file: once an instance, with M, defines and
//     macros as if its text stood there.
//   - Conditionals are judged from the defines. An include in a branch that is surely taken is expanded, in
//   one that
//     is surely not taken it is dropped. Where the defines do not decide (a macro that a file defines
//     itself), library includes are refused (they could be missing elsewhere), and an unconnected port
//     expands to nothing.
//   - A branch under __cplusplus is blanked, and `#pragma once` too: shaders/shared/*.h serve both languages.
//   - Names with a double underscore are reserved by GLSL and refused.
#pragma once
#include "core/error.h"
#include "shader/source.h"
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace kestrel {

// One use of a module: the file that implements it, its own defines, and the modules that it includes itself,
// by its port names.
struct ModuleInstance {
    std::string file;
    Defines defines;
    std::map<std::string, ModuleInstance> modules;
};

// What to compose: one file a stage ({"gbuffer/gbuffer.vert", "gbuffer/gbuffer.frag"} or {"x/y.comp"}).
struct ProgramRequest {
    std::vector<std::string> files;
    Defines defines;
    std::map<std::string, ModuleInstance> modules; // by the consumer's port name
};

// The text of a stage; a driver is given driverText(stage) (problems.h) instead, since Mesa forgets the F.
// `sources[F]` is the file that `#line N F` speaks of; `sources[0]` is the head that composition itself
// writes (version and defines), and `file` the stage's own file.
struct ComposedStage {
    ShaderStage stage = ShaderStage::Vertex;
    std::string text;
    std::vector<std::string> sources;
    std::string file;
};

// A program as text. `dependencies` are the library paths of all files in it, sorted, each once; `name` is
// the files joined by "+", for messages and debug labels; `key` is a hash of stages and texts, equal in every
// run.
struct ComposedProgram {
    std::vector<ComposedStage> stages;
    std::vector<std::string> dependencies;
    std::string name;
    std::uint64_t key = 0;
};

// Composes a program. Throws InputError with every problem found, each with file and line: a missing include,
// an unconnected port, a reserved name, a conditional without end, stages that do not go together.
ComposedProgram compose(const ProgramRequest& request, ShaderLibrary& library);

// The instances deeper than this are refused: graphs have no cycles, but a caller's data might.
inline constexpr int maxModuleDepth = 16;

// As a value in the choices of allCombinations: the define is absent.
inline const std::string undefinedChoice = "#undef";

// Every combination of the values that each define can take, in a fixed order (the last name changes
// fastest). Without choices: one empty set. A name without values is an InputError.
std::vector<Defines> allCombinations(const std::map<std::string, std::vector<std::string>>& choices);

} // namespace kestrel
