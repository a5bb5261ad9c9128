#include "draw/draw_layers.h"
#include "gl/loader.h"

namespace kestrel {

void eachLayer(gl::FramebufferCache& framebuffers, const gl::Target& target, std::uint32_t count,
               const std::function<void(std::uint32_t layer)>& draw) {
    for (std::uint32_t layer = 0; layer < count; ++layer) {
        gl::Target one = target;
        for (gl::Attachment* attachment : one.attachments())
            if (attachment->layer < 0) attachment->layer = static_cast<int>(layer);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffers.get(one.colours, one.depth, {}));
        draw(layer);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers.get(target.colours, target.depth, {}));
}

} // namespace kestrel
