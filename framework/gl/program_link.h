// From composed text to a linked program.
#pragma once
#include "gl/objects.h"
#include "shader/compose.h"

namespace kestrel::gl {

// Compiles all stages and links them into `program`; output out_X gets the place of X in `attachments`.
// Throws InputError with every problem of all stages, each with file:line and the source line.
void linkProgram(Name program, const ComposedProgram& composed, const std::vector<std::string>& attachments);

// Every active output out_X must have its attachment, for what is written elsewhere would be lost silently.
// Throws InputError naming the outputs that have none, with the near name.
void requireAttachments(Name program, const ComposedProgram& composed,
                        const std::vector<std::string>& attachments);

} // namespace kestrel::gl
