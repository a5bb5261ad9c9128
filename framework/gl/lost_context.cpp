#include "gl/lost_context.h"
#include "core/error.h"
#include "gl/loader.h"
#include <fmt/format.h>

namespace kestrel::gl {

void requireLiveContext() {
    const GLenum status = glGetGraphicsResetStatus();
    if (status == GL_NO_ERROR) return;
    const char* why = status == GL_GUILTY_CONTEXT_RESET ? ": a step of this run took too long or went wrong; "
                                                          "a smaller --size or fewer samples make it shorter"
                      : status == GL_INNOCENT_CONTEXT_RESET ? " because of another program"
                                                            : " for a reason that it does not tell";
    throw MachineError(fmt::format("the driver has reset the GPU, and the OpenGL context is lost{}", why));
}

} // namespace kestrel::gl
