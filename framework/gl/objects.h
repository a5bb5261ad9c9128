// Move-only owners of GL objects: direct state access only, always labelled.
#pragma once
#include "graph/types.h"
#include "image/image.h"
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kestrel::gl {

using Name = unsigned int; // a GL object's name; 0: none

// Owns one name; Delete is called with it unless it was moved from.
template<void (*Delete)(Name)>
class Handle {
public:
    Handle() = default;
    explicit Handle(Name name)
        : name_(name) {}
    Handle(Handle&& other) noexcept
        : name_(std::exchange(other.name_, 0)) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (name_ != 0) Delete(name_);
    }
    [[nodiscard]] Name get() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

private:
    Name name_ = 0;
};

void deleteBuffer(Name name);
void deleteTexture(Name name);
void deleteFramebuffer(Name name);
void deleteVertexArray(Name name);
void deleteSampler(Name name);

class Buffer {
public:
    Buffer() = default;
    Buffer(std::uint64_t bytes, const std::string& label);
    [[nodiscard]] Name name() const { return handle_.get(); }
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
    void upload(std::span<const std::byte> data, std::uint64_t offset = 0);
    [[nodiscard]] std::vector<std::byte> download(std::uint64_t offset = 0,
                                                  std::uint64_t bytes = UINT64_MAX) const;
    void clear(std::uint32_t word = 0); // every 32-bit word
    // The buffer as a GL_TEXTURE_BUFFER of that texel format (made once a format): samplerBuffer,
    // imageBuffer.
    [[nodiscard]] Name texelView(Format format) const;

private:
    Handle<deleteBuffer> handle_;
    std::uint64_t bytes_ = 0;
    mutable std::vector<std::pair<Format, Handle<deleteTexture>>> views_;
};

class Texture {
public:
    Texture() = default;
    // Desc of any texture kind.
    Texture(const Desc& desc, const std::string& label);
    [[nodiscard]] Name name() const { return handle_.get(); }
    [[nodiscard]] const Desc& desc() const { return desc_; }
    void upload(const void* data, int layer = 0, int mip = 0); // tightly packed texels of the format
    void clear(const glm::vec4& value);
    void generateMips();
    // Texels of one layer (3D: all slices if layer is -1), tightly packed.
    [[nodiscard]] std::vector<std::byte> download(int layer = 0, int mip = 0) const;
    // As floats, row 0 at the top of the image (GL's first row is the bottom one).
    [[nodiscard]] Image downloadImage(int layer = 0, int mip = 0) const;
    void uploadImage(const Image& image);

private:
    Handle<deleteTexture> handle_;
    Desc desc_;
};

// GL enums of a format: internal format, pixel format, component type.
struct GlFormat {
    unsigned int internal = 0, pixel = 0, type = 0;
};
GlFormat glFormat(Format format);

void copyResource(const Texture& from, const Texture& to);
void copyResource(const Buffer& from, const Buffer& to);

} // namespace kestrel::gl
