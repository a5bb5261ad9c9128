// Where masked surfaces have holes, laid out for hits of rays: a test costs four reads of texels, whatever
// the material's texture is like (shared/scene.h: CutoutRecord).
#pragma once
#include "draw/scene_textures.h"
#include "gl/objects.h"
#include "scene/geometry.h"
#include <vector>

namespace kestrel {

class Cutouts {
public:
    // Uploads the alpha of the images that masked and blended materials read. Where that is more than the
    // device can address in one buffer, those images are reduced with a warning that names figure and limit.
    Cutouts(const Scene& scene, const SceneTextures& colours);

    // One record a triangle from firstMaskedTriangle() on, of this order of triangles and corners.
    void setTriangles(const Geometry& geometry);

    [[nodiscard]] const gl::Buffer& records() const { return records_; } // rgba32ui
    [[nodiscard]] const gl::Buffer& alpha() const { return alpha_; }     // r32ui
    [[nodiscard]] std::uint32_t first() const { return first_; }         // triangle that has the first record
    [[nodiscard]] std::uint64_t bytes() const { return records_.bytes() + alpha_.bytes(); }

private:
    // What a material gives all of its records.
    struct Cut {
        TextureRef texture;
        std::uint32_t place = 0, size = 0;
        float alpha = 1, threshold = 0;
    };
    std::vector<Cut> materials_;
    gl::Buffer records_, alpha_;
    std::uint32_t first_ = 0;
};

} // namespace kestrel
