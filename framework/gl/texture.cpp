#include "core/check.h"
#include "core/error.h"
#include "gl/debug_output.h"
#include "gl/loader.h"
#include "gl/objects.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <fmt/format.h>

namespace kestrel::gl {

void deleteTexture(Name name) { glDeleteTextures(1, &name); }

namespace {

std::uint64_t nextSerial() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

GLenum targetOf(ResourceKind kind) {
    switch (kind) {
    case ResourceKind::Texture2D:
        return GL_TEXTURE_2D;
    case ResourceKind::Texture2DArray:
        return GL_TEXTURE_2D_ARRAY;
    case ResourceKind::TextureCube:
        return GL_TEXTURE_CUBE_MAP;
    case ResourceKind::Texture3D:
        return GL_TEXTURE_3D;
    case ResourceKind::Buffer:
    case ResourceKind::Module:
        break;
    }
    KESTREL_CHECK(!"a texture kind was expected");
    return GL_TEXTURE_2D;
}

bool hasLayers(ResourceKind kind) { return kind != ResourceKind::Texture2D; }

void requireSize(const Desc& desc, const std::string& label) {
    const auto require = [&](std::uint32_t value, int limit, const char* what) {
        if (value == 0) KESTREL_CHECK(!"a texture without texels");
        if (value > static_cast<std::uint32_t>(limit))
            throw MachineError(fmt::format("texture '{}' needs {} {}, the device has at most {}", label,
                                           value, what, limit));
    };
    const int side = glInteger(desc.kind == ResourceKind::Texture3D     ? GL_MAX_3D_TEXTURE_SIZE
                               : desc.kind == ResourceKind::TextureCube ? GL_MAX_CUBE_MAP_TEXTURE_SIZE
                                                                        : GL_MAX_TEXTURE_SIZE);
    require(desc.extent.width, side, "texels in width");
    require(desc.extent.height, side, "texels in height");
    if (desc.kind == ResourceKind::Texture3D) require(desc.extent.depth, side, "texels in depth");
    if (desc.kind == ResourceKind::Texture2DArray)
        require(desc.extent.depth, glInteger(GL_MAX_ARRAY_TEXTURE_LAYERS), "layers");
}

// A value of the format, as glClearTexImage takes it.
struct ClearValue {
    std::array<float, 4> floats{};
    std::array<std::uint32_t, 4> integers{};
    const void* data = nullptr;
    GLenum pixel = 0, type = 0;
};

void setClearValue(ClearValue& result, Format format, const glm::vec4& value) {
    const FormatInfo& info = formatInfo(format);
    for (int i = 0; i < 4; ++i) {
        const auto at = static_cast<size_t>(i);
        result.floats[at] = value[i];
        if (info.integer) result.integers[at] = static_cast<std::uint32_t>(toFormatInteger(format, value[i]));
    }
    result.pixel = info.depth ? GL_DEPTH_COMPONENT : info.integer ? GL_RGBA_INTEGER : GL_RGBA;
    result.type = info.integer ? (info.isSigned ? GL_INT : GL_UNSIGNED_INT) : GL_FLOAT;
    result.data = info.integer ? static_cast<const void*>(result.integers.data()) : result.floats.data();
}

// Which part of a level is moved: layers [first, first + count).
struct Slices {
    GLint first = 0;
    GLsizei count = 1;
};

Slices slicesOf(const Texture& texture, int layer, int mip) {
    const auto layers = static_cast<int>(texture.layers(mip));
    KESTREL_CHECK(mip >= 0 && mip < texture.desc().mips);
    KESTREL_CHECK(layer >= -1 && layer < layers);
    return layer < 0 ? Slices{0, layers} : Slices{layer, 1};
}

size_t texelsOf(const Extent& extent, const Slices& slices) {
    return size_t{extent.width} * extent.height * static_cast<size_t>(slices.count);
}

void uploadTexels(const Texture& texture, const void* data, GLenum pixel, GLenum type, int layer, int mip) {
    const Extent extent = texture.extentOf(mip);
    const auto width = static_cast<GLsizei>(extent.width);
    const auto height = static_cast<GLsizei>(extent.height);
    const Slices slices = slicesOf(texture, layer, mip);
    if (hasLayers(texture.desc().kind)) {
        glTextureSubImage3D(texture.name(), mip, 0, 0, slices.first, width, height, slices.count, pixel, type,
                            data);
    } else {
        glTextureSubImage2D(texture.name(), mip, 0, 0, width, height, pixel, type, data);
    }
}

void downloadTexels(const Texture& texture, void* data, size_t bytes, GLenum pixel, GLenum type, int layer,
                    int mip) {
    const Extent extent = texture.extentOf(mip);
    const Slices slices = slicesOf(texture, layer, mip);
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT); // image stores before reading back
    glGetTextureSubImage(texture.name(), mip, 0, 0, slices.first, static_cast<GLsizei>(extent.width),
                         static_cast<GLsizei>(extent.height), slices.count, pixel, type,
                         static_cast<GLsizei>(bytes), data);
}

// The float or 32-bit integer form in which images are moved.
GLenum imageType(const FormatInfo& info) {
    if (!info.integer) return GL_FLOAT;
    return info.isSigned ? GL_INT : GL_UNSIGNED_INT;
}

// GL's first row is the bottom one, an image's the top one.
template<class T>
void flipRows(std::vector<T>& values, size_t rowLength) {
    const size_t rows = values.size() / rowLength;
    for (size_t y = 0; y < rows / 2; ++y)
        std::swap_ranges(values.begin() + static_cast<std::ptrdiff_t>(y * rowLength),
                         values.begin() + static_cast<std::ptrdiff_t>((y + 1) * rowLength),
                         values.begin() + static_cast<std::ptrdiff_t>((rows - 1 - y) * rowLength));
}

} // namespace

Texture::Texture(const Desc& desc, const std::string& label)
    : desc_(desc)
    , serial_(nextSerial()) {
    requireSize(desc, label);
    const Extent& extent = desc.extent;
    const std::uint32_t slices = desc.kind == ResourceKind::Texture3D ? extent.depth : 1;
    // Signed or not: what std::bit_width returns has changed between libraries.
    const auto mostMips = static_cast<int>(std::bit_width(std::max({extent.width, extent.height, slices})));
    KESTREL_CHECK(desc.mips >= 1 && desc.mips <= mostMips);
    Name texture = 0;
    glCreateTextures(targetOf(desc.kind), 1, &texture);
    handle_ = Handle<deleteTexture>(texture);
    const GLenum internal = glFormat(desc.format).internal;
    const auto width = static_cast<GLsizei>(desc.extent.width);
    const auto height = static_cast<GLsizei>(desc.extent.height);
    const auto depth = static_cast<GLsizei>(desc.extent.depth);
    const bool threeSizes = desc.kind == ResourceKind::Texture3D || desc.kind == ResourceKind::Texture2DArray;
    GLenum error = GL_NO_ERROR;
    {
        const ExpectErrors expect;
        if (threeSizes)
            glTextureStorage3D(texture, desc.mips, internal, width, height, depth);
        else
            glTextureStorage2D(texture, desc.mips, internal, width, height);
        error = expect.take();
    }
    if (error != GL_NO_ERROR)
        throw MachineError(fmt::format("no memory for texture '{}', {}, {} bytes (GL error 0x{:x})", label,
                                       describe(desc), desc.totalBytes(), error));
    setLabel(GL_TEXTURE, texture, label);
    // Without a sampler a texture is read as it is: no filter between texels, no level but those it has.
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER,
                        desc.mips > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glTextureParameteri(texture, axis, GL_CLAMP_TO_EDGE);
    clear(glm::vec4(0));
}

std::uint32_t Texture::layers(int mip) const {
    switch (desc_.kind) {
    case ResourceKind::Texture3D:
        return std::max(desc_.extent.depth >> mip, 1U);
    case ResourceKind::Texture2DArray:
        return desc_.extent.depth;
    case ResourceKind::TextureCube:
        return 6;
    default:
        return 1;
    }
}

Extent Texture::extentOf(int mip) const {
    const bool shrinks = desc_.kind == ResourceKind::Texture3D;
    return {std::max(desc_.extent.width >> mip, 1U), std::max(desc_.extent.height >> mip, 1U),
            shrinks ? std::max(desc_.extent.depth >> mip, 1U) : desc_.extent.depth};
}

void Texture::upload(std::span<const std::byte> bytes, int layer, int mip) {
    const size_t needed = texelsOf(extentOf(mip), slicesOf(*this, layer, mip)) *
                          static_cast<size_t>(formatInfo(desc_.format).bytes);
    KESTREL_CHECK_EQ(bytes.size(), needed);
    upload(static_cast<const void*>(bytes.data()), layer, mip);
}

void Texture::upload(const void* data, int layer, int mip) {
    const GlFormat format = glFormat(desc_.format);
    uploadTexels(*this, data, format.pixel, format.type, layer, mip);
}

void Texture::clear(const glm::vec4& value) {
    ClearValue clearValue;
    setClearValue(clearValue, desc_.format, value);
    for (int mip = 0; mip < desc_.mips; ++mip)
        glClearTexImage(name(), mip, clearValue.pixel, clearValue.type, clearValue.data);
}

void Texture::generateMips() { glGenerateTextureMipmap(name()); }

std::vector<std::byte> Texture::download(int layer, int mip) const {
    const size_t texels = texelsOf(extentOf(mip), slicesOf(*this, layer, mip));
    std::vector<std::byte> result(texels * static_cast<size_t>(formatInfo(desc_.format).bytes));
    const GlFormat format = glFormat(desc_.format);
    downloadTexels(*this, result.data(), result.size(), format.pixel, format.type, layer, mip);
    return result;
}

Image Texture::downloadImage(int layer, int mip) const {
    KESTREL_CHECK_LE(0, layer);
    const Extent extent = extentOf(mip);
    const FormatInfo& info = formatInfo(desc_.format);
    Image image(static_cast<int>(extent.width), static_cast<int>(extent.height), info.channels);
    const GLenum pixel = glFormat(desc_.format).pixel;
    const size_t bytes = image.values.size() * sizeof(float);
    if (info.integer) {
        std::vector<std::uint32_t> integers(image.values.size());
        downloadTexels(*this, integers.data(), bytes, pixel, imageType(info), layer, mip);
        std::transform(integers.begin(), integers.end(), image.values.begin(), [&](std::uint32_t value) {
            return info.isSigned ? static_cast<float>(static_cast<std::int32_t>(value))
                                 : static_cast<float>(value);
        });
    } else {
        downloadTexels(*this, image.values.data(), bytes, pixel, GL_FLOAT, layer, mip);
    }
    flipRows(image.values, static_cast<size_t>(image.width) * static_cast<size_t>(image.channels));
    return image;
}

void Texture::uploadImage(const Image& image, int layer, int mip) {
    KESTREL_CHECK_LE(0, layer);
    const Extent extent = extentOf(mip);
    KESTREL_CHECK_EQ(static_cast<std::uint32_t>(image.width), extent.width);
    KESTREL_CHECK_EQ(static_cast<std::uint32_t>(image.height), extent.height);
    const FormatInfo& info = formatInfo(desc_.format);
    Image converted = convertChannels(image, info.channels);
    flipRows(converted.values, static_cast<size_t>(image.width) * static_cast<size_t>(info.channels));
    const GLenum pixel = glFormat(desc_.format).pixel;
    if (!info.integer) {
        uploadTexels(*this, converted.values.data(), pixel, GL_FLOAT, layer, mip);
        return;
    }
    std::vector<std::uint32_t> integers(converted.values.size());
    std::transform(converted.values.begin(), converted.values.end(), integers.begin(), [&](float value) {
        return static_cast<std::uint32_t>(toFormatInteger(desc_.format, value));
    });
    uploadTexels(*this, integers.data(), pixel, imageType(info), layer, mip);
}

void copyResource(const Texture& from, const Texture& to) {
    KESTREL_CHECK(from.desc().kind == to.desc().kind && from.desc().format == to.desc().format &&
                  from.desc().extent == to.desc().extent && from.desc().mips == to.desc().mips);
    const GLenum target = targetOf(from.desc().kind);
    for (int mip = 0; mip < from.desc().mips; ++mip) {
        const Extent extent = from.extentOf(mip);
        glCopyImageSubData(from.name(), target, mip, 0, 0, 0, to.name(), target, mip, 0, 0, 0,
                           static_cast<GLsizei>(extent.width), static_cast<GLsizei>(extent.height),
                           static_cast<GLsizei>(from.layers(mip)));
    }
}

} // namespace kestrel::gl
