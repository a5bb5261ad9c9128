#include "core/check.h"
#include "core/error.h"
#include "gl/debug_output.h"
#include "gl/loader.h"
#include "gl/objects.h"
#include <fmt/format.h>

namespace kestrel::gl {

void deleteBuffer(Name name) { glDeleteBuffers(1, &name); }

Buffer::Buffer(std::uint64_t bytes, const std::string& text)
    : bytes_(bytes) {
    constexpr std::uint64_t smallest = 16; // GL has no empty storage, and a bound range must not be empty
    const std::uint64_t allocated = std::max(bytes, smallest);
    // What GLsizeiptr cannot hold is refused here: a driver would see a negative size.
    const bool representable = allocated <= static_cast<std::uint64_t>(PTRDIFF_MAX);
    Name name = 0;
    glCreateBuffers(1, &name);
    handle_ = Handle<deleteBuffer>(name);
    GLenum error = GL_OUT_OF_MEMORY;
    if (representable) {
        const ExpectErrors expect;
        glNamedBufferStorage(name, static_cast<GLsizeiptr>(allocated), nullptr, GL_DYNAMIC_STORAGE_BIT);
        error = expect.take();
    }
    if (error != GL_NO_ERROR)
        throw MachineError(
            fmt::format("no memory for buffer '{}' of {} bytes (GL error 0x{:x})", text, bytes, error));
    setLabel(GL_BUFFER, name, text);
    clear();
}

Buffer Buffer::range(std::uint64_t offset, std::uint64_t bytes) const {
    KESTREL_CHECK_LE(offset, bytes_);
    KESTREL_CHECK_LE(bytes, bytes_ - offset);
    KESTREL_CHECK_LT(std::uint64_t{0}, bytes);
    Buffer range;
    range.rangeOf_ = name();
    range.offset_ = offset_ + offset;
    range.bytes_ = bytes;
    return range;
}

void Buffer::bind(unsigned int target, unsigned int unit) const {
    if (rangeOf_ == 0)
        glBindBufferBase(target, unit, name());
    else
        glBindBufferRange(target, unit, name(), static_cast<GLintptr>(offset_),
                          static_cast<GLsizeiptr>(bytes_));
}

void Buffer::upload(std::span<const std::byte> data, std::uint64_t offset) {
    KESTREL_CHECK_LE(offset, bytes_);
    KESTREL_CHECK_LE(data.size(), bytes_ - offset);
    if (data.empty()) return;
    glNamedBufferSubData(name(), static_cast<GLintptr>(offset_ + offset),
                         static_cast<GLsizeiptr>(data.size()), data.data());
}

std::vector<std::byte> Buffer::download(std::uint64_t offset, std::uint64_t bytes) const {
    KESTREL_CHECK_LE(offset, bytes_);
    const std::uint64_t count = std::min(bytes, bytes_ - offset);
    KESTREL_CHECK(bytes == UINT64_MAX || bytes == count);
    std::vector<std::byte> result(count);
    if (count == 0) return result;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT); // shader writes before reading back
    glGetNamedBufferSubData(name(), static_cast<GLintptr>(offset_ + offset), static_cast<GLsizeiptr>(count),
                            result.data());
    return result;
}

void Buffer::clear(std::uint32_t word) {
    if (rangeOf_ == 0)
        glClearNamedBufferData(name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &word);
    else
        glClearNamedBufferSubData(name(), GL_R32UI, static_cast<GLintptr>(offset_),
                                  static_cast<GLsizeiptr>(bytes_ / 4 * 4), GL_RED_INTEGER, GL_UNSIGNED_INT,
                                  &word);
}

Name Buffer::texelView(Format format) const {
    for (const auto& [made, view] : views_)
        if (made == format) return view.get();
    const FormatInfo& info = formatInfo(format);
    const std::uint64_t texels = bytes_ / static_cast<std::uint64_t>(info.bytes);
    GLint64 limit = 0;
    glGetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
    if (texels > static_cast<std::uint64_t>(limit))
        throw MachineError(
            fmt::format("a buffer of {} texels ({}) is more than the {} texels that the device can address",
                        texels, info.name, limit));
    Name view = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &view);
    views_.emplace_back(format, Handle<deleteTexture>(view));
    if (rangeOf_ == 0)
        glTextureBuffer(view, glFormat(format).internal, name());
    else
        glTextureBufferRange(view, glFormat(format).internal, name(), static_cast<GLintptr>(offset_),
                             static_cast<GLsizeiptr>(bytes_));
    setLabel(GL_TEXTURE, view, fmt::format("{} texels of buffer {}", info.name, name()));
    return view;
}

void copyResource(const Buffer& from, const Buffer& to) {
    KESTREL_CHECK_EQ(from.bytes(), to.bytes());
    if (from.bytes() == 0) return;
    glCopyNamedBufferSubData(from.name(), to.name(), static_cast<GLintptr>(from.offset()),
                             static_cast<GLintptr>(to.offset()), static_cast<GLsizeiptr>(from.bytes()));
}

} // namespace kestrel::gl
