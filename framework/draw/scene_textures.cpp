#include "draw/scene_textures.h"
#include "core/error.h"
#include "core/log.h"
#include "draw/resample.h"
#include "gl/debug_output.h"
#include "gl/loader.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

using shared::TextureRecord;

const char* nameOf(TextureRole role) { return role == TextureRole::Colour ? "colour" : "data"; }

// Nothing where the device has not the memory.
gl::Handle<gl::deleteTexture> makeArray(std::uint32_t side, size_t layers, TextureRole role) {
    gl::Name name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    gl::Handle<gl::deleteTexture> handle(name);
    const bool colour = role == TextureRole::Colour;
    const auto size = static_cast<GLsizei>(side);
    GLenum error = GL_NO_ERROR;
    {
        const gl::ExpectErrors expect;
        glTextureStorage3D(name, static_cast<GLsizei>(std::bit_width(side)),
                           colour ? GL_SRGB8_ALPHA8 : GL_RGBA8, size, size, static_cast<GLsizei>(layers));
        error = expect.take();
    }
    if (error != GL_NO_ERROR) return {};
    gl::setLabel(GL_TEXTURE, name, fmt::format("scene {} {}", nameOf(role), side));
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_REPEAT);
    return handle;
}

void uploadSquare(gl::Name array, const TextureArrays::Place& place, std::uint32_t side,
                  const std::vector<std::uint8_t>& texels) {
    const auto size = static_cast<GLsizei>(side);
    glTextureSubImage3D(array, 0, static_cast<GLint>(place.x), static_cast<GLint>(place.y), place.layer, size,
                        size, 1, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
}

// A full pyramid has a third more texels than its base.
std::uint64_t bytesOf(const TextureArrays& layout) {
    std::uint64_t bytes = 0;
    for (const TextureArrays::Array& array : layout.arrays)
        bytes += std::uint64_t{4} * array.layerSide() * array.layerSide() * array.layers() * 4 / 3;
    return bytes;
}

// Empty where the device has not the memory.
std::vector<gl::Handle<gl::deleteTexture>> makeArrays(const TextureArrays& layout, TextureRole role) {
    std::vector<gl::Handle<gl::deleteTexture>> arrays;
    for (const TextureArrays::Array& array : layout.arrays) {
        arrays.push_back(makeArray(array.layerSide(), array.layers(), role));
        if (!arrays.back()) return {};
    }
    return arrays;
}

// Images that some material of this role reads without a filter.
std::vector<bool> unfiltered(const Scene& scene, TextureRole role) {
    std::vector<bool> result(scene.images.size(), false);
    const auto mark = [&](const TextureRef& reference) {
        if (reference.present() && reference.nearest && static_cast<size_t>(reference.image) < result.size())
            result[static_cast<size_t>(reference.image)] = true;
    };
    for (const Material& material : scene.materials) {
        mark(role == TextureRole::Colour ? material.baseColourTexture : material.metallicRoughnessTexture);
        mark(role == TextureRole::Colour ? material.emissionTexture : material.normalTexture);
    }
    return result;
}

} // namespace

std::uint32_t wrapCode(Wrap wrap) {
    switch (wrap) {
    case Wrap::Repeat:
        return 0;
    case Wrap::MirroredRepeat:
        return 1;
    case Wrap::ClampToEdge:
        break;
    }
    return 2;
}

SceneTextures::SceneTextures(const Scene& scene, TextureRole role)
    : role_(role)
    , layout_(textureArrays(scene, role))
    , nearest_(unfiltered(scene, role)) {
    if (layout_.side < maxTextureSide)
        logWarning("the {} textures take {} texels, at most {} are kept: they are reduced to {} a side",
                   nameOf(role), layout_.wantedTexels, TextureLimits{}.texels, layout_.side);
    const bool tiled = layout_.tiled();
    arrays_ = makeArrays(layout_, role);
    while (arrays_.size() < layout_.arrays.size()) {
        const std::uint64_t wanted = bytesOf(layout_);
        layout_ = textureArrays(scene, role, {.side = layout_.side / 2});
        // Shaders are compiled for the first layout.
        if (layout_.side < 64 || layout_.tiled() != tiled)
            throw MachineError(fmt::format("no memory for the {} textures of the scene: they take {} bytes",
                                           nameOf(role), wanted));
        logWarning(
            "the device has no memory for {} textures of {} bytes: they are reduced to {} texels a side",
            nameOf(role), wanted, layout_.side);
        arrays_ = makeArrays(layout_, role);
    }
    upload(scene);
    bytes_ = layout_.arrays.empty() ? 0 : bytesOf(layout_);
    if (!arrays_.empty()) return;
    arrays_.push_back(makeArray(1, 1, role));
    uploadSquare(arrays_.back().get(), {0, 0}, 1, {255, 255, 255, 255});
}

std::uint32_t SceneTextures::side(int image) const {
    if (image < 0 || static_cast<size_t>(image) >= layout_.places.size()) return 0;
    const int array = layout_.places[static_cast<size_t>(image)].array;
    return array < 0 ? 0 : layout_.arrays[static_cast<size_t>(array)].side;
}

std::vector<std::uint8_t> SceneTextures::square(const Scene& scene, int image, std::uint32_t side) const {
    const auto index = static_cast<size_t>(image);
    return resampleToSquare(scene.images[index], side, role_ == TextureRole::Colour,
                            nearest_[index] ? ResampleFilter::Nearest : ResampleFilter::Smooth);
}

void SceneTextures::upload(const Scene& scene) {
    for (size_t i = 0; i < arrays_.size(); ++i) {
        const TextureArrays::Array& array = layout_.arrays[i];
        for (const int image : array.images) {
            const auto index = static_cast<size_t>(image);
            const TextureImage& source = scene.images[index];
            if (std::max(source.width, source.height) > static_cast<int>(array.side) &&
                layout_.side == maxTextureSide)
                logWarning("image '{}' of {}x{} is reduced to {} texels a side", source.name, source.width,
                           source.height, array.side);
            uploadSquare(arrays_[i].get(), layout_.places[index], array.side,
                         square(scene, image, array.side));
        }
        glGenerateTextureMipmap(arrays_[i].get());
    }
}

TextureRecord SceneTextures::record(const Scene& scene, const TextureRef& reference) const {
    TextureRecord record{};
    record.place = shared::noTexture;
    record.side = 1;
    record.source = {1, 1};
    if (!reference.present() || static_cast<size_t>(reference.image) >= layout_.places.size()) return record;
    const auto index = static_cast<size_t>(reference.image);
    const TextureArrays::Place place = layout_.places[index];
    if (place.array < 0) return record;
    const TextureImage& image = scene.images[index];

    // KHR_texture_transform: scale, then rotate, then move.
    const float cosine = std::cos(reference.rotation);
    const float sine = std::sin(reference.rotation);
    record.matrix = {cosine * reference.scale.x, -sine * reference.scale.x, sine * reference.scale.y,
                     cosine * reference.scale.y};
    record.offset = reference.offset;
    record.place = static_cast<std::uint32_t>(place.array) | static_cast<std::uint32_t>(place.layer) << 8;
    record.flags = wrapCode(reference.wrapS) << shared::textureWrapShiftS | wrapCode(reference.wrapT)
                                                                                << shared::textureWrapShiftT;
    if (reference.texCoord == 1) record.flags |= shared::textureFlagSecondTexCoord;
    if (reference.nearest) record.flags |= shared::textureFlagNearest;
    record.source = {static_cast<std::uint32_t>(std::max(image.width, 1)),
                     static_cast<std::uint32_t>(std::max(image.height, 1))};
    record.side = layout_.arrays[static_cast<size_t>(place.array)].side;
    record.corner = place.x | place.y << 16;
    return record;
}

void SceneTextures::bind(const gl::Program::Slot& slot) const {
    for (int i = 0; i < slot.count; ++i) {
        const size_t array = std::min(static_cast<size_t>(i), arrays_.size() - 1);
        glBindTextureUnit(slot.unit + static_cast<unsigned int>(i), arrays_[array].get());
        glBindSampler(slot.unit + static_cast<unsigned int>(i), 0);
    }
}

} // namespace kestrel
