#include "draw/scene_textures.h"
#include "core/error.h"
#include "core/log.h"
#include "draw/resample.h"
#include "gl/loader.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace kestrel {
namespace {

using shared::TextureRecord;

gl::Handle<gl::deleteTexture> makeArray(std::uint32_t side, size_t layers, TextureRole role) {
    GLint most = 0;
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most);
    if (layers > static_cast<size_t>(most))
        throw MachineError(
            fmt::format("the scene has {} textures of {}x{} texels, the device takes {} layers", layers, side,
                        side, most));
    gl::Name name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    gl::Handle<gl::deleteTexture> handle(name);
    const bool colour = role == TextureRole::Colour;
    const auto size = static_cast<GLsizei>(side);
    GLenum error = GL_NO_ERROR;
    {
        const gl::ExpectErrors expect;
        glTextureStorage3D(name, std::bit_width(side), colour ? GL_SRGB8_ALPHA8 : GL_RGBA8, size, size,
                           static_cast<GLsizei>(layers));
        error = expect.take();
    }
    if (error != GL_NO_ERROR)
        throw MachineError(fmt::format("no memory for {} textures of {}x{} texels (GL error 0x{:x})", layers,
                                       side, side, error));
    const std::string label = fmt::format("scene {} {}", colour ? "colour" : "data", side);
    glObjectLabel(GL_TEXTURE, name, static_cast<GLsizei>(label.size()), label.c_str());
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_REPEAT);
    return handle;
}

void uploadLayer(gl::Name array, size_t layer, std::uint32_t side, const std::vector<std::uint8_t>& texels) {
    const auto size = static_cast<GLsizei>(side);
    glTextureSubImage3D(array, 0, 0, 0, static_cast<GLint>(layer), size, size, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                        texels.data());
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

} // namespace

SceneTextures::SceneTextures(const Scene& scene, TextureRole role)
    : layout_(textureArrays(scene, role)) {
    const std::vector<bool> nearest = unfiltered(scene, role);
    for (const TextureArrays::Array& array : layout_.arrays) {
        auto made = makeArray(array.side, array.images.size(), role);
        for (size_t layer = 0; layer < array.images.size(); ++layer) {
            const auto index = static_cast<size_t>(array.images[layer]);
            const TextureImage& image = scene.images[index];
            if (std::max(image.width, image.height) > static_cast<int>(array.side))
                logWarning("image '{}' of {}x{} is reduced to {} texels a side", image.name, image.width,
                           image.height, array.side);
            uploadLayer(made.get(), layer, array.side,
                        resampleToSquare(image, array.side, role == TextureRole::Colour,
                                         nearest[index] ? ResampleFilter::Nearest : ResampleFilter::Smooth));
        }
        glGenerateTextureMipmap(made.get());
        // A full pyramid has a third more texels than its base.
        bytes_ += std::uint64_t{4} * array.side * array.side * array.images.size() * 4 / 3;
        arrays_.push_back(std::move(made));
    }
    if (arrays_.empty()) {
        arrays_.push_back(makeArray(1, 1, role));
        uploadLayer(arrays_.back().get(), 0, 1, {255, 255, 255, 255});
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
