// What a step may do. The executor binds every declared use and the step's program before it calls
// Pass::execute, and sets barriers, debug groups and clocks around it.
#pragma once
#include "draw/draw.h"
#include "graph/pass.h"
#include "image/image.h"
#include "scene/geometry.h"
#include <functional>
#include <span>

namespace kestrel {

namespace gl {
class Buffer;
class Texture;
class Program;
} // namespace gl

// The frame that is being executed.
struct FrameInfo {
    std::uint32_t index = 0; // counts from 0; random numbers and jitter depend on it and on the seed alone
    std::uint32_t seed = 0;
    double time = 0; // seconds on the scene's timeline
    Extent size;
    int camera = 0;
    CameraState cameraState;         // of views of the frame
    CameraState previousCameraState; // of the last frame; equal if there is none
};

class Commands {
public:
    virtual ~Commands() = default;

    // ---- what is known
    [[nodiscard]] virtual const FrameInfo& frame() const = 0;
    [[nodiscard]] virtual const Scene& scene() const = 0;
    [[nodiscard]] virtual const SceneFacts& facts() const = 0;
    [[nodiscard]] virtual const Geometry& geometry() const = 0;              // at this frame's time
    [[nodiscard]] virtual const std::vector<LightState>& lights() const = 0; // at this frame's time
    [[nodiscard]] virtual const Capabilities& capabilities() const = 0;
    // Whether this step declares a use of the port.
    [[nodiscard]] virtual bool uses(std::string_view port) const = 0;
    [[nodiscard]] virtual const Desc& desc(std::string_view port) const = 0;
    // Why this pass runs in this frame: its own causes and those of all inputs. Everything in the first
    // frame.
    [[nodiscard]] virtual Causes causes() const = 0;
    // Why this input changed in this frame; None if it is as it was.
    [[nodiscard]] virtual Causes causes(std::string_view input) const = 0;

    // ---- the program of this step. A name that the variant does not have is skipped silently only if the
    // shader text does not mention it; otherwise it is an error of ours.
    virtual void set(std::string_view name, int value) = 0;
    virtual void set(std::string_view name, std::uint32_t value) = 0;
    virtual void set(std::string_view name, float value) = 0;
    virtual void set(std::string_view name, const glm::vec2& value) = 0;
    virtual void set(std::string_view name, const glm::vec3& value) = 0;
    virtual void set(std::string_view name, const glm::vec4& value) = 0;
    virtual void set(std::string_view name, const glm::ivec2& value) = 0;
    virtual void set(std::string_view name, const glm::ivec3& value) = 0;
    virtual void set(std::string_view name, const glm::mat3& value) = 0;
    virtual void set(std::string_view name, const glm::mat4& value) = 0;

    // Work groups.
    virtual void dispatch(std::uint32_t x, std::uint32_t y = 1, std::uint32_t z = 1) = 0;
    // At least that many invocations per axis: divided by the program's local size, rounded up.
    virtual void dispatchOver(std::uint32_t x, std::uint32_t y = 1, std::uint32_t z = 1) = 0;
    void dispatchOver(const Extent& extent) { dispatchOver(extent.width, extent.height, extent.depth); }
    // Group counts from a buffer port at a byte offset.
    virtual void dispatchIndirect(std::string_view port, std::uint64_t offset = 0) = 0;

    // The scene's triangles of the chosen classes; vertex inputs are those of lib/vertex.glsl. The viewport
    // is the attachments' extent, or state.viewport where there is no attachment.
    virtual void drawScene(const DrawState& state, const std::vector<TriangleClass>& classes) = 0;
    // The same `count` times, each into one layer of every attachment of the step, from layer 0 on:
    // `perLayer` sets what differs before layer i is drawn. Shaders need not choose the layer; the
    // attachments must be layered and have as many.
    virtual void drawSceneLayers(const DrawState& state, const std::vector<TriangleClass>& classes,
                                 std::uint32_t count,
                                 const std::function<void(std::uint32_t layer)>& perLayer) = 0;
    // One triangle that covers the target.
    virtual void drawFullscreen(const DrawState& state = DrawState::overwrite()) = 0;
    // `count` vertices without attributes (gl_VertexID), as triangles.
    virtual void drawVertices(const DrawState& state, std::uint32_t count, std::uint32_t instances = 1) = 0;
    // As many as a buffer port says at a byte offset (declare the use as Access::Indirect): vertices,
    // instances, first vertex, first instance.
    virtual void drawVerticesIndirect(const DrawState& state, std::string_view port,
                                      std::uint64_t offset = 0) = 0;

    // ---- data
    virtual void upload(std::string_view port, std::span<const std::byte> bytes,
                        std::uint64_t offset = 0) = 0;
    template<class T>
    void upload(std::string_view port, const std::vector<T>& items, std::uint64_t offset = 0) {
        upload(port, std::as_bytes(std::span(items)), offset);
    }
    template<class T>
    requires std::is_trivially_copyable_v<T>
    void uploadValue(std::string_view port, const T& value) {
        upload(port, std::as_bytes(std::span(&value, 1)));
    }
    virtual void uploadImage(std::string_view port, const Image& image) = 0;
    // Read back; waits for the GPU. Declare the use as Access::Host.
    [[nodiscard]] virtual std::vector<std::byte> download(std::string_view port) = 0;
    [[nodiscard]] virtual Image downloadImage(std::string_view port, int layer = 0, int mip = 0) = 0;
    virtual void clear(std::string_view port, const glm::vec4& value) = 0;
    virtual void generateMips(std::string_view port) = 0;

    // This output must hold `elements` (the meaning is the pass's own: Demand::grown tells it back at the
    // next compilation). The frame is compiled anew and run again.
    virtual void overflow(std::string_view port, std::uint64_t elements) = 0;
    // What the pass computed that belongs into the report: "hits", "exhausted rays", "reference noise"…
    virtual void report(std::string_view key, double value) = 0;
    // Of long work on the CPU, from 0 to 1.
    virtual void progress(double fraction) = 0;

    // For what is not covered above: the GL objects behind a port, and the step's program.
    [[nodiscard]] virtual const gl::Texture& texture(std::string_view port) const = 0;
    [[nodiscard]] virtual const gl::Buffer& buffer(std::string_view port) const = 0;
    [[nodiscard]] virtual gl::Program& program() = 0;
};

} // namespace kestrel
