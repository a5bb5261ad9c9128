// The scene on the GPU: triangles, materials, textures, lights, bound by the reserved names of
// lib/scene.glsl.
#pragma once
#include "draw/cutouts.h"
#include "draw/draw.h"
#include "draw/scene_textures.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "scene/geometry.h"
#include <optional>
#include <string_view>
#include <vector>

namespace kestrel {

class GpuScene {
public:
    // Uploads materials and textures. The scene must outlive this. Throws MachineError where the device has
    // not the memory or the layers.
    explicit GpuScene(const Scene& scene);
    explicit GpuScene(Scene&&) = delete;

    // The triangles at another time of the scene: the first call sends everything, later ones what moves
    // (Geometry::moving), and the triangles again where instances were turned over (Geometry::turns). The
    // geometry must stay until the next call.
    void update(const Geometry& geometry);
    void setLights(const std::vector<LightState>& lights);

    // Whether a name of a block, sampler, image or uniform is one that bind() or draw() serves.
    [[nodiscard]] static bool reserves(std::string_view name);
    // Binds all reserved names that the program has; cutouts are made for the first that has theirs. Throws
    // MachineError if the program reads texel buffers of more texels than the device can address.
    void bind(const gl::Program& program);
    // One draw call a class; vertex inputs are those of lib/vertex.glsl. The program must be in use and
    // bound, the framebuffer and viewport set. Double-sided classes are never culled.
    void draw(const DrawState& state, const std::vector<TriangleClass>& classes,
              const gl::Program& program) const;

    [[nodiscard]] std::uint32_t triangleCount() const { return triangleCount_; }
    [[nodiscard]] std::uint64_t bytes() const; // on the GPU

private:
    struct TexelSource {
        std::string_view uniform, block;
        const gl::Buffer& buffer;
        Format format;
    };
    [[nodiscard]] std::vector<TexelSource> texelSources() const;
    void bindCutouts(const gl::Program& program);
    bool uploadTopology(const Geometry& geometry); // whether the buffer of indices is a new one
    void linkVertexArray();

    const Scene& scene_;
    const Geometry* geometry_ = nullptr; // of the last update(), for cutouts that are asked for later
    SceneTextures colours_, data_;
    std::optional<Cutouts> cutouts_; // once they are asked for: their alpha takes 4 bytes a texel
    gl::Buffer materials_, lights_;
    gl::Buffer positions_, previousPositions_, vertices_, indices_, triangles_;
    gl::VertexArray vertexArray_;
    gl::VertexArray noVertices_; // of draws by number
    Geometry::Range ranges_[static_cast<size_t>(TriangleClass::Count)];
    std::uint32_t triangleCount_ = 0;
    bool moves_ = false; // previous positions differ
    std::vector<LightState> uploadedLights_;
    bool hasTopology_ = false;
    std::uint32_t turns_ = 0; // of the topology
};

} // namespace kestrel
