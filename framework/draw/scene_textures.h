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
    // Binds to the units of an array of sampler2DArray; units beyond the arrays get one that reads white.
    void bind(const gl::Program::Slot& slot) const;
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

private:
    void upload(const Scene& scene, TextureRole role);

    TextureArrays layout_;
    std::vector<gl::Handle<gl::deleteTexture>> arrays_;
    std::uint64_t bytes_ = 0;
};

} // namespace kestrel
