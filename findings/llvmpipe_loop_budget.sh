#!/usr/bin/env bash
# Mesa 22.3.6 (Debian 12), llvmpipe: an invocation has 65,535 iterations for all its loops together. Two loops of 40,000 one
# behind the other add up to 65,534, not 80,000; every loop that begins after that runs its body once. There is no error and no
# debug message. A limit that holds for each loop by itself, as one tends to read it from a single long loop, is not what there is.
#
# What was seen (a compute shader, one invocation; a and b are the iterations that the first and the second loop made):
#     2 x 30000: a 30000, b 30000
#     2 x 40000: a 40000, b 25534
#     2 x 60000: a 60000, b 5534
# So loops whose bounds depend on data are counted together (lib/iterations.glsl), and what takes more goes into several dispatches.
set -euo pipefail
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT && cd "$work"
version=22.3.6-1+deb12u2
apt-get download -qq "libegl-mesa0=$version" "libgl1-mesa-dri=$version" "libglapi-mesa=$version" "libgbm1=$version"
for package in *.deb; do dpkg -x "$package" mesa; done
libraries=$(dirname "$(find mesa -name 'libEGL_mesa.so.0')")
cat >loops.c <<'C'
#include <EGL/egl.h>
#include <EGL/eglext.h>
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <stdio.h>
static const char* text =
    "#version 450\n"
    "layout(local_size_x = 1) in;\n"
    "layout(std430, binding = 0) buffer Result { uint wanted, a, b; };\n"
    "void main() {\n"
    "    uint first = 0u, second = 0u;\n"
    "    for (uint i = 0u; i < wanted; ++i) first += 1u;\n"
    "    for (uint i = 0u; i < wanted; ++i) second += 1u;\n"
    "    a = first; b = second;\n"
    "}\n";
int main(void) {
    EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    eglInitialize(display, NULL, NULL);
    eglBindAPI(EGL_OPENGL_API);
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return 2;
    printf("%s, %s\n", glGetString(GL_RENDERER), glGetString(GL_VERSION));
    GLuint program = glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &text), buffer;
    glUseProgram(program);
    glGenBuffers(1, &buffer);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer);
    for (GLuint wanted = 30000; wanted <= 60000; wanted += wanted < 40000 ? 10000 : 20000) {
        GLuint data[3] = {wanted, 0, 0};
        glBufferData(GL_SHADER_STORAGE_BUFFER, sizeof data, data, GL_DYNAMIC_DRAW);
        glDispatchCompute(1, 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof data, data);
        printf("2 x %u: a %u, b %u\n", wanted, data[1], data[2]);
    }
    return glGetError() == GL_NO_ERROR ? 0 : 3;
}
C
cc loops.c -o loops -lEGL -lGL
cat >vendor.json <<J
{ "file_format_version": "1.0.0", "ICD": { "library_path": "$PWD/$libraries/libEGL_mesa.so.0" } }
J
LD_LIBRARY_PATH=$PWD/$libraries LIBGL_DRIVERS_PATH=$PWD/$libraries/dri __EGL_VENDOR_LIBRARY_FILENAMES=$PWD/vendor.json \
    LIBGL_ALWAYS_SOFTWARE=1 ./loops | tee seen
grep -q 'Mesa 22.3.6' seen
grep -qx '2 x 30000: a 30000, b 30000' seen
grep -qx '2 x 40000: a 40000, b 25534' seen
grep -qx '2 x 60000: a 60000, b 5534' seen
