#include "core/check.h"
#include "core/error.h"
#include "gl/loader.h"
#include "gl/objects.h"
#include <fmt/format.h>

namespace kestrel::gl {

void deleteFramebuffer(Name name) { glDeleteFramebuffers(1, &name); }

namespace {

void attach(Name framebuffer, GLenum point, const Attachment& attachment) {
    if (attachment.layer < 0)
        glNamedFramebufferTexture(framebuffer, point, attachment.texture->name(), attachment.mip);
    else
        glNamedFramebufferTextureLayer(framebuffer, point, attachment.texture->name(), attachment.mip,
                                       attachment.layer);
}

void requireComplete(Name framebuffer, const std::vector<Attachment>& colours, const Attachment& depth) {
    const GLenum status = glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE) return;
    std::string formats;
    for (const Attachment& colour : colours)
        if (colour.texture != nullptr) formats += describe(colour.texture->desc()) + ", ";
    formats += depth.texture != nullptr ? "depth " + describe(depth.texture->desc()) : "no depth";
    throw MachineError(
        fmt::format("the driver cannot draw to {} (framebuffer status 0x{:x})", formats, status));
}

} // namespace

std::vector<Attachment*> Target::attachments() {
    std::vector<Attachment*> result;
    for (Attachment& colour : colours)
        if (colour.texture != nullptr) result.push_back(&colour);
    if (depth.texture != nullptr) result.push_back(&depth);
    return result;
}

std::vector<const Attachment*> Target::attachments() const {
    std::vector<const Attachment*> result;
    for (const Attachment& colour : colours)
        if (colour.texture != nullptr) result.push_back(&colour);
    if (depth.texture != nullptr) result.push_back(&depth);
    return result;
}

Name FramebufferCache::get(const std::vector<Attachment>& colours, const Attachment& depth,
                           const Extent& extent) {
    // Serials, not names: GL gives a deleted texture's name to the next one.
    Key key;
    bool attached = false;
    const auto addKey = [&](const Attachment& attachment) {
        attached |= attachment.texture != nullptr;
        key.insert(key.end(), {attachment.texture == nullptr ? 0 : attachment.texture->serial(),
                               static_cast<std::uint64_t>(attachment.mip),
                               static_cast<std::uint64_t>(attachment.layer + 1)});
    };
    addKey(depth);
    for (const Attachment& colour : colours) addKey(colour);
    if (!attached) key.insert(key.end(), {extent.width, extent.height, extent.depth});
    if (const auto made = framebuffers_.find(key); made != framebuffers_.end()) return made->second.get();

    Name name = 0;
    glCreateFramebuffers(1, &name);
    Handle<deleteFramebuffer> handle(name);
    std::vector<GLenum> drawn;
    for (size_t i = 0; i < colours.size(); ++i) {
        const bool used = colours[i].texture != nullptr;
        const GLenum point = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
        if (used) attach(name, point, colours[i]);
        drawn.push_back(used ? point : GLenum{GL_NONE});
    }
    if (depth.texture != nullptr) attach(name, GL_DEPTH_ATTACHMENT, depth);
    if (drawn.empty()) drawn.push_back(GL_NONE);
    glNamedFramebufferDrawBuffers(name, static_cast<GLsizei>(drawn.size()), drawn.data());
    if (!attached) {
        glNamedFramebufferParameteri(name, GL_FRAMEBUFFER_DEFAULT_WIDTH, static_cast<GLint>(extent.width));
        glNamedFramebufferParameteri(name, GL_FRAMEBUFFER_DEFAULT_HEIGHT, static_cast<GLint>(extent.height));
        if (extent.depth > 1)
            glNamedFramebufferParameteri(name, GL_FRAMEBUFFER_DEFAULT_LAYERS,
                                         static_cast<GLint>(extent.depth));
    }
    requireComplete(name, colours, depth);
    framebuffers_.emplace(std::move(key), std::move(handle));
    return name;
}

} // namespace kestrel::gl
