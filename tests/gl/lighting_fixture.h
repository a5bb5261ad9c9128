// What the tests of light share: scenes of squares with lights, a camera that sees a plane squarely, a pass
// that shows what a module `radiance` says about the surfaces of a G-buffer, and sums over surfaces as truth.
#pragma once
#include "execute/commands.h"
#include "shipped_fixture.h"
#include "support/temporary_folder.h"
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace kestrel::test {

inline constexpr float pi = std::numbers::pi_v<float>;

// Shows radiance_surface() where there is geometry, and radiance_miss() elsewhere.
class RadianceProbe : public Pass {
public:
    static PassType type() {
        return Describe<RadianceProbe>("RadianceProbe", "Shows a module of kind radiance")
            .input("depth", PortKind::Texture, "Depth")
            .input("normal", PortKind::Texture, "Normal")
            .input("albedo", PortKind::Texture, "Albedo")
            .input("radiance", PortKind::Radiance, "What is shown")
            .output("result", PortKind::Texture, "Radiance towards the eye")
            .number("lift", &RadianceProbe::lift, -10, 10, "", "Moves positions along the normal")
            .number("error", &RadianceProbe::error, 0, 10, "", "Surface::error");
    }
    [[nodiscard]] Declaration declare(const World&, const Inputs& inputs, const Demand&) const override {
        Declaration declaration;
        declaration.outputs = {
            {.port = "result", .desc = Desc::texture2D(Format::RGBA32F, inputs["depth"].desc.extent)}};
        declaration.steps = {{.name = "show",
                              .shaders = {"radiance_probe.comp"},
                              .uses = {{.port = "depth", .access = Access::Fetch},
                                       {.port = "normal", .access = Access::Fetch},
                                       {.port = "albedo", .access = Access::Fetch},
                                       {.port = "result", .access = Access::Image, .write = true}},
                              .modules = {{"radiance", 0}}}};
        return declaration;
    }
    void execute(const Step&, Commands& commands) override {
        commands.set("lift", lift);
        commands.set("error", error);
        commands.dispatchOver(commands.desc("result").extent);
    }
    float lift = 0, error = 0;

    static constexpr const char* shader = R"(
#include "lib/view.glsl"
#include "lib/radiance.glsl"
#include <port:radiance>
layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D depth;
uniform sampler2D normal;
uniform sampler2D albedo;
layout(rgba32f) uniform writeonly image2D result;
layout(std140) uniform DepthView { ViewData depthView; };
uniform float lift;
uniform float error;
void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(result)))) return;
    float z = texelFetch(depth, pixel, 0).r;
    vec3 n = texelFetch(normal, pixel, 0).xyz;
    vec3 position = positionFromDepth(depthView, vec2(pixel) + 0.5, z > 0.0 ? z : 1.0);
    vec3 eye = towardsEye(depthView, position);
    Surface at = Surface(position + lift * n, error, n, n, texelFetch(albedo, pixel, 0).rgb, 0.0, 1.0, vec3(0.0), 0u, true, 0.0);
    imageStore(result, pixel, vec4(z > 0.0 ? radiance_surface(at, eye) : radiance_miss(-eye), z > 0.0 ? 1.0 : 0.0));
}
)";
};

// The shipped passes and the probe.
inline const Registry& withProbe() {
    static const Registry instance = [] {
        Registry registry = shipped();
        registry.add(RadianceProbe::type());
        static const TemporaryFolder folder;
        std::ofstream(folder / "radiance_probe.comp") << RadianceProbe::shader;
        registry.shaderFolders.push_back(folder.path());
        return registry;
    }();
    return instance;
}

// The corners of the parallelogram with this middle and these half edges; the front is cross(x, y).
inline std::vector<glm::vec3> quad(const glm::vec3& middle, const glm::vec3& x, const glm::vec3& y) {
    const glm::vec3 a = middle - x - y, b = middle + x - y, c = middle + x + y, d = middle - x + y;
    return {a, b, c, a, c, d};
}

inline std::vector<glm::vec3> join(std::vector<glm::vec3> a, const std::vector<glm::vec3>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

// A light that shines from a point along a direction.
struct PlacedLight {
    Light light;
    glm::vec3 position{0}, direction{0, 0, -1};
};

inline Light lightOf(LightKind kind, float intensity, const glm::vec3& colour = glm::vec3(1)) {
    Light light;
    light.kind = kind;
    light.intensity = intensity;
    light.colour = colour;
    return light;
}

// Triangles of one double-sided matte material, lit. The middle of the triangles' bounds must be the origin
// for render space to be that of the positions.
inline Scene litScene(std::vector<glm::vec3> corners, const std::vector<PlacedLight>& lights,
                      const glm::vec3& albedo = glm::vec3(0.5f),
                      const glm::dmat4& rootTransform = glm::dmat4(1)) {
    Scene scene = trianglesScene(std::move(corners));
    if (!scene.materials.empty()) {
        scene.materials[0].baseColour = glm::vec4(albedo, 1);
        scene.materials[0].metallic = 0;
        scene.materials[0].roughness = 1;
    }
    for (const PlacedLight& placed : lights) {
        Node node;
        node.translation = placed.position;
        const glm::dvec3 direction(placed.direction);
        const glm::dvec3 up = std::abs(direction.y) > 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        node.rotation = glm::quatLookAt(glm::normalize(direction), up);
        node.light = static_cast<int>(scene.lights.size());
        scene.lights.push_back(placed.light);
        scene.lights.back().node = static_cast<int>(scene.nodes.size());
        scene.roots.push_back(static_cast<int>(scene.nodes.size()));
        scene.nodes.push_back(node);
    }
    scene.rootTransform = rootTransform;
    finishScene(scene);
    return scene;
}

// Looks from +z at [-1, 1]^2, which fills a square frame.
inline CameraState squareCamera(float scale = 1) {
    CameraState camera;
    camera.view = glm::translate(glm::mat4(1), glm::vec3(0, 0, -3 * scale));
    camera.position = glm::vec3(0, 0, 3 * scale);
    camera.orthographic = true;
    camera.halfHeight = scale;
    camera.aspect = 1;
    camera.nearPlane = 0.01f * scale;
    camera.farPlane = 10 * scale;
    return camera;
}

// The point of the plane z = 0 that squareCamera sees at a pixel (row 0 at the top).
inline glm::vec3 squarePoint(const Image& image, int x, int y) {
    return {(2 * static_cast<float>(x) + 1) / static_cast<float>(image.width) - 1,
            1 - (2 * static_cast<float>(y) + 1) / static_cast<float>(image.height), 0};
}

inline glm::vec3 pixelColour(const Image& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

inline Graph graphOf(const std::string& passes, const std::string& edges, const std::string& outputs) {
    return parseGraph(fmt::format(R"({{"kestrel": 1, "passes": {{{}}}, "edges": [{}], "outputs": [{}]}})",
                                  passes, edges, outputs),
                      "test.json");
}

// A G-buffer, direct light, and a composite: "direct.result".
inline Graph directGraph(const std::string& properties = "") {
    return graphOf(fmt::format(R"("g": {{"type": "GBuffer"}}, "direct": {{"type": "DirectLight",
                       "properties": {{{}}}}})",
                               properties),
                   R"(["g.depth", "direct.depth"], ["g.normal", "direct.normal"])", R"("direct.result")");
}

// What a probe shows of the pass `source`: "probe.result".
inline Graph probeGraph(const std::string& source, const std::string& moreEdges = "",
                        const std::string& probeProperties = "") {
    return graphOf(fmt::format(R"("g": {{"type": "GBuffer"}}, {},
                       "probe": {{"type": "RadianceProbe", "properties": {{{}}}}})",
                               source, probeProperties),
                   R"(["g.depth", "probe.depth"], ["g.normal", "probe.normal"], ["g.albedo", "probe.albedo"],
                      ["source.radiance", "probe.radiance"])" +
                       moreEdges,
                   R"("probe.result")");
}

struct LightingTest : ShippedTest {
    static constexpr Extent frame{64, 64, 1};
    struct LitRenderer : Renderer {
        LitRenderer(Graph graph, Scene scene, RenderOptions options, float scale)
            : Renderer(std::move(graph), withProbe(), std::move(scene), context().capabilities(),
                       std::move(options)) {
            setFreeCamera(squareCamera(scale));
        }
    };
    static LitRenderer lit(Graph graph, Scene scene, RenderOptions options = {}, float scale = 1) {
        options.size = frame;
        return {std::move(graph), std::move(scene), std::move(options), scale};
    }
    static Image picture(Graph graph, Scene scene, int frames = 1, float scale = 1) {
        auto made = lit(std::move(graph), std::move(scene), {}, scale);
        for (int i = 0; i < frames; ++i) made.frame();
        return made.read(made.graph().outputs.front().port);
    }
    static bool leavesOut(const Plan& plan, const std::string& text) {
        return std::any_of(plan.leftOut.begin(), plan.leftOut.end(), [&](const LeftOut& left) {
            return (left.what + ": " + left.why).find(text) != std::string::npos;
        });
    }
};

} // namespace kestrel::test
