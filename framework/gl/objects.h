// Move-only owners of GL objects: direct state access only, always labelled.
#pragma once
#include "graph/types.h"
#include "image/image.h"
#include <cstddef>
#include <map>
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

// Bytes on the GPU, zero at first.
class Buffer {
public:
    Buffer() = default;
    // Throws MachineError with the size if there is not so much memory. Zero bytes are allowed.
    Buffer(std::uint64_t bytes, const std::string& label);
    // A range, which must lie inside and not outlive the buffer; everything below is meant of the range then.
    // `offset` must be a multiple of what the device asks of bound ranges (256 always is).
    [[nodiscard]] Buffer range(std::uint64_t offset, std::uint64_t bytes) const;
    [[nodiscard]] Name name() const { return rangeOf_ != 0 ? rangeOf_ : handle_.get(); }
    [[nodiscard]] std::uint64_t offset() const { return offset_; } // of the range in the object, else 0
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
    explicit operator bool() const { return name() != 0; }
    // As a block: GL_SHADER_STORAGE_BUFFER or GL_UNIFORM_BUFFER.
    void bind(unsigned int target, unsigned int unit) const;
    // The range must lie inside.
    void upload(std::span<const std::byte> data, std::uint64_t offset = 0);
    [[nodiscard]] std::vector<std::byte> download(std::uint64_t offset = 0,
                                                  std::uint64_t bytes = UINT64_MAX) const;
    void clear(std::uint32_t word = 0); // every whole 32-bit word
    // The buffer as a GL_TEXTURE_BUFFER of that texel format (made once a format): samplerBuffer,
    // imageBuffer. Throws MachineError if it holds more texels than the device can address.
    [[nodiscard]] Name texelView(Format format) const;

private:
    Handle<deleteBuffer> handle_;
    Name rangeOf_ = 0; // of a range: the object, which it does not own
    std::uint64_t offset_ = 0, bytes_ = 0;
    mutable std::vector<std::pair<Format, Handle<deleteTexture>>> views_;
};

// Texels on the GPU, zero at first.
class Texture {
public:
    Texture() = default;
    // Desc of any texture kind; extent.depth is the depth of a 3D texture or the layers of an array. Throws
    // MachineError if the device has not such a size (naming need and limit) or not so much memory.
    Texture(const Desc& desc, const std::string& label);
    [[nodiscard]] Name name() const { return handle_.get(); }
    [[nodiscard]] const Desc& desc() const { return desc_; }
    explicit operator bool() const { return bool(handle_); }
    // Differs for all textures ever made, where GL uses a name again after deletion.
    [[nodiscard]] std::uint64_t serial() const { return serial_; }
    // Layers of level `mip`: slices of a 3D texture, 6 of a cube, 1 of a plain one.
    [[nodiscard]] std::uint32_t layers(int mip = 0) const;
    [[nodiscard]] Extent extentOf(int mip) const; // of one level; depth as in desc()
    // One layer (3D: all slices if layer is -1). `bytes` must be what the format needs.
    void upload(std::span<const std::byte> bytes, int layer = 0, int mip = 0);
    void upload(const void* data, int layer = 0, int mip = 0); // tightly packed texels of the format
    // All levels and layers. Integer formats take the value rounded towards zero and clamped to their range.
    void clear(const glm::vec4& value);
    void generateMips();
    // Texels of one layer (3D: all slices if layer is -1), tightly packed.
    [[nodiscard]] std::vector<std::byte> download(int layer = 0, int mip = 0) const;
    // As floats with the format's channels, row 0 at the top of the image (GL's first row is the bottom one).
    [[nodiscard]] Image downloadImage(int layer = 0, int mip = 0) const;
    // Of the level's size; channels are converted (convertChannels), integers rounded and clamped.
    void uploadImage(const Image& image, int layer = 0, int mip = 0);

private:
    Handle<deleteTexture> handle_;
    Desc desc_;
    std::uint64_t serial_ = 0;
};

enum class Wrapping : std::uint8_t { ClampToEdge, Repeat, MirroredRepeat };

// How a texture is read through a sampler.
struct SamplerState {
    bool linear = false; // otherwise nearest
    bool mips = false;   // linear: between levels too; otherwise level 0 alone
    Wrapping wrapping = Wrapping::ClampToEdge;
    friend auto operator<=>(const SamplerState&, const SamplerState&) = default;
};

// Samplers by state, made once.
class SamplerCache {
public:
    Name get(const SamplerState& state);

private:
    std::vector<std::pair<SamplerState, Handle<deleteSampler>>> samplers_;
};

// A vertex array. Without attributes it serves draws by gl_VertexID.
class VertexArray {
public:
    VertexArray() = default;
    explicit VertexArray(const std::string& label);
    [[nodiscard]] Name name() const { return handle_.get(); }
    explicit operator bool() const { return bool(handle_); }
    // 32-bit indices.
    void setIndices(const Buffer& buffer);
    // `components` floats at `location`, `offset` bytes into each element of `stride` bytes.
    void setAttribute(unsigned int location, const Buffer& buffer, int components, std::uint32_t stride,
                      std::uint32_t offset);

private:
    Handle<deleteVertexArray> handle_;
};

// One attachment: a level, and a layer or all of them (-1: gl_Layer chooses; of a plain texture: itself).
struct Attachment {
    const Texture* texture = nullptr;
    int mip = 0;
    int layer = -1;
};

// What a step draws into.
struct Target {
    std::vector<Attachment> colours; // out locations 0, 1, …; a null texture leaves its location empty
    Attachment depth;
    [[nodiscard]] bool empty() const { return attachments().empty(); }
    // Those with a texture.
    [[nodiscard]] std::vector<Attachment*> attachments();
    [[nodiscard]] std::vector<const Attachment*> attachments() const;
};

// Framebuffers by their attachments, made once. They keep their textures' memory, so clear() must be called
// when textures are given back.
class FramebufferCache {
public:
    // Colours are out locations 0, 1, …; a null texture leaves its location empty. Without any attachment,
    // `extent` is the rasterized size (depth: layers, 1: not layered). Throws MachineError naming the formats
    // if the driver cannot draw to this combination.
    Name get(const std::vector<Attachment>& colours, const Attachment& depth, const Extent& extent);
    void clear() { framebuffers_.clear(); }
    [[nodiscard]] std::size_t size() const { return framebuffers_.size(); }

private:
    using Key = std::vector<std::uint64_t>;
    std::map<Key, Handle<deleteFramebuffer>> framebuffers_;
};

// GL enums of a format: internal format, pixel format, component type.
struct GlFormat {
    unsigned int internal = 0, pixel = 0, type = 0;
};
GlFormat glFormat(Format format);

// Values as a format's integers: rounded towards zero, clamped to the format's range.
std::int64_t toFormatInteger(Format format, float value);

// Whole contents; both must have the same description.
void copyResource(const Texture& from, const Texture& to);
void copyResource(const Buffer& from, const Buffer& to);

} // namespace kestrel::gl
