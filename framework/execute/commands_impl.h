// Commands on OpenGL: what one step does, with everything bound that it declared.
#pragma once
#include "execute/commands.h"
#include "execute/finite.h"
#include "execute/resources.h"
#include "execute/schedule.h"
#include "execute/step_bindings.h"
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace kestrel {

class GpuScene;

// What a frame is made of; all of it outlives the frame.
struct FrameScene {
    FrameInfo info;
    const Scene* scene = nullptr;
    const SceneFacts* facts = nullptr;
    const Geometry* geometry = nullptr;
    const std::vector<LightState>* lights = nullptr;
    GpuScene* gpu = nullptr;
    // Of the last frame; as now if there is none.
    double previousTime = 0;
    const std::vector<LightState>* previousLights = nullptr;
};

// What the steps of a frame tell the executor.
struct FrameReport {
    std::map<std::string, Growth> overflows;                     // pass -> output -> elements needed
    std::map<std::string, std::map<std::string, double>> values; // pass -> key -> value
    std::string step;                                            // that is running: "pass 'a', step 'b'"
    std::vector<BadOutput> bad; // of the last frame, in the order of the passes; with checkFinite on
    std::function<void(const std::string& what, double fraction)> progress;
    std::function<void(const std::string& step)> begins; // told before each step runs
    // Told each image (layer) that checkFinite looks at.
    std::function<void(const PortRef& port, const Image& image)> look;
};

class StepCommands final : public Commands {
public:
    struct Context {
        const Plan& plan;
        const FrameScene& frame;
        const Capabilities& capabilities;
        const std::vector<PassState>& states;
        Resources& resources;
        gl::FramebufferCache& framebuffers;
        const gl::VertexArray& noVertices; // without attributes
        const gl::Target& target;          // the step's attachments
        FrameReport& report;
    };
    // `targetSize` is the extent of the attachments, if there are any.
    StepCommands(const Context& context, int step, Programs::Entry* program,
                 std::optional<glm::uvec2> targetSize);

    [[nodiscard]] const FrameInfo& frame() const override { return context_.frame.info; }
    [[nodiscard]] const Scene& scene() const override { return *context_.frame.scene; }
    [[nodiscard]] const SceneFacts& facts() const override { return *context_.frame.facts; }
    [[nodiscard]] const Geometry& geometry() const override { return *context_.frame.geometry; }
    [[nodiscard]] const std::vector<LightState>& lights() const override { return *context_.frame.lights; }
    [[nodiscard]] const Capabilities& capabilities() const override { return context_.capabilities; }
    [[nodiscard]] bool uses(std::string_view port) const override;
    [[nodiscard]] const Desc& desc(std::string_view port) const override;
    [[nodiscard]] Causes causes() const override;
    [[nodiscard]] Causes causes(std::string_view input) const override;

    void set(std::string_view name, int value) override;
    void set(std::string_view name, std::uint32_t value) override;
    void set(std::string_view name, float value) override;
    void set(std::string_view name, const glm::vec2& value) override;
    void set(std::string_view name, const glm::vec3& value) override;
    void set(std::string_view name, const glm::vec4& value) override;
    void set(std::string_view name, const glm::ivec2& value) override;
    void set(std::string_view name, const glm::ivec3& value) override;
    void set(std::string_view name, const glm::mat3& value) override;
    void set(std::string_view name, const glm::mat4& value) override;

    void dispatch(std::uint32_t x, std::uint32_t y, std::uint32_t z) override;
    void dispatchOver(std::uint32_t x, std::uint32_t y, std::uint32_t z) override;
    void dispatchIndirect(std::string_view port, std::uint64_t offset) override;
    void drawScene(const DrawState& state, const std::vector<TriangleClass>& classes) override;
    void drawSceneLayers(const DrawState& state, const std::vector<TriangleClass>& classes,
                         std::uint32_t count,
                         const std::function<void(std::uint32_t layer)>& perLayer) override;
    void drawFullscreen(const DrawState& state) override;
    void drawVertices(const DrawState& state, std::uint32_t count, std::uint32_t instances) override;
    void drawVerticesIndirect(const DrawState& state, std::string_view port, std::uint64_t offset) override;

    void upload(std::string_view port, std::span<const std::byte> bytes, std::uint64_t offset) override;
    void uploadImage(std::string_view port, const Image& image) override;
    [[nodiscard]] std::vector<std::byte> download(std::string_view port) override;
    [[nodiscard]] Image downloadImage(std::string_view port, int layer, int mip) override;
    void clear(std::string_view port, const glm::vec4& value) override;
    void generateMips(std::string_view port) override;

    void overflow(std::string_view port, std::uint64_t elements) override;
    void report(std::string_view key, double value) override;
    void progress(double fraction) override;

    [[nodiscard]] const gl::Texture& texture(std::string_view port) const override;
    [[nodiscard]] const gl::Buffer& buffer(std::string_view port) const override;
    [[nodiscard]] gl::Program& program() override;

private:
    [[nodiscard]] const PlanPass& pass() const;
    [[nodiscard]] const PlanStep& step() const;
    // The resource behind a port that this step declares a use of; throws InputError otherwise.
    [[nodiscard]] int resourceOf(std::string_view port) const;
    [[nodiscard]] gl::Texture& textureOf(std::string_view port) const;
    [[nodiscard]] gl::Buffer& bufferOf(std::string_view port) const;
    // -1 if the variant does not have it; throws InputError if the shader text does not know the name.
    [[nodiscard]] int uniform(std::string_view name);
    // The framebuffer and viewport of a draw; the attachments' where there are any.
    void beginDraw(const DrawState& state);
    [[noreturn]] void fail(const std::string& message) const;

    Context context_;
    int step_;
    Programs::Entry* program_;
    std::optional<glm::uvec2> targetSize_;
};

} // namespace kestrel
