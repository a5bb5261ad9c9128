// The ways to a context, each in its own file.
#pragma once
#include "gl/context.h"

namespace kestrel::gl {

// EGL without a surface (EGL_MESA_platform_surfaceless), else on the first device that gives OpenGL 4.6
// (EGL_EXT_device_enumeration, EGL_EXT_platform_device).
std::unique_ptr<Context> createEglContext(const ContextOptions& options);
std::unique_ptr<Context> createOsMesaContext(const ContextOptions& options);
std::unique_ptr<Context> createWindowContext(const ContextOptions& options);

} // namespace kestrel::gl
