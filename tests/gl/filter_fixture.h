// What the tests of the temporal passes share: a pass whose outputs are images that a test gives frame by
// frame.
#pragma once
#include "execute/commands.h"
#include "shared/random.h"
#include "shipped_fixture.h"
#include <functional>
#include <map>

namespace kestrel::test {

inline constexpr Extent size{48, 32, 1};
inline const PortRef result{"filter", "result"};

// The content of output `port` in frame `index`. What is missing is not connected.
using FrameImages = std::map<std::string, std::function<Image(std::uint32_t index)>>;

inline const char* const givenPorts[] = {"signal", "depth", "normal", "motion", "weight"};

// Outputs the images of `given`, which must outlive the renderers.
struct GivenImages final : Pass {
    static inline const FrameImages* given = nullptr;

    static PassType type() {
        Describe<GivenImages> table("GivenImages", "Images that a test gives");
        for (const char* port : givenPorts) table.output(port, PortKind::Texture, "As given");
        table.number("colours", &GivenImages::colours, 1, 4, "", "Channels of the signal");
        table.flag("jitter", &GivenImages::jitter, "The images are jittered ones");
        return table;
    }
    [[nodiscard]] Declaration declare(const World& world, const Inputs&, const Demand&) const override {
        Declaration declaration;
        Step step{.name = "give"};
        for (const auto& [port, image] : *given) {
            Format format = Format::R32F;
            if (port == "normal" || (port == "signal" && colours == 4)) format = Format::RGBA32F;
            if (port == "motion") format = Format::RG32F;
            declaration.outputs.push_back(
                {.port = port, .desc = Desc::texture2D(format, world.size, {.jitter = jitter})});
            step.uses.push_back({.port = port, .access = Access::Copy, .write = true});
        }
        declaration.steps.push_back(std::move(step));
        declaration.depends = Causes::Frame;
        return declaration;
    }
    void execute(const Step& step, Commands& commands) override {
        for (const Use& use : step.uses)
            commands.uploadImage(use.port, given->at(use.port)(commands.frame().index));
    }

    int colours = 1;
    bool jitter = false;
};

struct FilterTest : ShippedTest {
    static const Registry& registry() {
        static const Registry instance = [] {
            Registry made = shipped();
            made.add(GivenImages::type());
            return made;
        }();
        return instance;
    }

    // One image for all frames.
    static std::function<Image(std::uint32_t)> always(Image image) {
        return [image = std::move(image)](std::uint32_t) { return image; };
    }

    // `pass` of type `type` with these properties, fed with all given images by equal names; output "result".
    static Graph graphOf(const std::string& type, const FrameImages& given,
                         const std::vector<std::string>& settings,
                         const std::vector<std::string>& outputs = {"result"}) {
        GivenImages::given = &given;
        Graph graph;
        graph.name = "test";
        for (const auto& [name, passType] :
             {std::pair<std::string, std::string>{"given", "GivenImages"}, {"filter", type}}) {
            GraphPass pass;
            pass.name = name;
            pass.type = passType;
            graph.passes.push_back(pass);
        }
        for (const auto& [port, image] : given) {
            const std::string input = type == "TemporalAA" && port == "signal" ? "colour" : port;
            graph.edges.push_back({{"given", port}, {"filter", input}, {}});
        }
        for (const std::string& output : outputs) graph.outputs.push_back({{"filter", output}, {}});
        for (const std::string& setting : settings) applySetting(graph, registry(), setting);
        return graph;
    }

    // Looks along -z from the origin, so that a normal of (0, 0, 1) faces it.
    static CameraState straightCamera() {
        CameraState camera;
        camera.nearPlane = 0.1f;
        camera.farPlane = 0;
        return camera;
    }
    // Reversed depth of that camera at a distance along the view axis.
    static float depthAt(float viewDepth) { return 0.1f / viewDepth; }

    struct GivenRenderer : Renderer {
        GivenRenderer(const Graph& graph, Extent extent,
                      const Capabilities& capabilities = context().capabilities())
            : Renderer(graph, registry(), trianglesScene(square()), capabilities, options(extent)) {
            setFreeCamera(straightCamera());
        }
        static RenderOptions options(Extent extent) {
            RenderOptions made;
            made.size = extent;
            made.checkFinite = true;
            return made;
        }
    };

    static Image uniform(Extent extent, int channels, float value) {
        return Image(static_cast<int>(extent.width), static_cast<int>(extent.height), channels, value);
    }
    static Image facing(Extent extent) {
        Image normals = uniform(extent, 4, 0);
        for (size_t i = 2; i < normals.values.size(); i += 4) normals.values[i] = 1;
        return normals;
    }
    // A wall at distance 2 that fills the picture and stands still.
    static FrameImages wall(Extent extent) {
        return {{"depth", always(uniform(extent, 1, depthAt(2)))},
                {"normal", always(facing(extent))},
                {"motion", always(uniform(extent, 2, 0))}};
    }
    // Uniform in [0, 1), a function of pixel and frame.
    static float noise(int x, int y, std::uint32_t frame) {
        return shared::unitFloat(
            shared::hashCombine(shared::pixelSeed(glm::uvec2(x, y), shared::randomReference, frame), frame));
    }
    static double meanOf(const Image& image) {
        double sum = 0;
        for (const float value : image.values) sum += value;
        return sum / static_cast<double>(image.values.size());
    }
};

} // namespace kestrel::test
