#!/usr/bin/env bash
# Mesa 22.3.6, llvmpipe: GL_ARB_sample_locations is not there, with or without the override to 4.6; nor is the form of NV.
#
# Samples of a multisampled target can then not be placed at the centre of a pixel, so that gl_SampleMask cannot stand for the
# slots of a stochastic depth map (the slots of StochasticDepthRaster are images).
set -euo pipefail
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT && cd "$work"
cat >seen.c <<'C'
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <GL/glext.h>
#include <stdio.h>
#include <string.h>
int main(void) {
    EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    eglInitialize(display, NULL, NULL);
    eglBindAPI(EGL_OPENGL_API);
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
    PFNGLGETSTRINGIPROC getStringi = (PFNGLGETSTRINGIPROC)eglGetProcAddress("glGetStringi");
    GLint count = 0, found = 0;
    glGetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i)
        found += strstr((const char*)getStringi(GL_EXTENSIONS, i), "sample_locations") != NULL;
    printf("%s, GL %s: %d of %d extensions place samples\n", glGetString(GL_RENDERER), glGetString(GL_VERSION), found, count);
    return 0;
}
C
cc seen.c -o seen -lEGL -lGL
LIBGL_ALWAYS_SOFTWARE=1 ./seen
MESA_GL_VERSION_OVERRIDE=4.6 MESA_GLSL_VERSION_OVERRIDE=460 LIBGL_ALWAYS_SOFTWARE=1 ./seen
