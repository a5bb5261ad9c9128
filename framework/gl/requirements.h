// What makes up OpenGL 4.6, for drivers whose version number was overridden.
#pragma once
#include <set>
#include <string>
#include <vector>

namespace kestrel::gl {

// Mesa's software driver has every extension of 4.6 and reports 4.5. Sets MESA_GL_VERSION_OVERRIDE=4.6 and
// MESA_GLSL_VERSION_OVERRIDE=460, each unless the user has set it. Must run before the first context: the
// driver reads them once.
void overrideVersion();

// Extensions that became part of OpenGL 4.0 to 4.6 and that the driver does not list, oldest version first.
// A driver that reports 4.6 of its own need not list what is core, so this is asked of Mesa only, where the
// number may be the override's.
std::vector<std::string> missingExtensions(const std::set<std::string>& listed);

// Throws MachineError if `version` (GL_VERSION) is below 4.6 or, for Mesa, a promoted extension is missing:
// the message names the renderer and all of what lacks.
void requireOpenGl46(const std::string& version, const std::string& renderer,
                     const std::set<std::string>& listed);

} // namespace kestrel::gl
