// The scene's images as texture arrays (scene/texture_arrays.h says which image lies where).
#pragma once
#include "gl/program.h"
#include "scene/texture_arrays.h"
#include "shared/scene.h"

namespace kestrel {

// All images of one role: sRGB8 with alpha for colours, RGBA8 for data; all mip levels.
class SceneTextures {
public:
    // Where the images take more than TextureLimits, or than the device can give, they are reduced with a
    // warning that names figure and limit. Throws MachineError where there is no memory even so.
    SceneTextures(const Scene& scene, TextureRole role);

    // The record of a material's texture; `place` is noTexture where there is none.
    [[nodiscard]] shared::TextureRecord record(const Scene& scene, const TextureRef& reference) const;
    // Side of the image's square in its array, texels; 0 where it has none.
    [[nodiscard]] std::uint32_t side(int image) const;
    // The image's texels as they are uploaded, but `side` a side: 4 bytes each, rows top to bottom.
    [[nodiscard]] std::vector<std::uint8_t> square(const Scene& scene, int image, std::uint32_t side) const;
    // Binds to the units of an array of sampler2DArray; units beyond the arrays get one that reads white.
    void bind(const gl::Program::Slot& slot) const;
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

private:
    void upload(const Scene& scene);

    TextureRole role_;
    TextureArrays layout_;
    std::vector<bool> nearest_; // images that some material of the role reads without a filter
    std::vector<gl::Handle<gl::deleteTexture>> arrays_;
    std::uint64_t bytes_ = 0;
};

// How a TextureRecord's flags tell a wrap, two bits.
[[nodiscard]] std::uint32_t wrapCode(Wrap wrap);

} // namespace kestrel
